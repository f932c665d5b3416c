//! A walk that was played once is not played again: as long as the engine is told the same, step by step, the body goes where
//! it went.
//!
//! What acts on a sensor alone changes nothing of where a robot walks that does not go by what it sees; its engine is most of
//! what such a log costs.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Isometry3;

use super::blueprint::JOINTS;
use super::engine::Engine;
use crate::knobs::BodyKnobs;

/// What an engine was told, and where the body was before the first step and after each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Take {
    told: Vec<Told>,
    stood: Vec<Stood>,
}

/// What an engine is told ([`Engine`]'s methods that change it).
#[derive(Clone, Debug, PartialEq)]
enum Told {
    Load(BodyKnobs),
    Incline([f64; 2]),
    Torque([f64; 4]),
    Friction([f64; 4], f64),
    Aim(Vec<f64>),
    Step,
}

impl Told {
    fn tell(&self, engine: &mut dyn Engine) {
        match self {
            Self::Load(knobs) => engine.load(knobs),
            Self::Incline(slope) => engine.incline(*slope),
            Self::Torque(ratios) => engine.set_torque(*ratios),
            Self::Friction(feet, shell) => engine.set_friction(*feet, *shell),
            Self::Aim(set_points_rad) => engine.aim(set_points_rad),
            Self::Step => engine.step(),
        }
    }
}

/// Where a body is, as an engine tells it.
#[derive(Clone, Debug, PartialEq)]
struct Stood {
    world_from_torso: Isometry3<f64>,
    world_from_head: Isometry3<f64>,
    angles_rad: [f64; JOINTS],
    feet_down: [bool; 4],
}

impl Stood {
    fn of(engine: &dyn Engine) -> Self {
        Self {
            world_from_torso: engine.world_from_torso(),
            world_from_head: engine.world_from_head(),
            angles_rad: std::array::from_fn(|i| engine.angle_rad(i)),
            feet_down: engine.feet_down(),
        }
    }
}

/// Where it is taken down.
pub type Notes = Arc<Mutex<Take>>;

/// An engine whose walk is taken down, or that is left alone for as long as it is told what a take has.
pub struct Rehearsed {
    engine: Box<dyn Engine>,
    how: How,
}

enum How {
    Noting(Notes),
    /// So much of the take was told again, and so many steps of it.
    Following {
        take: Arc<Take>,
        told: usize,
        steps: usize,
    },
    /// Something else was told, or the take is over.
    Live,
}

impl Rehearsed {
    /// Takes down what an engine does that was told nothing yet; what the notes held is lost.
    #[must_use]
    pub fn noting(engine: Box<dyn Engine>, notes: &Notes) -> Self {
        let take = Take { told: Vec::new(), stood: vec![Stood::of(&*engine)] };
        *notes.lock().unwrap_or_else(PoisonError::into_inner) = take;
        Self { engine, how: How::Noting(notes.clone()) }
    }

    /// Follows a take of such an engine, which was told nothing yet.
    #[must_use]
    pub fn following(engine: Box<dyn Engine>, take: &Arc<Take>) -> Self {
        // A body that begins elsewhere goes elsewhere.
        let begins = take.stood.first() == Some(&Stood::of(&*engine));
        let following = || How::Following { take: take.clone(), told: 0, steps: 0 };
        Self { how: if begins { following() } else { How::Live }, engine }
    }

    fn hear(&mut self, it: Told) {
        match &mut self.how {
            How::Following { take, told, steps } if take.told.get(*told) == Some(&it) => {
                *told += 1;
                *steps += usize::from(it == Told::Step);
                return;
            }
            How::Following { take, told, .. } => {
                take.told[..*told].iter().for_each(|told| told.tell(&mut *self.engine));
                self.how = How::Live;
            }
            How::Noting(_) | How::Live => {}
        }
        it.tell(&mut *self.engine);
        if let How::Noting(notes) = &self.how {
            let mut take = notes.lock().unwrap_or_else(PoisonError::into_inner);
            if it == Told::Step {
                take.stood.push(Stood::of(&*self.engine));
            }
            take.told.push(it);
        }
    }

    /// Where the body is by the take that is followed.
    fn stood(&self) -> Option<&Stood> {
        match &self.how {
            How::Following { take, steps, .. } => take.stood.get(*steps),
            How::Noting(_) | How::Live => None,
        }
    }
}

impl Engine for Rehearsed {
    fn load(&mut self, knobs: &BodyKnobs) {
        self.hear(Told::Load(knobs.clone()));
    }

    fn incline(&mut self, slope: [f64; 2]) {
        self.hear(Told::Incline(slope));
    }

    fn set_torque(&mut self, ratios: [f64; 4]) {
        self.hear(Told::Torque(ratios));
    }

    fn set_friction(&mut self, feet: [f64; 4], shell: f64) {
        self.hear(Told::Friction(feet, shell));
    }

    fn aim(&mut self, set_points_rad: &[f64]) {
        self.hear(Told::Aim(set_points_rad.to_vec()));
    }

    fn step(&mut self) {
        self.hear(Told::Step);
    }

    fn angle_rad(&self, i: usize) -> f64 {
        let known = self.stood().and_then(|stood| stood.angles_rad.get(i));
        known.copied().unwrap_or_else(|| self.engine.angle_rad(i))
    }

    fn feet_down(&self) -> [bool; 4] {
        self.stood().map_or_else(|| self.engine.feet_down(), |stood| stood.feet_down)
    }

    fn world_from_torso(&self) -> Isometry3<f64> {
        self.stood().map_or_else(|| self.engine.world_from_torso(), |stood| stood.world_from_torso)
    }

    fn world_from_head(&self) -> Isometry3<f64> {
        self.stood().map_or_else(|| self.engine.world_from_head(), |stood| stood.world_from_head)
    }

    /// Of torso and head alone, while a take is followed.
    fn world_from_link(&self, name: &str) -> Option<Isometry3<f64>> {
        match (self.stood(), name) {
            (None, _) => self.engine.world_from_link(name),
            (Some(stood), "torso") => Some(stood.world_from_torso),
            (Some(stood), "head") => Some(stood.world_from_head),
            (Some(_), _) => None,
        }
    }

    /// As it was before the first step, while a take is followed.
    fn mass_kg(&self) -> f64 {
        self.engine.mass_kg()
    }

    fn broken(&self) -> Option<String> {
        self.engine.broken()
    }
}

#[cfg(test)]
mod tests;
