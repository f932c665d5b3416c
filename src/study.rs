//! What a study is to a sweep: how models are given, scored and judged, and what is written about many
//! trials. Everything else (cases, threads, going on where it stopped) is the same for all.

use std::fmt::Debug;

use asami_dataset::{Dataset, Log, Models, Survey};
use asami_learners::{Learned, learner::Trace};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::scenario::{Row, Scenario, Start};
use crate::sweep::{CannotSweep, Finished, Results};

/// A study's side of a sweep.
pub trait Study: Clone + Debug + PartialEq + Send + Sync + 'static {
    /// Errors of learned models.
    type Scores: Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync;
    /// Truth to score against.
    type Yardstick: Send + Sync;
    /// What tables need of it.
    type Truth: Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync;

    /// Truth about the models of a data set; `changed` is the survey of the robot after its change.
    fn yardstick(scenario: &Scenario, dataset: &Dataset, changed: Option<&Survey>) -> Self::Yardstick;

    /// The models that a row's learner is given for a log.
    ///
    /// # Errors
    /// Why there are none, in a sentence.
    fn given(scenario: &Scenario, row: &Row, log: &Log, yardstick: &Self::Yardstick) -> Result<Models, String>;

    /// What tables need of the truth.
    fn truth(yardstick: &Self::Yardstick) -> Self::Truth;

    /// How far models are from the truth.
    fn score(yardstick: &Self::Yardstick, models: &Models) -> Self::Scores;

    /// The rules of divergence that models break.
    fn faults(
        scenario: &Scenario,
        row: &Row,
        yardstick: &Self::Yardstick,
        models: &Models,
        scores: &Self::Scores,
    ) -> Vec<String>;

    /// Adds what takes the log to tell, of the models that a trial ended with.
    fn inspect(log: &Log, models: &Models, scores: &mut Self::Scores) {
        let _ = (log, models, scores);
    }

    /// Adds what takes more than the models to tell, of what a trial's learner learned, and gives further curves worth
    /// drawing.
    fn follow(yardstick: &Self::Yardstick, learned: &Learned, scores: &mut Self::Scores) -> Vec<Trace> {
        let _ = (yardstick, learned, scores);
        Vec::new()
    }

    /// Rows of a case that need the truth and are no learner's.
    fn references(scenario: &Scenario, log: &Log, yardstick: &Self::Yardstick) -> Vec<Reference<Self::Scores>>;

    /// Writes everything that is said about complete results.
    ///
    /// # Errors
    /// If a file cannot be written.
    fn finish(results: Results<Self>, finishing: &Finishing<'_>) -> Result<Finished, CannotSweep>;
}

/// A row that needs the truth and is no learner's.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Reference<S> {
    /// `floor`, `unlearned` or `bound`.
    pub name: String,
    /// The starting model as it is, of `unlearned`.
    pub start: Option<Start>,
    /// Its errors.
    pub scores: S,
}

/// What is needed to write about results, beside them.
pub struct Finishing<'a> {
    /// Where to.
    pub out: &'a std::path::Path,
    /// The program's hash.
    pub program: &'a str,
    /// What a report shows of the robot.
    pub exhibits: crate::report::exhibits::Exhibits,
}
