//! All trials of a scenario: plan, run, merge.
//!
//! The unit of work is a case: its log is made once, every row's learner learns from it, and it is
//! dropped. Cases run in parallel; each finished one is a file, so that a stopped sweep goes on
//! where it was. What is written is the same whatever the order, the threads or the interruptions.

pub mod car;
pub mod cases;
pub mod line;
pub mod manifest;
pub mod outcome;
pub mod plane;
pub mod progress;
pub mod quantity;
pub mod rows;
pub mod source;
pub mod spread;
pub mod stride;
pub mod table;
pub mod tally;
pub mod verb;
pub mod verdict;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use asami_dataset::{Dataset, Survey};
use asami_learners::Learner;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::scenario::Scenario;
use crate::study::{Reference, Study};
use crate::trial::{self, Case, Ending, Setting, Trial};

/// A checked scenario with everything that its names stand for.
pub struct Plan {
    /// What is asked.
    pub scenario: Scenario,
    /// Where logs come from.
    pub source: Box<dyn source::Source>,
    /// One learner for each of the scenario's rows.
    pub learners: Vec<Box<dyn Learner>>,
}

/// How a sweep is run; nothing here changes a result.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where results go.
    pub out: PathBuf,
    /// Threads; `None`: one for each core.
    pub jobs: Option<usize>,
    /// What the program is: its file's hash. Results of another program are not gone on with.
    pub program: String,
}

/// Hears how a sweep goes on.
pub trait Watcher: Sync {
    /// Before the first case: how many cases and trials there are, and how many are done already.
    fn begins(&self, found: &cases::Count, trials_per_case: usize);
    /// A case is done.
    fn finished(&self, case: &Case, timing: &Timing);
}

/// Hears nothing.
pub struct Silent;

impl Watcher for Silent {
    fn begins(&self, _found: &cases::Count, _trials_per_case: usize) {}
    fn finished(&self, _case: &Case, _timing: &Timing) {}
}

/// What is kept of a finished case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Record<S: Study> {
    /// Which.
    pub case: Case,
    /// One for each row of the scenario, in order.
    pub trials: Vec<Trial<S::Scores>>,
    /// Rows that need the truth: the best models there are, starting models as they are.
    pub references: Vec<Reference<S::Scores>>,
    /// What tables need of the truth itself.
    pub truth: S::Truth,
    /// How long it took; goes to `timings.csv` only.
    pub timing: Timing,
}

/// Wall-clock seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// To make or read the log.
    pub log_s: f64,
    /// Of each trial.
    pub trials_s: Vec<f64>,
}

/// A sweep's results, complete and in order.
pub struct Results<S: Study> {
    /// What was asked.
    pub scenario: Scenario,
    /// One for each case, in the scenario's order.
    pub records: Vec<Record<S>>,
    /// Truth about the models, where the cases share one.
    pub survey: Option<Survey>,
    /// The same after the robot changed.
    pub changed: Option<Survey>,
}

impl<S: Study> Results<S> {
    /// Every trial, by row and then by case.
    pub fn trials(&self) -> impl Iterator<Item = (&Record<S>, &Trial<S::Scores>)> {
        (0..self.scenario.rows.len())
            .flat_map(move |row| self.records.iter().filter_map(move |record| Some((record, record.trials.get(row)?))))
    }

    /// The cases that statistics are taken over: not the overlapping windows, which would count data twice.
    pub fn counted(&self) -> impl Iterator<Item = &Record<S>> {
        self.records.iter().filter(|record| !record.case.window.is_some_and(|window| window.overlapping))
    }

    /// Whether some trial gave no result.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.trials().any(|(_, trial)| trial.ending == Ending::Error)
    }
}

/// Whose numbers a line holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    /// Measured in this sweep.
    Asami,
    /// Needs truth: no learner could have it.
    Reference,
    /// Printed.
    Dissertation,
}

impl Whose {
    /// As in the tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Whose::Asami => "asami",
            Whose::Reference => "reference",
            Whose::Dissertation => "dissertation",
        }
    }
}

/// What is said when a sweep is over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finished {
    /// For a terminal.
    pub text: String,
    /// Whether some trial gave no result.
    pub has_errors: bool,
}

/// What keeps a sweep from going on at all.
#[derive(Debug, thiserror::Error)]
pub enum CannotSweep {
    /// A file of results cannot be written or read.
    #[error("cannot {what} {}: {source}", path.display())]
    File {
        /// What was tried.
        what: &'static str,
        /// On which file.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// The threads cannot be started.
    #[error("cannot start the threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl CannotSweep {
    /// For `map_err`: what was tried on which file.
    pub fn file(what: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { what, path, source }
    }
}

/// Runs the cases that are not done yet, and gives all of them.
///
/// # Errors
/// [`CannotSweep`] if files cannot be written; nothing that happens inside a trial is an error here.
pub fn run<S: Study>(plan: &Plan, options: &Options, watcher: &dyn Watcher) -> Result<Results<S>, CannotSweep> {
    let cases = plan.source.cases();
    let store = cases::Store::open(&options.out, &key(plan, options))?;
    let found = store.find::<Record<S>>(&cases.iter().map(Case::name).collect::<Vec<_>>())?;
    watcher.begins(&found.count, plan.learners.len());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.jobs.unwrap_or(0)).build()?;
    let records = pool.install(|| {
        let work: Vec<_> = cases.iter().zip(found.records).enumerate().collect();
        work.into_par_iter()
            // One at a time: a case takes seconds, and a thread must not sit on a queue of them.
            .with_max_len(1)
            .map(|(i, (case, done))| {
                if let Some(record) = done {
                    return Ok(record);
                }
                let record = run_case::<S>(plan, *case, i == 0);
                // A case with an error is tried again next time.
                if record.trials.iter().all(|trial| trial.ending != Ending::Error) {
                    store.keep(&case.name(), &record)?;
                }
                watcher.finished(&record.case, &record.timing);
                Ok(record)
            })
            .collect::<Result<Vec<_>, CannotSweep>>()
    })?;
    let (survey, changed) = (plan.source.survey(), plan.source.changed());
    Ok(Results { scenario: plan.scenario.clone(), records, survey, changed })
}

/// What a case's results depend on, beside the case itself.
fn key(plan: &Plan, options: &Options) -> String {
    let parts = [plan.scenario.hash(), plan.source.fingerprint(), options.program.clone()];
    blake3::hash(parts.join("\n").as_bytes()).to_hex().to_string()
}

fn run_case<S: Study>(plan: &Plan, case: Case, keep_traces: bool) -> Record<S> {
    let began = Instant::now();
    let made = catch_unwind(AssertUnwindSafe(|| plan.source.dataset(&case)))
        .unwrap_or_else(|panic| Err(trial::panic_message(&*panic)));
    let log_s = began.elapsed().as_secs_f64();
    match made {
        Ok(dataset) => learn_all::<S>(plan, case, &dataset, keep_traces, log_s),
        Err(reason) => Record {
            case,
            trials: (0..plan.learners.len()).map(|row| trial::failed(row, case, reason.clone())).collect(),
            references: Vec::new(),
            truth: S::Truth::default(),
            timing: Timing { log_s, trials_s: vec![0.0; plan.learners.len()] },
        },
    }
}

fn learn_all<S: Study>(plan: &Plan, case: Case, dataset: &Dataset, keep_traces: bool, log_s: f64) -> Record<S> {
    let scenario = &plan.scenario;
    let yardstick = S::yardstick(scenario, dataset, plan.source.changed().as_ref());
    let settings = scenario.rows.iter().zip(&plan.learners).enumerate();
    let (trials, trials_s) = settings
        .map(|(index, (row, learner))| {
            let setting = Setting { scenario, index, row, learner: &**learner, keep_traces };
            trial::run::<S>(setting, case, dataset, &yardstick)
        })
        .unzip();
    let references = S::references(scenario, &dataset.log, &yardstick);
    Record { case, trials, references, truth: S::truth(&yardstick), timing: Timing { log_s, trials_s } }
}
