//! From a blind scenario to records: plan cases, simulate or read them, let every diagnoser see the log alone, score, keep.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use asami_dataset::Log;
use asami_gap::{Diagnoses, Diagnosis, Judges, Variant};
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::answer::{Answer, Key};
use super::draw::{Case, Planting};
use super::folder::{CannotOpen, Folder};
use super::next::{self, Advised, Driven};
use super::referee::{self, Reference};
use super::scenario::{Asked, Blind, Expect};
use crate::diagnose::limits::limits;
use crate::diagnose::shelf::CannotShelve;
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

    /// The nominal world driven as a diagnosis advises, by its keys; `None` where nobody advises.
    ///
    /// # Errors
    /// [`CannotShelve`] where it cannot be played, or what it does not be kept.
    fn driven(&self, keys: &str) -> Result<Option<Driven<'_>>, CannotShelve>;

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
    /// Of what is planted, what the catalogue still holds.
    #[must_use]
    pub fn listed(&self) -> Vec<&String> {
        self.planted.iter().filter(|name| !self.withheld.contains(name)).collect()
    }

    /// Whether something broke that was not the log's fault.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        !self.error.is_empty() || self.answers.iter().any(|answer| answer.error.starts_with(PANICKED))
    }
}

/// How [`panic_message`] begins.
const PANICKED: &str = "panicked: ";

/// What is asked of results, wherever they come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The scenario's name.
    pub name: String,
    /// Its question.
    pub about: String,
    /// Its hash.
    pub hash: String,
    /// Who was asked, in order.
    pub diagnosers: Vec<String>,
    /// Whether, where causes were tied, what was recorded next is told of.
    pub next_experiment: bool,
    /// The expected answers.
    pub expect: Vec<Expect>,
}

/// Complete results, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// What was asked.
    pub question: Question,
    /// Scenarios of the cases, each with how many there are: one, or of a pool several.
    pub of: Vec<(String, usize)>,
    /// One for each case.
    pub records: Vec<Record>,
}

impl Results {
    /// Those of one blind scenario.
    #[must_use]
    pub fn new(blind: &Blind, records: Vec<Record>) -> Self {
        let Asked { diagnosers, next_experiment, expect, .. } = blind.asked.clone();
        let (name, about, hash) = (blind.name.clone(), blind.about.clone(), blind.hash());
        let question = Question { name: name.clone(), about, hash, diagnosers, next_experiment, expect };
        Self { question, of: vec![(name, records.len())], records }
    }

    /// Every record with the scenario that it is a case of.
    pub fn cases(&self) -> impl Iterator<Item = (&str, &Record)> {
        let names = self.of.iter().flat_map(|(name, count)| std::iter::repeat_n(name.as_str(), *count));
        names.zip(&self.records)
    }

    /// Whether the cases are of several scenarios: what is asked of one world's effects is asked of none then.
    #[must_use]
    pub fn is_pool(&self) -> bool {
        self.of.len() > 1
    }
}

/// Why there are no results.
#[derive(Debug, thiserror::Error)]
pub enum CannotRun {
    /// Files cannot be written.
    #[error(transparent)]
    Sweep(#[from] CannotSweep),
    /// Another program's cases cannot be used.
    #[error(transparent)]
    Open(#[from] CannotOpen),
    /// What was advised cannot be played.
    #[error(transparent)]
    Shelve(#[from] CannotShelve),
}

/// Runs the cases that are not done yet, and gives all of them.
///
/// # Errors
/// [`CannotRun`] if files cannot be written, or another program's cases not be read; nothing that happens inside a case is
/// an error here.
pub fn run(
    blind: &Blind,
    contest: &dyn Contest,
    options: &Options,
    watcher: &dyn Watcher,
) -> Result<Results, CannotRun> {
    let records = match Folder::of(blind)? {
        None => drawn(blind, contest, options, watcher)?,
        Some(folder) => foreign(blind, &folder, contest, options, watcher)?,
    };
    Ok(Results::new(blind, records))
}

/// Cases drawn by the salt: each is simulated, diagnosed and scored at once; what they are advised to record next comes after all.
fn drawn(
    blind: &Blind,
    contest: &dyn Contest,
    options: &Options,
    watcher: &dyn Watcher,
) -> Result<Vec<Record>, CannotRun> {
    let parts = [blind.hash(), contest.fingerprint(), options.program.clone()];
    let store = Store::open(&options.out, blake3::hash(parts.join("\n").as_bytes()).to_hex().as_ref())?;
    let planting = Planting {
        nominal: blind.world.clone(),
        salt: blind.asked.salt.clone(),
        mix: blind.asked.mix.clone(),
        places: blind.asked.places.clone(),
    };
    let make = |number: usize| run_case(blind, contest, &planting, &planting.case(number));
    let worth = |record: &Record| (!record.is_broken(), record.timing.clone());
    let mut records = each(&store, blind, options, watcher, &make, &worth)?;
    let keep = |record: &Record| store.keep(&name(record.number), record);
    pool(options)?.install(|| next::follow(&mut records, contest, &planting, &keep))?;
    Ok(records)
}

/// Another program's cases: all are diagnosed, and what is said of them written down, before the first key is opened.
fn foreign(
    blind: &Blind,
    folder: &Folder,
    contest: &dyn Contest,
    options: &Options,
    watcher: &dyn Watcher,
) -> Result<Vec<Record>, CannotRun> {
    let parts = [blind.hash(), contest.fingerprint(), folder.fingerprint()?, options.program.clone()];
    let out = options.out.join("diagnoses");
    let store = Store::open(&out, blake3::hash(parts.join("\n").as_bytes()).to_hex().as_ref())?;
    let make = |number: usize| {
        let log = folder.log(number - 1).map_err(|error| error.to_string());
        let log = log.and_then(|log| limits(&log).map_err(|error| error.to_string())).map(|limited| limited.log);
        let diagnosers = contest.diagnosers(&[]);
        let told = diagnosers.iter().map(|diagnoser| match &log {
            Ok(log) => tell(&**diagnoser, log),
            Err(error) => Told { said: Err(error.clone()), took_s: 0.0 },
        });
        told.collect::<Vec<Told>>()
    };
    let timing = |told: &Vec<Told>| Timing { log_s: 0.0, trials_s: told.iter().map(|it| it.took_s).collect() };
    let kept = |told: &Vec<Told>| (told.iter().all(|it| !it.panicked()), timing(told));
    let told = each(&store, blind, options, watcher, &make, &kept)?;
    let records = pool(options)?.install(|| {
        let all = told.into_par_iter().enumerate().with_max_len(1);
        all.map(|(i, told)| open_and_score(blind, contest, folder, i, told)).collect::<Result<Vec<_>, _>>()
    });
    Ok(records?)
}

/// Makes what is not kept of each case, by number from 1; what `worth` says no to is tried again next time.
fn each<R: Serialize + DeserializeOwned + Send>(
    store: &Store,
    blind: &Blind,
    options: &Options,
    watcher: &dyn Watcher,
    make: &(dyn Fn(usize) -> R + Sync),
    worth: &(dyn Fn(&R) -> (bool, Timing) + Sync),
) -> Result<Vec<R>, CannotSweep> {
    let numbers: Vec<usize> = (1..=blind.asked.cases).collect();
    let found = store.find::<R>(&numbers.iter().map(|number| name(*number)).collect::<Vec<_>>())?;
    watcher.begins(&found.count, blind.asked.diagnosers.len());
    pool(options)?.install(|| {
        let work: Vec<_> = numbers.into_iter().zip(found.records).collect();
        work.into_par_iter()
            // One at a time: a case takes seconds, and a thread must not sit on a queue of them.
            .with_max_len(1)
            .map(|(number, done)| {
                if let Some(done) = done {
                    return Ok(done);
                }
                let made = make(number);
                let (is_worth, timing) = worth(&made);
                if is_worth {
                    store.keep(&name(number), &made)?;
                }
                watcher.finished(&trial::Case { seed: number as u64, ..trial::Case::default() }, &timing);
                Ok(made)
            })
            .collect()
    })
}

/// As many threads as are asked for.
fn pool(options: &Options) -> Result<rayon::ThreadPool, CannotSweep> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(options.jobs.unwrap_or(0)).build()?)
}

/// The file of a case in the folder of finished ones.
pub(super) fn name(number: usize) -> String {
    format!("{number:05}")
}

impl Record {
    /// A case of which nothing is known yet.
    pub(super) fn blank(blind: &Blind, number: usize, planted: Vec<String>) -> Self {
        let diagnosers = blind.asked.diagnosers.len();
        Self {
            number,
            reference: None,
            planted,
            withheld: Vec::new(),
            answers: vec![Answer::default(); diagnosers],
            error: String::new(),
            timing: Timing { log_s: 0.0, trials_s: vec![0.0; diagnosers] },
        }
    }

    fn failed(self, error: String) -> Self {
        Self { error, ..self }
    }

    /// The log shows nothing at all.
    fn unanswered(mut self, error: &str) -> Self {
        self.answers.iter_mut().for_each(|answer| answer.error = error.to_owned());
        self
    }
}

fn run_case(blind: &Blind, contest: &dyn Contest, planting: &Planting, case: &Case) -> Record {
    let began = Instant::now();
    let planted = case.planted.iter().map(|it| it.variant.about.name.to_owned()).collect();
    let mut record = Record::blank(blind, case.number, planted);
    let made = catch_unwind(AssertUnwindSafe(|| planting.simulate(case, &blind.nominal)))
        .map_or_else(|panic| Err(panic_message(&*panic)), |made| made.map_err(|error| error.to_string()));
    // Truth and survey end here: what follows is given the log.
    let log = match made {
        Ok(dataset) => dataset.log,
        Err(error) => return record.failed(error),
    };
    let likelihood = match contest.judges().of(&log) {
        Ok(likelihood) => likelihood,
        Err(error) => return record.unanswered(&error.to_string()),
    };
    let reference = referee::judge(&*likelihood, &case.planted, contest.variants(), &blind.asked);
    record.withheld = blind.asked.withheld(case.number, &reference.effects);
    record.timing.log_s = began.elapsed().as_secs_f64();
    let key = Key {
        reference: &reference,
        withheld: &record.withheld,
        likelihood: &*likelihood,
        variants: contest.variants(),
    };
    let diagnosers = contest.diagnosers(&record.withheld);
    for (i, diagnoser) in diagnosers.iter().enumerate().take(record.answers.len()) {
        let told = tell(&**diagnoser, &log);
        record.timing.trials_s[i] = told.took_s;
        let asks = told.said.as_ref().ok().filter(|_| blind.asked.next_experiment);
        let advised = asks.and_then(|diagnosis| Advised::of(diagnosis, &key));
        record.answers[i] = Answer { advised, ..told.scored(&key) };
    }
    record.reference = Some(reference);
    record
}

/// Opens the key of the `i`-th of another program's cases, and holds what was said of it against the key.
fn open_and_score(
    blind: &Blind,
    contest: &dyn Contest,
    folder: &Folder,
    i: usize,
    told: Vec<Told>,
) -> Result<Record, CannotOpen> {
    let opened = folder.open(i, contest.variants())?;
    let mut record = Record::blank(blind, i + 1, opened.names());
    record.withheld = opened.unlisted.iter().map(|it| it.name.clone()).collect();
    record.timing.trials_s = told.iter().map(|it| it.took_s).collect();
    let log = match folder.log(i) {
        Ok(log) => log,
        Err(error) => return Ok(record.failed(error.to_string())),
    };
    let limited = limits(&log).map_err(|error| error.to_string());
    let likelihood = match &limited {
        Ok(limited) => contest.judges().of(&limited.log).map_err(|error| error.to_string()),
        Err(error) => Err(error.clone()),
    };
    let likelihood = match likelihood {
        Ok(likelihood) => likelihood,
        Err(error) => return Ok(record.unanswered(&error)),
    };
    let reference = if opened.unlisted.is_empty() {
        referee::judge(&*likelihood, &opened.planted, contest.variants(), &blind.asked)
    } else {
        referee::judge_unlisted(&*likelihood, &opened.unlisted)
    };
    let key = Key {
        reference: &reference,
        withheld: &record.withheld,
        likelihood: &*likelihood,
        variants: contest.variants(),
    };
    record.answers = told.into_iter().map(|told| told.scored(&key)).collect();
    record.reference = Some(reference);
    Ok(record)
}

/// What a diagnoser says of a log, before anybody has opened its key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Told {
    said: Result<Diagnosis, String>,
    took_s: f64,
}

impl Told {
    fn panicked(&self) -> bool {
        self.said.as_ref().is_err_and(|error| error.starts_with(PANICKED))
    }

    fn scored(self, key: &Key<'_>) -> Answer {
        self.said.map_or_else(|error| Answer { error, ..Answer::default() }, |diagnosis| key.score(&diagnosis))
    }
}

/// One diagnoser on one log.
fn tell(diagnoser: &dyn Diagnoses, log: &Log) -> Told {
    let began = Instant::now();
    let found = catch_unwind(AssertUnwindSafe(|| diagnoser.diagnose(log)));
    let took_s = began.elapsed().as_secs_f64();
    let said = match found {
        Ok(told) => told.map_err(|error| error.to_string()),
        Err(panic) => Err(panic_message(&*panic)),
    };
    Told { said, took_s }
}
