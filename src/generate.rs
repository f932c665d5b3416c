//! One data set out of a scenario's world.

use asami_dataset::parameters::{Fault, out_of_range};
use asami_dataset::{Command, Dataset, Seed};
use asami_sim::effects::{Effects, catalogue};

use crate::scenario::fault::nearest;
use crate::scenario::{Origin, Robot, Scenario, check};
use crate::survey;
use crate::sweep::manifest::repository;

/// `NAME.PARAM=VALUE`: a parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The effect.
    pub effect: String,
    /// Its parameter.
    pub parameter: String,
    /// The value.
    pub value: f64,
}

impl std::str::FromStr for Setting {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once('=').and_then(|(path, value)| Some((path.split_once('.')?, value)));
        let ((effect, parameter), value) = parts.ok_or("must be NAME.PARAM=VALUE")?;
        let value: f64 = value.trim().parse().map_err(|_| "the value must be a number")?;
        Ok(Self { effect: effect.trim().to_owned(), parameter: parameter.trim().to_owned(), value })
    }
}

/// What kept a data set from being made.
#[derive(Debug, thiserror::Error)]
pub enum CannotGenerate {
    /// The scenario's logs are recorded.
    #[error("scenario {0} is about a recorded log, which nothing generates; `import` reads it")]
    Recorded(String),
    /// No such effect.
    #[error("there is no effect {name}{}; `list effects` shows all", meant(name, catalogue().iter().map(|about| about.name)))]
    NoSuchEffect {
        /// The name asked for.
        name: String,
    },
    /// The effect has no such parameter.
    #[error("effect {effect} has no parameter {name}; it has {has}")]
    NoSuchParameter {
        /// The effect.
        effect: String,
        /// The name asked for.
        name: String,
        /// Its parameters.
        has: String,
    },
    /// Out of range, or of another robot.
    #[error("{}", .0.iter().map(|fault| format!("{}: {}", fault.path, fault.message)).collect::<Vec<_>>().join("; "))]
    Faults(Vec<Fault>),
    /// It is not told by the speeds of its wheels.
    #[error("commands of another log are for robots on wheels (robot \"create\"); {0} has none")]
    NotOnWheels(String),
    /// The world cannot be built.
    #[error("{0}")]
    World(String),
}

fn meant<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> String {
    nearest(name, names).map_or(String::new(), |name| format!(" (did you mean {name}?)"))
}

/// The data set of `seed`, with further effects switched on. It names the scenario as its nominal
/// world and never tells of effects.
///
/// # Errors
/// [`CannotGenerate`] where the scenario is recorded or an effect does not fit.
pub fn generate(scenario: &Scenario, settings: &[Setting], seed: Seed) -> Result<Dataset, CannotGenerate> {
    with(scenario, settings, seed, None)
}

/// The same of a robot on wheels that is told what another was: `commands`, in order of time, from the first on.
///
/// # Errors
/// As [`generate`]'s, and where the scenario's robot has no wheels that are told how fast to turn.
pub fn replay(
    scenario: &Scenario,
    settings: &[Setting],
    commands: Vec<Command>,
    seed: Seed,
) -> Result<Dataset, CannotGenerate> {
    with(scenario, settings, seed, Some(commands))
}

fn with(
    scenario: &Scenario,
    settings: &[Setting],
    seed: Seed,
    commands: Option<Vec<Command>>,
) -> Result<Dataset, CannotGenerate> {
    let Origin::Simulated(nominal) = &scenario.origin else {
        return Err(CannotGenerate::Recorded(scenario.name.clone()));
    };
    let mut simulation = nominal.clone();
    for setting in settings {
        set(&mut simulation.effects, setting)?;
    }
    let mut faults = Vec::new();
    check::effects_fit(&simulation.effects, simulation.robot, &mut faults);
    if !faults.is_empty() {
        return Err(CannotGenerate::Faults(faults));
    }
    if commands.is_some() && simulation.robot != Robot::Create {
        return Err(CannotGenerate::NotOnWheels(scenario.name.clone()));
    }
    let told = commands.is_some();
    let made = match commands {
        Some(commands) => simulation.replayed(commands, seed),
        None => simulation.dataset(seed),
    };
    let mut dataset = made.map_err(|error| CannotGenerate::World(error.to_string()))?;
    let mut known = (*dataset.log.known).clone();
    known.nominal = Some(scenario.name.clone());
    dataset.log.known = known.into();
    // Of another program's engine a scenario knows nothing, nor of another log's commands.
    dataset.provenance = (simulation.engine.is_none() && !told).then(|| scenario.provenance(seed));
    // A survey takes minutes: a data set has one where one of this very world, effects and all, is kept.
    let folders = ["results/reference", "results"].map(|results| repository().join(results).join(&scenario.name));
    if dataset.truth.survey.is_none() {
        let survey = survey::at_hand(&simulation, &folders);
        dataset.truth.survey = survey.map_err(|error| CannotGenerate::World(error.to_string()))?;
    }
    Ok(dataset)
}

fn set(effects: &mut Effects, setting: &Setting) -> Result<(), CannotGenerate> {
    let Setting { effect, parameter, value } = setting;
    let about = catalogue().into_iter().find(|about| about.name == effect);
    let about = about.ok_or_else(|| CannotGenerate::NoSuchEffect { name: effect.clone() })?;
    let Some(declared) = about.parameters.iter().find(|declared| declared.name == parameter) else {
        let has = about.parameters.iter().map(|parameter| parameter.name).collect::<Vec<_>>().join(", ");
        return Err(CannotGenerate::NoSuchParameter { effect: effect.clone(), name: parameter.clone(), has });
    };
    if let Some(fault) = out_of_range(&format!("effects.{effect}"), declared, *value) {
        return Err(CannotGenerate::Faults(vec![fault]));
    }
    effects.set(effect, parameter, *value);
    Ok(())
}
