//! The nominal world of a library, in which an Aibo is not led again through what it was led through before.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use asami_dataset::{Dataset, Seed};
use asami_gap::{CannotPlay, Nominal};
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::By;
use asami_sim::robots::aibo::rehearsal::{Notes, Take};
use asami_sim::robots::car::CarConfig;
use asami_sim::world::{Drive, World};

use crate::scenario::{Robot, Simulation};

/// A take, or why there is none.
type Taken = Result<Arc<Take>, CannotPlay>;

/// A nominal world that notes, of each seed that is played with an effect, how the Aibo walks without: what acts on its sensors alone
/// then costs no engine. A take of 150 s holds less than 20 MB: it is for libraries, whose effects are all played with the same few seeds.
pub struct Rehearsed<'a> {
    nominal: &'a Simulation,
    takes: Mutex<BTreeMap<u64, Arc<OnceLock<Taken>>>>,
}

impl<'a> Rehearsed<'a> {
    /// Of a world of which nothing was played yet.
    #[must_use]
    pub fn new(nominal: &'a Simulation) -> Self {
        Self { nominal, takes: Mutex::default() }
    }

    fn take(&self, seed: Seed, until_s: f64) -> Taken {
        let of_seed = self.takes.lock().unwrap_or_else(PoisonError::into_inner).entry(seed.0).or_default().clone();
        let nominal = || Simulation { duration_s: until_s, ..self.nominal.clone() };
        of_seed.get_or_init(|| note(&nominal(), seed)).clone()
    }
}

/// A take of a case.
fn note(simulation: &Simulation, seed: Seed) -> Taken {
    let notes = Notes::default();
    simulation.walked(By::Noted(&notes), seed).map_err(|error| CannotPlay(error.to_string()))?;
    let take = std::mem::take(&mut *notes.lock().unwrap_or_else(PoisonError::into_inner));
    Ok(Arc::new(take))
}

impl Nominal for Rehearsed<'_> {
    fn robot(&self) -> &'static str {
        Nominal::robot(self.nominal)
    }

    fn landmarks(&self) -> usize {
        self.nominal.landmarks()
    }

    fn effects(&self) -> &Effects {
        Nominal::effects(self.nominal)
    }

    fn duration_s(&self) -> f64 {
        Nominal::duration_s(self.nominal)
    }

    fn world(&self, effects: &Effects, seed: Seed) -> Result<Box<dyn World>, CannotPlay> {
        Nominal::world(self.nominal, effects, seed)
    }

    fn car(&self) -> Option<&CarConfig> {
        self.nominal.car()
    }

    fn dataset(&self, effects: &Effects, seed: Seed, until_s: f64) -> Result<Dataset, CannotPlay> {
        let walks_in_rapier = self.nominal.robot == Robot::Aibo && self.nominal.engine.is_none();
        if !walks_in_rapier || *effects == self.nominal.effects {
            return Nominal::dataset(self.nominal, effects, seed, until_s);
        }
        let take = self.take(seed, until_s)?;
        let simulation = Simulation { effects: effects.clone(), duration_s: until_s, ..self.nominal.clone() };
        simulation.walked(By::Rehearsed(&take), seed).map_err(|error| CannotPlay(error.to_string()))
    }

    fn drive(&self, seed: Seed) -> Box<dyn Drive> {
        self.nominal.drive(seed)
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Beacon, Known, Log};
    use asami_gap::Variant;
    use asami_sim::effect::Place;

    use super::*;
    use crate::diagnose::nominal::Held;

    /// The shipped world among so many beacons.
    fn among(beacons: u16) -> Held {
        let beacon = |id| Beacon { id, x_m: 0.0, y_m: 0.0, height_m: None };
        let landmarks = (0..beacons).map(beacon).collect();
        let known = Known { robot: "aibo".to_owned(), landmarks, ..Known::default() };
        Held::find(None, &Log { known: known.into(), ..Log::default() }).unwrap()
    }

    /// Before one beacon, where the robot goes by what it sees, and among four, where it does not.
    #[test]
    fn logs_of_every_effect_are_what_they_are_unrehearsed() {
        for beacons in [1, 4] {
            let held = among(beacons);
            let nominal = &*held.simulation;
            let rehearsed = Rehearsed::new(nominal);
            for variant in Variant::all("aibo", nominal.landmarks(), &[]) {
                let mut effects = nominal.effects.clone();
                variant.plant(variant.sizes().1, &mut effects);
                let played = |world: &dyn Nominal| world.dataset(&effects, Seed(3), 2.5).unwrap();
                assert_eq!(played(&rehearsed), played(nominal), "{} {}", held.name, variant.name());
            }
            assert_eq!(rehearsed.takes.lock().unwrap().len(), 1, "one seed was played");
        }
    }

    /// What makes a take worth its while: to the end nothing else is told.
    #[test]
    fn among_four_beacons_what_acts_on_sensors_tells_the_engine_nothing_else() {
        let held = among(4);
        let nominal = Simulation { duration_s: 2.5, ..(*held.simulation).clone() };
        let take = note(&nominal, Seed(3)).unwrap();
        for variant in Variant::all("aibo", nominal.landmarks(), &[]) {
            let mut simulation = nominal.clone();
            variant.plant(variant.sizes().1, &mut simulation.effects);
            let senses = matches!(variant.place(), Place::Sensing | Place::Scene);
            assert_eq!(note(&simulation, Seed(3)).unwrap() == take, senses, "{}", variant.name());
        }
    }
}
