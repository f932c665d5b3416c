//! A scenario: one TOML file, one question, its expected answer. Parsed once, checked once.
//!
//! Tables of numbers belong to the crates that use them; here they are put together. What [`read`]
//! gives has been checked, so nobody asks again whether a value is in range.

pub mod check;
pub mod fault;
pub mod wire;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use asami_dataset::{ActionModel, Models};
use asami_learners::Learners;
use asami_math::polynomial::Polynomial;
use asami_sim::drives::pace::Pacing;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::AiboConfig;
use asami_sim::scenes::field::Field;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::survey::Surveying;
use serde::{Deserialize, Serialize};

pub use fault::Bad;

/// A checked scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// The file's name without its extension.
    pub name: String,
    /// The question that it asks.
    pub about: String,
    /// Where its logs come from.
    pub origin: Origin,
    /// What is learned from each log.
    pub rows: Vec<Row>,
    /// Parameters of the learners, by learner.
    pub learners: Learners,
    /// When a trial counts as diverged.
    pub divergence: Divergence,
    /// The expected answers.
    pub expect: Vec<Expect>,
}

/// Where a scenario's logs come from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Origin {
    /// Out of a simulated world, one log a seed.
    Simulated(Box<Simulation>),
    /// Out of a recorded log, one log a window.
    Recorded(Recording),
}

/// The world of a scenario and how it is driven.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Which robot.
    pub robot: Robot,
    /// How long each log is.
    pub duration_s: f64,
    /// How many logs.
    pub seeds: u32,
    /// The seed of the first; the others follow.
    pub first_seed: u64,
    /// The Aibo's own tables.
    pub aibo: AiboConfig,
    /// The camera in its head.
    pub camera: CameraConfig,
    /// What stands on the field.
    pub field: Field,
    /// Where the robot stands at first.
    pub start: Placement,
    /// The policy.
    pub drive: Pacing,
    /// What the nominal world leaves out.
    pub effects: Effects,
    /// How the truth about the models is measured.
    pub survey: Surveying,
}

/// The robots of simulated scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Robot {
    /// Sony's ERS-7, walking in Rapier.
    Aibo,
}

impl Robot {
    /// Its name in scenarios and data sets.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Robot::Aibo => "aibo",
        }
    }
}

asami_dataset::parameters! {
    /// Where the robot stands when a log begins, facing world +y at heading 0.
    pub struct Placement {
        /// World x.
        x_m: f64 = 0.0, "m", -100.0..=100.0;
        /// World y.
        y_m: f64 = -2.4, "m", -100.0..=100.0;
        /// Heading, counter-clockwise.
        theta_rad: f64 = 0.0, "rad", -3.2..=3.2;
        /// Each seed starts up to this much further on or back.
        y_spread_m: f64 = 0.3, "m", 0.0..=10.0;
    }
}

/// A recorded log and how it is cut.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recording {
    /// Path of the data, relative to the repository's root.
    pub source: String,
    /// The importer that reads it; `None` for a data set of ours.
    pub format: Option<String>,
    /// The pieces that learners are given.
    pub windows: Vec<Window>,
}

/// A piece of a recorded log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Where it begins, in seconds since the recording began.
    pub start_s: f64,
    /// How long it is.
    pub length_s: f64,
    /// Whether it shares data with its neighbours, so that statistics over it count data twice.
    pub overlapping: bool,
}

impl Window {
    /// From its start to its end.
    #[must_use]
    pub fn span_s(&self) -> Range<f64> {
        self.start_s..self.start_s + self.length_s
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
    /// How much of each log it is given, from the beginning.
    pub duration_s: f64,
    /// Parameters that differ from the scenario's `[learners]`.
    pub with: BTreeMap<String, f64>,
}

/// A model that a learner is given: to start from, or as known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// `A0(c) = c`: attempted velocities are correct (Stronger 2008, section 3.3.2).
    C,
    /// `A0(c) = Sgn(c)`: only the direction (section 3.3.3).
    Sgn,
    /// `A0(c) = 1`: nothing (section 3.3.3).
    One,
    /// The quartic that fits the surveyed speeds best, as given in section 3.3.3's degree selection.
    ReferenceQuartic,
    /// The cubic that fits the surveyed heights best, for learning an action model alone.
    ReferenceCubic,
}

impl Start {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Start::C => "c",
            Start::Sgn => "sgn",
            Start::One => "one",
            Start::ReferenceQuartic => "reference_quartic",
            Start::ReferenceCubic => "reference_cubic",
        }
    }

    /// Whether it is an action model (else a sensor model).
    #[must_use]
    pub fn is_action_model(self) -> bool {
        self != Start::ReferenceCubic
    }

    /// The models, where they need no truth.
    #[must_use]
    pub fn models(self) -> Option<Models> {
        let action = match self {
            Start::C => ActionModel::Polynomial(Polynomial::plain(vec![0.0, 1.0]).into()),
            Start::Sgn => ActionModel::Sign,
            Start::One => ActionModel::Polynomial(Polynomial::plain(vec![1.0]).into()),
            Start::ReferenceQuartic | Start::ReferenceCubic => return None,
        };
        Some(Models { action: Some(action), ..Models::default() })
    }
}

asami_dataset::parameters! {
    /// When a trial counts as diverged: the same rule for every learner.
    pub struct Divergence {
        /// Either model's R^2 against the survey, after the published scaling, lies below this.
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
