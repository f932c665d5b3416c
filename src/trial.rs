//! One trial: one learner, started one way, on one log. What came of it is a row, whatever it is.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use asami_dataset::{ActionModel, Dataset, Models, Seed, SensorModel, store};
use asami_learners::{Learned, Learner};
use serde::{Deserialize, Serialize};

use crate::scenario::{Divergence, Row, Start, Window};
use crate::scorer::{Scores, Yardstick};

/// A log of a scenario: simulated from a seed, or a window of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Seed of the simulation; of a recording, the seed of the learners' own draws.
    pub seed: u64,
    /// The window of a recording.
    pub window: Option<Window>,
}

impl Case {
    /// Its name in file names.
    #[must_use]
    pub fn name(&self) -> String {
        match self.window {
            None => format!("{}", self.seed),
            Some(Window { start_s, overlapping: false, .. }) => format!("{}-from-{start_s}s", self.seed),
            Some(Window { start_s, overlapping: true, .. }) => format!("{}-from-{start_s}s-overlapping", self.seed),
        }
    }

    /// When its log begins.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.window.map_or(0.0, |window| window.start_s)
    }
}

/// How a trial ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The learned models pass the scenario's rule.
    Converged,
    /// They do not, or the learner itself says that it failed.
    Diverged,
    /// The learner says what the log lacks.
    CannotLearn,
    /// Our mistake, or the machine's: no result.
    Error,
}

impl Ending {
    /// Its name in `trials.csv`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Ending::Converged => "converged",
            Ending::Diverged => "diverged",
            Ending::CannotLearn => "cannot_learn",
            Ending::Error => "error",
        }
    }
}

/// A row of `trials.csv`, and what figures need of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Which of the scenario's rows.
    pub row: usize,
    /// On which log.
    pub case: Case,
    /// How it ended.
    pub ending: Ending,
    /// Why it did not converge; empty if it did.
    pub reason: String,
    /// What the log could not determine, though the learner went on.
    pub lacks: Vec<String>,
    /// Against the truth.
    pub scores: Scores,
    /// Degree of the learned sensor model, if it is a polynomial.
    pub sensor_degree: Option<usize>,
    /// Degree of the learned action model, if it is a polynomial.
    pub action_degree: Option<usize>,
    /// Passes over the data, of a method that iterates.
    pub iterations: Option<u32>,
    /// What was learned, as a `models.toml`; `None` if nothing was.
    pub models: Option<String>,
    /// Errors on the way, of a method that learns as it goes.
    pub curve: Vec<CurvePoint>,
    /// Curves worth drawing, of the first case only: name, then time in s and value.
    pub traces: Vec<(String, Vec<[f64; 2]>)>,
}

/// Errors of the models that a learner had part of the way through a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    /// Seconds since the log began.
    pub t_s: f64,
    /// As in [`Scores`].
    pub sensor_rmse_m: Option<f64>,
    /// As in [`Scores`].
    pub action_rmse_m_per_s: Option<f64>,
}

/// What a trial is run with.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// Which of the scenario's rows.
    pub index: usize,
    /// That row.
    pub row: &'a Row,
    /// Its learner, with the row's parameters.
    pub learner: &'a dyn Learner,
    /// When it counts as diverged.
    pub divergence: &'a Divergence,
    /// Whether curves are kept for figures.
    pub keep_traces: bool,
}

/// Runs one trial, and says how long it took in seconds. A panic inside it ends it and nothing else.
#[must_use]
pub fn run(setting: Setting<'_>, case: Case, dataset: &Dataset, yardstick: &Yardstick) -> (Trial, f64) {
    let began = Instant::now();
    let trial = catch_unwind(AssertUnwindSafe(|| learn(setting, case, dataset, yardstick)))
        .unwrap_or_else(|panic| failed(setting.index, case, panic_message(&*panic)));
    (trial, began.elapsed().as_secs_f64())
}

/// A trial that gave no result because something is broken.
#[must_use]
pub fn failed(row: usize, case: Case, reason: String) -> Trial {
    Trial { ending: Ending::Error, reason, ..blank(row, case) }
}

/// What a panic said.
#[must_use]
pub fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!("panicked: {}", text.unwrap_or("no message"))
}

fn blank(row: usize, case: Case) -> Trial {
    Trial {
        row,
        case,
        ending: Ending::CannotLearn,
        reason: String::new(),
        lacks: Vec::new(),
        scores: Scores::default(),
        sensor_degree: None,
        action_degree: None,
        iterations: None,
        models: None,
        curve: Vec::new(),
        traces: Vec::new(),
    }
}

fn learn(setting: Setting<'_>, case: Case, dataset: &Dataset, yardstick: &Yardstick) -> Trial {
    let blank = blank(setting.index, case);
    let Some(given) = given(setting.row.start, yardstick) else {
        return Trial { reason: "the models were not surveyed: there is no reference to be given".into(), ..blank };
    };
    let begin_s = case.start_s();
    let log = dataset.log.window(begin_s..begin_s + setting.row.duration_s);
    let mut rng = Seed(case.seed).stream(&format!("learner/{}", setting.row.learner));
    match setting.learner.learn(&log, &given, &mut rng) {
        Ok(learned) => judged(setting, learned, yardstick, blank),
        Err(lack) => Trial { reason: lack.to_string(), ..blank },
    }
}

fn given(start: Option<Start>, yardstick: &Yardstick) -> Option<Models> {
    match start {
        None => Some(Models::default()),
        Some(Start::ReferenceQuartic) => Some(Models { action: Some(yardstick.best_action(4)?), ..Models::default() }),
        Some(Start::ReferenceCubic) => Some(Models { sensor: Some(yardstick.best_sensor(3)?), ..Models::default() }),
        Some(start) => start.models(),
    }
}

fn judged(setting: Setting<'_>, learned: Learned, yardstick: &Yardstick, blank: Trial) -> Trial {
    let scores = yardstick.score(&learned.models);
    let faults = faults(&learned, &scores, yardstick, setting.divergence);
    let traces = if setting.keep_traces { learned.traces.as_slice() } else { &[] };
    Trial {
        ending: if faults.is_empty() { Ending::Converged } else { Ending::Diverged },
        reason: faults.join("; "),
        lacks: learned.lacks.iter().map(ToString::to_string).collect(),
        scores,
        sensor_degree: sensor_degree(&learned.models),
        action_degree: action_degree(&learned.models),
        iterations: learned.iterations,
        // What the format refuses, numbers that are none above all, is worth no file.
        models: store::models_text(&setting.row.label, &learned.models).ok(),
        curve: learned.history.iter().filter_map(|step| curve_point(step, yardstick)).collect(),
        traces: traces.iter().map(|trace| (trace.name.to_owned(), finite_points(&trace.points))).collect(),
        ..blank
    }
}

/// The rules of divergence that a trial breaks; the same for every learner.
fn faults(learned: &Learned, scores: &Scores, yardstick: &Yardstick, divergence: &Divergence) -> Vec<String> {
    let mut faults = Vec::new();
    if let asami_learners::Verdict::Diverged { rule } = learned.verdict {
        faults.push(rule.to_owned());
    }
    faults.extend(yardstick.faults(&learned.models, scores, divergence.r2_min));
    faults
}

fn sensor_degree(models: &Models) -> Option<usize> {
    match models.sensor.as_ref()? {
        SensorModel::HeightOfDistance(curve)
        | SensorModel::DistanceOfHeight(curve)
        | SensorModel::RangeOfDistance(curve) => Some(curve.polynomial.degree()),
        SensorModel::Angles { .. } => None,
    }
}

fn action_degree(models: &Models) -> Option<usize> {
    match models.action.as_ref()? {
        ActionModel::Polynomial(curve) => Some(curve.polynomial.degree()),
        ActionModel::Sign | ActionModel::Table(_) | ActionModel::Car { .. } => None,
    }
}

fn curve_point(step: &asami_learners::Step, yardstick: &Yardstick) -> Option<CurvePoint> {
    let Scores { sensor_rmse_m, action_rmse_m_per_s, .. } = yardstick.score(&step.models);
    Some(CurvePoint { t_s: step.t_s?, sensor_rmse_m, action_rmse_m_per_s })
}

fn finite_points(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().copied().filter(|point| point.iter().all(|x| x.is_finite())).collect()
}
