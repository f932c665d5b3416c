//! From a blind scenario to records: plan cases, simulate, let every diagnoser see the log alone, score, keep.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use asami_dataset::Log;
use asami_gap::{Diagnoses, Judges, Variant};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::answer::{Answer, Key};
use super::draw::{Case, Planting};
use super::referee::{self, Reference};
use super::scenario::Blind;
use crate::sweep::cases::Store;
use crate::sweep::{CannotSweep, Options, Timing, Watcher};
use crate::trial::{self, panic_message};

/// Who takes part.
pub trait Contest: Sync {
    /// The referee's likelihood: it knows every effect.
    fn judges(&self) -> &dyn Judges;

    /// Every kind of effect that fits.
    fn variants(&self) -> &[Variant];

    /// The diagnosers, in the scenario's order, with these effects out of their catalogue.
    fn diagnosers(&self, without: &[String]) -> Vec<Box<dyn Diagnoses + '_>>;

    /// A hash of everything that they have beside the scenario: library, calibration.
    fn fingerprint(&self) -> String;
}

/// What is kept of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// From 1.
    pub number: usize,
    /// What the key says; `None` where there is no log, or it shows nothing at all.
    pub reference: Option<Reference>,
    /// The planted effects' names.
    pub planted: Vec<String>,
    /// Effects that were taken out of the catalogue for this case.
    pub withheld: Vec<String>,
    /// One for each diagnoser.
    pub answers: Vec<Answer>,
    /// Why there is no log, or no reference; empty if there are both.
    pub error: String,
    /// Goes to `timings.csv` only.
    pub timing: Timing,
}

impl Record {
    /// Whether something broke that was not the log's fault.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        !self.error.is_empty() || self.answers.iter().any(|answer| answer.error.starts_with(PANICKED))
    }
}

/// How [`panic_message`] begins.
const PANICKED: &str = "panicked: ";

/// Complete results, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// What was asked.
    pub blind: Blind,
    /// One for each case.
    pub records: Vec<Record>,
}

/// Runs the cases that are not done yet, and gives all of them.
///
/// # Errors
/// [`CannotSweep`] if files cannot be written; nothing that happens inside a case is an error here.
pub fn run(
    blind: &Blind,
    contest: &dyn Contest,
    options: &Options,
    watcher: &dyn Watcher,
) -> Result<Results, CannotSweep> {
    let parts = [blind.hash(), contest.fingerprint(), options.program.clone()];
    let store = Store::open(&options.out, blake3::hash(parts.join("\n").as_bytes()).to_hex().as_ref())?;
    let numbers: Vec<usize> = (1..=blind.asked.cases).collect();
    let found = store.find::<Record>(&numbers.iter().map(|number| name(*number)).collect::<Vec<_>>())?;
    watcher.begins(&found.count, blind.asked.diagnosers.len());
    let planting = Planting {
        nominal: blind.world.clone(),
        salt: blind.asked.salt.clone(),
        mix: blind.asked.mix.clone(),
        places: blind.asked.places.clone(),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.jobs.unwrap_or(0)).build()?;
    let records = pool.install(|| {
        let work: Vec<_> = numbers.into_iter().zip(found.records).collect();
        work.into_par_iter()
            // One at a time: a case takes seconds, and a thread must not sit on a queue of them.
            .with_max_len(1)
            .map(|(number, done)| {
                if let Some(record) = done {
                    return Ok(record);
                }
                let record = run_case(blind, contest, &planting, &planting.case(number));
                // A case that broke is tried again next time.
                if !record.is_broken() {
                    store.keep(&name(number), &record)?;
                }
                watcher.finished(&trial::Case { seed: number as u64, ..trial::Case::default() }, &record.timing);
                Ok(record)
            })
            .collect::<Result<Vec<_>, CannotSweep>>()
    })?;
    Ok(Results { blind: blind.clone(), records })
}

fn name(number: usize) -> String {
    format!("{number:05}")
}

fn run_case(blind: &Blind, contest: &dyn Contest, planting: &Planting, case: &Case) -> Record {
    let began = Instant::now();
    let planted: Vec<String> = case.planted.iter().map(|it| it.variant.about.name.to_owned()).collect();
    let mut record = Record {
        number: case.number,
        reference: None,
        planted,
        withheld: Vec::new(),
        answers: vec![Answer::default(); blind.asked.diagnosers.len()],
        error: String::new(),
        timing: Timing { log_s: 0.0, trials_s: vec![0.0; blind.asked.diagnosers.len()] },
    };
    let made = catch_unwind(AssertUnwindSafe(|| planting.simulate(case, &blind.nominal)))
        .map_or_else(|panic| Err(panic_message(&*panic)), |made| made.map_err(|error| error.to_string()));
    // Truth and survey end here: what follows is given the log.
    let log = match made {
        Ok(dataset) => dataset.log,
        Err(error) => {
            record.error = error;
            return record;
        }
    };
    let likelihood = match contest.judges().of(&log) {
        Ok(likelihood) => likelihood,
        Err(error) => {
            record.answers.iter_mut().for_each(|answer| answer.error = error.to_string());
            return record;
        }
    };
    let reference = referee::judge(&*likelihood, &case.planted, contest.variants(), &blind.asked);
    if blind.asked.without_truth {
        record.withheld = reference.effects.iter().flat_map(|effect| effect.group.clone()).collect();
    }
    record.timing.log_s = began.elapsed().as_secs_f64();
    let key = Key {
        reference: &reference,
        withheld: !record.withheld.is_empty(),
        likelihood: &*likelihood,
        variants: contest.variants(),
    };
    let diagnosers = contest.diagnosers(&record.withheld);
    for (i, diagnoser) in diagnosers.iter().enumerate().take(record.answers.len()) {
        let (answer, took_s) = ask(&**diagnoser, &log, &key);
        (record.answers[i], record.timing.trials_s[i]) = (answer, took_s);
    }
    record.reference = Some(reference);
    record
}

/// One diagnoser on one log.
fn ask(diagnoser: &dyn Diagnoses, log: &Log, key: &Key<'_>) -> (Answer, f64) {
    let began = Instant::now();
    let found = catch_unwind(AssertUnwindSafe(|| diagnoser.diagnose(log)));
    let took_s = began.elapsed().as_secs_f64();
    let failed = |error: String| Answer { error, ..Answer::default() };
    let answer = match found {
        Ok(Ok(diagnosis)) => key.score(&diagnosis),
        Ok(Err(error)) => failed(error.to_string()),
        Err(panic) => failed(panic_message(&*panic)),
    };
    (answer, took_s)
}
