//! A scenario: one TOML file, one question, its expected answer. Parsed once, checked once.
//!
//! Tables of numbers belong to the crates that use them; here they are put together. What [`read`]
//! gives has been checked, so nobody asks again whether a value is in range.

pub mod check;
pub mod fault;
pub mod origin;
pub mod start;
pub mod wire;

use std::collections::BTreeMap;
use std::path::Path;

use asami_dataset::parameters::Fault;
use asami_learners::Learners;
use serde::{Deserialize, Serialize};

use crate::sweep::{car, plane, stride};

pub use fault::Bad;
pub use origin::{Origin, Part, Placement, Policy, Recording, Roams, Robot, Simulation, Window};
pub use start::{Start, Starting};

/// A checked scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// The file's name without its extension.
    pub name: String,
    /// The question that it asks.
    pub about: String,
    /// Which models are learned, and how they are scored.
    pub study: Study,
    /// Where its logs come from.
    pub origin: Origin,
    /// What is learned from each log.
    pub rows: Vec<Row>,
    /// Parameters of the learners, by learner.
    pub learners: Learners,
    /// The numbers of starting models.
    pub starting: Starting,
    /// When a trial counts as diverged.
    pub divergence: Divergence,
    /// The expected answers.
    pub expect: Vec<Expect>,
}

/// Which models are learned, how they are scored, and which tables come of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Study {
    /// Chapter 3: along a line, distance as a polynomial of the observation, speed as one of the command.
    #[default]
    Line,
    /// Sections 4.4.1 and 4.4.2: in the plane, a velocity for each discrete action, the observation as a
    /// polynomial of the distance, and the sensor's noise.
    Plane,
    /// Section 4.4.3: the models of chapter 4 along chapter 3's line, before and after the robot changes.
    Stride,
    /// Chapter 5: a car, the angles of its laser scanner, and an action model of pedals.
    Car,
}

impl Study {
    /// Its name in scenarios.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Study::Line => "line",
            Study::Plane => "plane",
            Study::Stride => "stride",
            Study::Car => "car",
        }
    }

    /// Quantities of `trials.csv` that medians can be expected of, by their columns.
    #[must_use]
    pub fn quantities(self) -> &'static [&'static str] {
        match self {
            Study::Line => &[],
            Study::Plane => &plane::quantities::NAMES,
            Study::Stride => &stride::quantities::NAMES,
            Study::Car => &car::quantities::NAMES,
        }
    }
}

/// A part of a log in which the robot does not change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Era {
    /// From the beginning.
    #[default]
    Before,
    /// From when the robot changed.
    After,
}

impl Era {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Era::Before => "before",
            Era::After => "after",
        }
    }
}

/// One learner, started one way, on so much of each log: a row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The learner's name in the catalogue.
    pub learner: String,
    /// Its name in tables, where that differs: a variant with other parameters.
    pub label: String,
    /// What the learner is given.
    pub start: Option<Start>,
    /// Which part of each log it is given.
    pub era: Era,
    /// How much of that part, from its beginning.
    pub duration_s: f64,
    /// Parameters that differ from the scenario's `[learners]`.
    pub with: BTreeMap<String, f64>,
}

asami_dataset::parameters! {
    /// When a trial counts as diverged: the same rule for every learner.
    pub struct Divergence {
        /// R^2 of any learned model against the truth lies below this: of sensor or action model after the
        /// published scaling; in the plane of v_x, v_y, v_theta or f as they are; of a car of the lasers' angles, or of
        /// acceleration, speed or yaw rate rolled out over the whole drive.
        r2_min: f64 = 0.75, "1", 0.0..=1.0;
    }
}

/// What a scenario expects of one of its rows, at the full number of seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expect {
    /// The row's label.
    pub learner: String,
    /// The row's starting model.
    pub start: Option<Start>,
    /// The row's part of the log.
    #[serde(default)]
    pub era: Era,
    /// The robot whose log the row learns from; left out: of every robot.
    pub robot: Option<u16>,
    /// The number of landmarks in that log; left out: with every set of them.
    pub landmarks: Option<u16>,
    /// The era whose truth the models are held against; left out: that of the row.
    pub truth: Option<Era>,
    /// The row's duration; may be left out where only one row has this label and start.
    pub duration_s: Option<f64>,
    /// At least this share of the trials converges.
    pub converged_share_min: Option<f64>,
    /// At most this share of the trials converges (a negative result).
    pub converged_share_max: Option<f64>,
    /// Mean sensor error at most this multiple of the floor's.
    pub sensor_to_floor_max: Option<f64>,
    /// Mean action error at most this multiple of the floor's.
    pub action_to_floor_max: Option<f64>,
    /// Mean action error below that of `A0(c) = c` as it is.
    #[serde(default)]
    pub beats_unlearned: bool,
    /// Smaller errors, sensor and action, than this label's row of the same duration, by a paired
    /// test at the 5 % level.
    pub beats: Option<String>,
    /// Of quantities of `trials.csv` by their columns: medians over the converged trials at most these.
    #[serde(default)]
    pub median_max: BTreeMap<String, f64>,
    /// Medians at least these.
    #[serde(default)]
    pub median_min: BTreeMap<String, f64>,
}

/// Reads and checks a scenario file.
///
/// # Errors
/// [`Bad`] shows where in the file what rule is broken by which value.
pub fn read(path: &Path) -> Result<Scenario, Bad> {
    let shown = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| Bad::unreadable(&shown, &error))?;
    let name = path.file_stem().map_or_else(|| shown.clone(), |stem| stem.to_string_lossy().into_owned());
    match String::from_utf8(bytes) {
        Ok(text) => parse(&name, &shown, &text),
        Err(error) => Err(Bad::not_text(&shown, &error)),
    }
}

/// Checks the text of a scenario; `shown` is the file's name in errors.
///
/// # Errors
/// [`Bad`] shows where in the text what rule is broken by which value.
pub fn parse(name: &str, shown: &str, text: &str) -> Result<Scenario, Bad> {
    let table = toml::de::DeTable::parse(text).map_err(|error| Bad::syntax(shown, text, &error))?;
    wire::check_schema(table.get_ref()).map_err(|fault| Bad::faults(shown, text, &table, &[fault]))?;
    if let Some(study @ ("blind" | "pooled" | "real")) = wire::study(table.get_ref()) {
        let message = format!("study \"{study}\" has no learners: only `sweep` reads it");
        return Err(Bad::faults(shown, text, &table, &[Fault { path: "study".into(), message }]));
    }
    let wire: wire::Wire = toml::from_str(text).map_err(|error| Bad::syntax(shown, text, &error))?;
    let mut faults = Vec::new();
    match check::scenario(name, wire, &mut faults) {
        Some(scenario) if faults.is_empty() => Ok(scenario),
        _ => Err(Bad::faults(shown, text, &table, &faults)),
    }
}

impl Scenario {
    /// `blake3:` and the hash of everything that bears on a trial: not the comments, the prose, the
    /// number of seeds or the expected answers.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut bearing = self.clone();
        bearing.about.clear();
        bearing.expect.clear();
        if let Origin::Simulated(simulation) = &mut bearing.origin {
            simulation.seeds = 0;
        }
        // Serialising to memory fails only for maps with keys that are no strings: there are none.
        let bytes = serde_json::to_vec(&bearing).unwrap_or_default();
        format!("blake3:{}", blake3::hash(&bytes).to_hex())
    }
}
