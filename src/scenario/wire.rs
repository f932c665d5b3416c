//! A scenario as it stands in the file, before anything is checked.

use std::collections::BTreeMap;

use asami_dataset::parameters::Fault;
use asami_learners::Learners;
use asami_sim::drives::driver::Driving;
use asami_sim::drives::explore::Exploring;
use asami_sim::drives::pace::Pacing;
use asami_sim::drives::roam::Roaming;
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::AiboConfig;
use asami_sim::robots::car::CarConfig;
use asami_sim::robots::create::CreateConfig;
use asami_sim::robots::plain::PlainConfig;
use asami_sim::scenes::field::Field;
use asami_sim::scenes::town::TownConfig;
use asami_sim::sensors::applanix::Applanix;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::sensors::velodyne::VelodyneConfig;
use asami_sim::survey::Surveying;
use serde::Deserialize;
use toml::de::DeTable;

use crate::binning::Binning;
use crate::depths::Depths;
use asami_sim::ride::Angles;

use super::{Divergence, Era, Expect, Placement, Robot, Start, Starting, Study};

/// The version of the scenario format that this program reads.
pub const SCHEMA: i64 = 1;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wire {
    /// Version of the format; checked before the rest.
    #[serde(rename = "schema")]
    pub _schema: i64,
    /// The question.
    pub about: String,
    /// What is studied.
    #[serde(default)]
    pub study: Study,
    /// Path of a recorded log.
    pub source: Option<String>,
    /// Its format, of a log that is no data set of ours: the name of an importer.
    pub format: Option<String>,
    /// How commands that take any value become discrete actions.
    pub binning: Option<Binning>,
    /// Whether the recording's ranges are depths.
    pub depths: Option<Depths>,
    /// The robots whose logs are taken, of a recording of several.
    pub robots: Option<Vec<u16>>,
    /// Sets of landmarks; with each in turn, the log is learned from as if there were no others.
    pub landmarks: Option<Vec<Vec<u16>>>,
    /// How the recorded log is cut.
    pub windows: Option<Windows>,
    /// Which robot is simulated.
    pub robot: Option<Robot>,
    /// Length of each simulated log.
    pub duration_s: Option<f64>,
    /// How many simulated logs.
    pub seeds: Option<i64>,
    /// The first seed.
    pub first_seed: Option<i64>,
    /// The Aibo.
    pub aibo: Option<AiboConfig>,
    /// The plain robot.
    pub plain: Option<PlainConfig>,
    /// The discrete actions.
    pub suite: Option<Suite>,
    /// The camera.
    pub camera: Option<CameraConfig>,
    /// The field.
    pub field: Option<Field>,
    /// Where the robot stands at first.
    pub start: Option<Placement>,
    /// The policy along a line.
    pub drive: Option<Pacing>,
    /// The policy in the plane.
    pub explore: Option<Exploring>,
    /// The wheeled robot.
    pub create: Option<CreateConfig>,
    /// Its policy.
    pub roam: Option<Roaming>,
    /// The town that a car drives through.
    pub town: Option<TownConfig>,
    /// The car.
    pub car: Option<CarConfig>,
    /// Who drives it.
    pub driving: Option<Driving>,
    /// Its laser scanner.
    pub velodyne: Option<VelodyneConfig>,
    /// Where that scanner's lasers point.
    pub unit: Option<Angles>,
    /// What its models are held against.
    pub applanix: Option<Applanix>,
    /// Effects.
    pub effects: Option<Effects>,
    /// How the truth is measured.
    pub survey: Option<Surveying>,
    /// Learners' parameters.
    #[serde(default)]
    pub learners: Learners,
    /// Rows of the table.
    pub rows: Vec<Row>,
    /// Starting models in numbers.
    pub starting: Option<Starting>,
    /// When a trial counts as diverged.
    #[serde(default)]
    pub divergence: Divergence,
    /// Expected answers.
    #[serde(default)]
    pub expect: Vec<Expect>,
}

/// How a recorded log is cut.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Windows {
    /// Length of each window.
    pub length_s: f64,
    /// Where windows that share no data begin.
    pub disjoint_starts_s: Vec<f64>,
    /// From the first to the last of these starts, also a window every so often, marked as overlapping.
    pub overlapping_every_s: Option<f64>,
    /// So much of each window, from its beginning, is learned from; models are held against the rest.
    pub learned_s: Option<f64>,
}

/// A row of the table.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Learner.
    pub learner: Option<String>,
    /// In its place: several, rows of the table for each.
    pub learners: Option<Vec<String>>,
    /// Its name in tables.
    #[serde(rename = "as")]
    pub label: Option<String>,
    /// What it is given.
    pub start: Option<Start>,
    /// In its place: several, a row of the table for each.
    pub starts: Option<Vec<Start>>,
    /// Which part of the log.
    pub era: Option<Era>,
    /// How much of it.
    pub duration_s: Option<f64>,
    /// Parameters of its own.
    #[serde(default)]
    pub with: BTreeMap<String, f64>,
}

/// What a file says it studies.
#[must_use]
pub fn study<'a>(table: &'a DeTable<'_>) -> Option<&'a str> {
    table.get("study").and_then(|study| study.get_ref().as_str())
}

/// Refuses a file of another version before its keys are judged by this one's.
///
/// # Errors
/// The fault, if `schema` is not [`SCHEMA`].
pub fn check_schema(table: &DeTable<'_>) -> Result<(), Fault> {
    let Some(value) = table.get("schema") else {
        // Said by serde, together with what else is required.
        return Ok(());
    };
    let found = value.get_ref();
    let is_ours = found.as_integer().and_then(|n| i64::from_str_radix(n.as_str(), n.radix()).ok()) == Some(SCHEMA);
    let shown = match found.as_integer() {
        Some(number) => number.as_str().to_owned(),
        None => found.type_str().to_owned(),
    };
    if is_ours {
        return Ok(());
    }
    Err(Fault { path: "schema".into(), message: format!("schema must be {SCHEMA} for this program, not {shown}") })
}
