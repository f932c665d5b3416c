//! One trial: one learner, started one way, on one log. What came of it is a row, whatever it is.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use asami_dataset::{ActionModel, Dataset, Log, Models, Seed, SensorModel, store};
use asami_learners::{Learned, Learner, Step};
use serde::{Deserialize, Serialize};

use crate::scenario::{Era, Origin, Row, Scenario, Window};
use crate::study::Study;

/// A log of a scenario: simulated from a seed, or a window of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Seed of the simulation; of a recording, the seed of the learners' own draws.
    pub seed: u64,
    /// The window of a recording.
    pub window: Option<Window>,
    /// Whose log, of a recording of several robots.
    pub robot: Option<u16>,
    /// How many landmarks are left in the log, where some are taken out.
    pub landmarks: Option<u16>,
}

impl Case {
    /// Its name in file names.
    #[must_use]
    pub fn name(&self) -> String {
        let robot = self.robot.map_or_else(String::new, |robot| format!("-robot-{robot}"));
        let landmarks = self.landmarks.map_or_else(String::new, |landmarks| format!("-landmarks-{landmarks}"));
        let window = match self.window {
            None => String::new(),
            Some(Window { start_s, overlapping: false, .. }) => format!("-from-{start_s}s"),
            Some(Window { start_s, overlapping: true, .. }) => format!("-from-{start_s}s-overlapping"),
        };
        format!("{}{robot}{landmarks}{window}", self.seed)
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

/// A row of `trials.csv`, and what figures need of it. `S` are the scores of the study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial<S> {
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
    pub scores: S,
    /// Degree of the learned sensor model, if it is a polynomial.
    pub sensor_degree: Option<usize>,
    /// Degree of the learned action model, if it is a polynomial.
    pub action_degree: Option<usize>,
    /// Passes over the data, of a method that iterates.
    pub iterations: Option<u32>,
    /// Of a method that has one.
    pub likelihood: Option<Likelihood>,
    /// Sightings in the log.
    pub observations: usize,
    /// What was learned, as a `models.toml`; `None` if nothing was.
    pub models: Option<String>,
    /// Errors on the way, of a method that learns as it goes or iterates.
    pub curve: Vec<CurvePoint<S>>,
    /// Curves worth drawing, of the first case only: name, then time in s and value.
    pub traces: Vec<(String, Vec<[f64; 2]>)>,
}

/// Log-likelihoods in nats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Likelihood {
    /// Of the starting models.
    pub start: f64,
    /// The greatest on the way.
    pub best: f64,
}

/// Errors of the models that a learner had part of the way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint<S> {
    /// Seconds into the log, of a method that learns as it goes.
    pub t_s: Option<f64>,
    /// Which of the method's steps, from 0.
    pub step: usize,
    /// Log-likelihood in nats, of a method that has one.
    pub log_likelihood: Option<f64>,
    /// Of the models then.
    pub scores: S,
}

/// What a trial is run with.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Which of its rows.
    pub index: usize,
    /// That row.
    pub row: &'a Row,
    /// Its learner, with the row's parameters.
    pub learner: &'a dyn Learner,
    /// Whether curves are kept for figures.
    pub keep_traces: bool,
}

/// Runs one trial, and says how long it took in seconds. A panic inside it ends it and nothing else.
#[must_use]
pub fn run<S: Study>(
    setting: Setting<'_>,
    case: Case,
    dataset: &Dataset,
    yardstick: &S::Yardstick,
) -> (Trial<S::Scores>, f64) {
    let began = Instant::now();
    let trial = catch_unwind(AssertUnwindSafe(|| learn::<S>(setting, case, dataset, yardstick)))
        .unwrap_or_else(|panic| failed(setting.index, case, panic_message(&*panic)));
    (trial, began.elapsed().as_secs_f64())
}

/// A trial that gave no result because something is broken.
#[must_use]
pub fn failed<S: Default>(row: usize, case: Case, reason: String) -> Trial<S> {
    Trial { ending: Ending::Error, reason, ..blank(row, case) }
}

/// What a panic said.
#[must_use]
pub fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!("panicked: {}", text.unwrap_or("no message"))
}

fn blank<S: Default>(row: usize, case: Case) -> Trial<S> {
    Trial {
        row,
        case,
        ending: Ending::CannotLearn,
        reason: String::new(),
        lacks: Vec::new(),
        scores: S::default(),
        sensor_degree: None,
        action_degree: None,
        iterations: None,
        likelihood: None,
        observations: 0,
        models: None,
        curve: Vec::new(),
        traces: Vec::new(),
    }
}

/// Scores in the place of a trial's: of what needs the truth and is no learner's.
#[must_use]
pub fn of_scores<S: Default>(case: Case, scores: S) -> Trial<S> {
    Trial { scores, ..blank(0, case) }
}

/// The part of a case's log that a row is given.
#[must_use]
pub fn part(scenario: &Scenario, row: &Row, case: &Case, log: &Log) -> Log {
    let change_s = match (&scenario.origin, row.era) {
        (Origin::Simulated(simulation), Era::After) => simulation.change_s(),
        _ => None,
    };
    let begin_s = case.start_s() + change_s.unwrap_or(0.0);
    log.window(begin_s..begin_s + row.duration_s)
}

fn learn<S: Study>(setting: Setting<'_>, case: Case, dataset: &Dataset, yardstick: &S::Yardstick) -> Trial<S::Scores> {
    let Setting { scenario, row, .. } = setting;
    let log = part(scenario, row, &case, &dataset.log);
    let blank = Trial { observations: log.sightings.len(), ..blank(setting.index, case) };
    let given = match S::given(scenario, row, &log, yardstick) {
        Ok(given) => given,
        Err(reason) => return Trial { reason, ..blank },
    };
    let mut rng = Seed(case.seed).stream(&format!("learner/{}", row.learner));
    match setting.learner.learn(&log, &given, &mut rng) {
        Ok(learned) => judged::<S>(setting, &log, learned, yardstick, blank),
        Err(lack) => Trial { reason: lack.to_string(), ..blank },
    }
}

fn judged<S: Study>(
    setting: Setting<'_>,
    log: &Log,
    learned: Learned,
    yardstick: &S::Yardstick,
    blank: Trial<S::Scores>,
) -> Trial<S::Scores> {
    let mut scores = S::score(yardstick, &learned.models);
    S::inspect(log, &learned.models, &mut scores);
    let further = S::follow(yardstick, &learned, &mut scores);
    let mut faults = Vec::new();
    if let asami_learners::Verdict::Diverged { rule } = learned.verdict {
        faults.push(rule.to_owned());
    }
    faults.extend(S::faults(setting.scenario, setting.row, yardstick, &learned.models, &scores));
    let traces = learned.traces.iter().chain(&further).filter(|_| setting.keep_traces);
    Trial {
        ending: if faults.is_empty() { Ending::Converged } else { Ending::Diverged },
        reason: faults.join("; "),
        lacks: learned.lacks.iter().map(ToString::to_string).collect(),
        scores,
        sensor_degree: sensor_degree(&learned.models),
        action_degree: action_degree(&learned.models),
        iterations: learned.iterations,
        likelihood: likelihood(&learned.history),
        // What the format refuses, numbers that are none above all, is worth no file.
        models: store::models_text(&setting.row.label, &learned.models).ok(),
        curve: curve::<S>(&learned.history, yardstick),
        traces: traces.map(|trace| (trace.name.to_owned(), finite_points(&trace.points))).collect(),
        ..blank
    }
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

fn likelihood(history: &[Step]) -> Option<Likelihood> {
    let mut all = history.iter().filter_map(|step| step.log_likelihood).filter(|nats| nats.is_finite());
    let start = all.next()?;
    Some(Likelihood { start, best: all.fold(start, f64::max) })
}

fn curve<S: Study>(history: &[Step], yardstick: &S::Yardstick) -> Vec<CurvePoint<S::Scores>> {
    let point = |step: usize| {
        let Step { t_s, log_likelihood, models } = &history[step];
        let log_likelihood = log_likelihood.filter(|nats| nats.is_finite());
        CurvePoint { t_s: *t_s, step, log_likelihood, scores: S::score(yardstick, models) }
    };
    match history.first().is_some_and(|first| first.t_s.is_some()) {
        true => (0..history.len()).map(point).collect(),
        false => worth_drawing(history.len()).map(point).collect(),
    }
}

/// Of so many iterations the first ones, then ever fewer, and the last: what a figure with a
/// logarithmic or a plain axis can show.
fn worth_drawing(count: usize) -> impl Iterator<Item = usize> {
    let next = |step: &usize| Some(step + 1 + step / 25);
    let thinned = std::iter::successors(Some(0), next).take_while(move |step| *step + 1 < count);
    thinned.chain(count.checked_sub(1))
}

fn finite_points(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().copied().filter(|point| point.iter().all(|x| x.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_iterations_few_are_drawn_and_the_ends_always() {
        for count in [0, 1, 2, 26, 300, 3000] {
            let drawn: Vec<usize> = worth_drawing(count).collect();
            assert!(drawn.windows(2).all(|pair| pair[0] < pair[1]), "{count}");
            assert!(drawn.len() <= 200 && drawn.first().copied() == (count > 0).then_some(0), "{count}");
            assert_eq!(drawn.last().copied(), count.checked_sub(1));
        }
    }
}
