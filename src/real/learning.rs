//! Learners in the repaired world: do their scores on simulated logs foretell those on the real robot, and do they so the
//! better, once what was found is in the simulator?
//!
//! A scenario of the recording says what is learned from it and how. The same is learned from simulated logs that stand in for
//! the recording: of the nominal world, and of worlds as they are believed after the log's diagnosis, with the effects that it
//! names, what else may be there and the noise that it learned, with the same seeds and for each seed another. What a learner errs by on
//! the real robot comes of what is unsure, too. They have much of the recording's robot besides ([`super::stand_in`]), and are scored by
//! where a robot's axle is and where it goes: capture's own frame hangs on how markers were put on.

use std::collections::BTreeMap;
use std::path::PathBuf;

use asami_dataset::{Dataset, Seed};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::capture::of_axle;
use super::record::{Part, Record};
use super::scenario::{Learning, Source};
use super::stand_in::Original;
use crate::diagnose::Ready;
use crate::diagnose::progress::Listener;
use crate::diagnose::repaired::{self, cause};
use crate::scenario::{self, Origin, Recording, Scenario, Simulation};
use crate::sweep::manifest::repository;
use crate::sweep::plane::InPlane;
use crate::sweep::plane::quantities::QUANTITIES;
use crate::sweep::source::Recorded;
use crate::sweep::verb::configured;
use crate::sweep::{self, Options, Plan, Silent};
use crate::trial::Ending;

/// Which robot was learned from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum World {
    /// The real one.
    Real,
    /// A simulated one that knows nothing of the log.
    Nominal,
    /// The same with what was found.
    Repaired,
}

impl World {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            World::Real => "real",
            World::Nominal => "nominal",
            World::Repaired => "repaired",
        }
    }
}

/// What a learner learned of one log.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    /// The log's name in the scenario.
    pub log: String,
    /// Whose, of a recording of several.
    pub robot: Option<u16>,
    /// From which robot.
    pub world: World,
    /// Of a simulated log.
    pub seed: Option<u64>,
    /// Who learned.
    pub learner: String,
    /// Whether it converged.
    pub converged: bool,
    /// What is measured of it, by [`MEASURES`].
    pub values: BTreeMap<&'static str, f64>,
}

/// Errors that are foretold.
pub const MEASURES: [&str; 4] = ["vx_rmse_mm_per_s", "vy_rmse_mm_per_s", "vtheta_rmse_rad_per_s", "sensor_rmse_mm"];

/// Robots of a recording.
pub type Originals = BTreeMap<Option<u16>, Original>;

/// Learns from every log that has a scenario to be learned by and effects that were named, and from the simulated ones in its
/// place.
///
/// # Errors
/// A report where a scenario or its recording cannot be used, or files not be written.
pub fn lessons(
    learning: &Learning,
    source: &Source,
    path: &std::path::Path,
    records: &[Record],
    (ready, originals): (&Ready, &Originals),
    options: &Options,
    listener: &dyn Listener,
) -> Result<Vec<Lesson>, miette::Report> {
    let Some(name) = &source.learned_in else { return Ok(Vec::new()) };
    let mut scenario = scenario::read(&repository().join("scenarios").join(format!("{name}.toml")))?;
    scenario.rows.retain(|row| learning.learners.contains(&row.label) && row.start == Some(learning.starting_model));
    let Origin::Recorded(recording) = &mut scenario.origin else {
        miette::bail!("learned_in: scenario {name} is not about a recording");
    };
    let worlds = repairs(source, records, ready)?;
    keep(recording, |robot| worlds.contains_key(&robot));
    let recording = recording.clone();
    let learn = |world: World, seed: Option<u64>, recorded: Recorded| {
        let folder = seed.map_or_else(|| world.name().to_owned(), |seed| format!("{}-{seed}", world.name()));
        listener.says(&format!("learning from {}: {folder}", source.name));
        let out = options.out.join("learning").join(&source.name).join(folder);
        let plan = Plan { scenario: scenario.clone(), source: Box::new(recorded), learners: configured(&scenario)? };
        let results = sweep::run::<InPlane>(&plan, &Options { out, ..options.clone() }, &Silent);
        let results = results.map_err(crate::verb::plain)?;
        let lesson = |(record, trial): (&sweep::Record<InPlane>, &crate::trial::Trial<_>)| Lesson {
            log: source.name.clone(),
            robot: record.case.robot,
            world,
            seed,
            learner: scenario.rows[trial.row].label.clone(),
            converged: trial.ending == Ending::Converged,
            values: QUANTITIES
                .iter()
                .filter(|quantity| MEASURES.contains(&quantity.name))
                .filter_map(|quantity| Some((quantity.name, (quantity.of)(trial, &record.truth)?)))
                .collect(),
        };
        Ok::<Vec<Lesson>, miette::Report>(results.trials().map(lesson).collect())
    };
    let mut all = learn(World::Real, None, Recorded::open_as(&recording, path, of_axle)?)?;
    for seed in 0..u64::from(learning.seeds) {
        for world in [World::Nominal, World::Repaired] {
            all.extend(learn(world, Some(seed), stand_ins(&recording, &worlds, originals, world, seed)?)?);
        }
    }
    Ok(all)
}

/// Keeps of a recording the robots of which `wanted` says so, with all of their landmarks: of several parts of a log the first.
fn keep(recording: &mut Recording, wanted: impl Fn(Option<u16>) -> bool) {
    let mut robots: Vec<Option<u16>> = Vec::new();
    recording.parts.retain(|part| {
        let first = !robots.contains(&part.robot);
        if first {
            robots.push(part.robot);
        }
        first && wanted(part.robot)
    });
    // Axes are in the order of the robots.
    if let Some(depths) = recording.depths.as_mut().filter(|depths| depths.axis_rad.len() > 1) {
        let axes = depths.axis_rad.iter().zip(&robots).filter(|(_, robot)| wanted(**robot));
        depths.axis_rad = axes.map(|(axis, _)| *axis).collect();
    }
}

/// Worlds that stand in for a robot.
struct Repair {
    nominal: Simulation,
    /// As they are believed.
    believed: Vec<Simulation>,
}

impl Repair {
    /// The world of a stand-in.
    fn of(&self, world: World, seed: u64) -> &Simulation {
        match world {
            World::Nominal => &self.nominal,
            World::Real | World::Repaired => &self.believed[seed as usize % self.believed.len()],
        }
    }
}

/// Of each robot whose log's effects were named.
type Repairs = BTreeMap<Option<u16>, Repair>;

fn repairs(source: &Source, records: &[Record], ready: &Ready) -> Result<Repairs, miette::Report> {
    let whole = records.iter().filter(|it| it.log == source.name && it.part == Part::Whole);
    let mut worlds = BTreeMap::new();
    for (record, diagnosis) in whole.filter_map(|it| Some((it, it.diagnosis.as_ref()?))) {
        let Some(cause) = cause(diagnosis) else { continue };
        let mut believed = Vec::new();
        for text in repaired::believed(&ready.held.text, cause, diagnosis).map_err(crate::verb::plain)? {
            let with_effects = scenario::parse(&ready.held.name, "with_effect.toml", &text)?;
            if let Scenario { origin: Origin::Simulated(repaired), .. } = with_effects {
                believed.push(*repaired);
            }
        }
        if believed.is_empty() {
            continue;
        }
        worlds.insert(record.robot, Repair { nominal: (*ready.held.simulation).clone(), believed });
    }
    Ok(worlds)
}

/// Simulated logs in the place of the recording's.
fn stand_ins(
    recording: &Recording,
    worlds: &Repairs,
    originals: &Originals,
    world: World,
    seed: u64,
) -> Result<Recorded, miette::Report> {
    let until_s = recording.windows.iter().map(|window| window.span_s().end).fold(0.0, f64::max) + 1.0;
    let parts: Vec<Option<u16>> = recording.parts.iter().map(|part| part.robot).collect();
    let wholes = parts.into_par_iter().with_max_len(1).map(|robot| {
        let simulation = Simulation { duration_s: until_s, ..worlds[&robot].of(world, seed).clone() };
        // The same for both worlds, so that they differ by nothing else.
        let seed = Seed(1 + 100 * seed + u64::from(robot.unwrap_or_default()));
        let original = originals.get(&robot).cloned().unwrap_or_default();
        let dataset: Dataset = original.stand_in(&simulation, seed).map_err(crate::verb::plain)?;
        Ok((robot, dataset))
    });
    Recorded::of(recording, wholes.collect::<Result<_, miette::Report>>()?, &PathBuf::from("a simulated log"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Robots whose effects were not named are left out, and their cameras' axes with them.
    #[test]
    fn a_robot_keeps_its_axis_when_others_are_left_out() {
        let scenario = scenario::read(&repository().join("scenarios/mrclam.toml")).unwrap();
        let Origin::Recorded(mut recording) = scenario.origin else { panic!("mrclam is a recording") };
        let axes = recording.depths.clone().unwrap().axis_rad;
        keep(&mut recording, |robot| matches!(robot, Some(2 | 5)));
        let robots: Vec<Option<u16>> = recording.parts.iter().map(|part| part.robot).collect();
        assert_eq!(robots, [Some(2), Some(5)]);
        assert_eq!(recording.depths.unwrap().axis_rad, [axes[1], axes[4]]);
    }
}
