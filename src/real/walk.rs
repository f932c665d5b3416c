//! From a scenario of real logs to records: import each, diagnose the whole of it and each half, hold both against motion
//! capture, keep.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use asami_dataset::{Dataset, Log};
use asami_gap::real::prior::Prior;
use asami_gap::real::scanner::Found;
use asami_gap::{Diagnosis, Nominal};
use asami_math::statistics::median;
use rayon::prelude::*;

use super::among::{LEAST, as_halves_differ, beside_make};
use super::capture::errors::errors;
use super::capture::steering::of_car;
use super::capture::{Capture, capture, of_axle};
use super::kept::Kept;
use super::learning::{Lesson, lessons};
use super::odometry::{Clocks, OfOthers};
use super::record::{Part, Record, in_order, name};
use super::scanner;
use super::scenario::{Real, Source};
use super::stand_in::Original;
use crate::diagnose::limits::of_real;
use crate::diagnose::progress::Listener;
use crate::diagnose::{self, Ready};
use crate::import;
use crate::scenario::{Policy, Robot};
use crate::sweep::cases::Store;
use crate::sweep::{CannotSweep, Options, Timing, Watcher, manifest};
use crate::trial::{self, panic_message};

/// Complete results, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// What was asked.
    pub real: Real,
    /// For each log its parts.
    pub records: Vec<Record>,
    /// The same of robots of which three and more are of a make, each beside what the others' logs say.
    pub among: Vec<Record>,
    /// What was learned from each log, and from simulated ones in its place.
    pub lessons: Vec<Lesson>,
}

/// A log, and all that its diagnosis needs.
struct Prepared<'a> {
    source: &'a Source,
    robot: Option<u16>,
    dataset: Dataset,
    /// What stands in for it has this of it.
    original: Original,
    clocks: Clocks,
    ready: &'a Ready,
    /// Of log and truth.
    hash: String,
}

/// Imports the logs, and diagnoses their parts that are not done yet.
///
/// # Errors
/// A report where a source or a nominal world cannot be used, or files not be written; nothing that happens inside a diagnosis
/// is an error here.
pub fn run(
    real: &Real,
    data: Option<&Path>,
    libraries: &Path,
    options: &Options,
    (watcher, listener): (&dyn Watcher, &dyn Listener),
) -> Result<Results, miette::Report> {
    let mut datasets: Vec<(&Source, Option<u16>, Imported)> = Vec::new();
    for source in &real.asked.logs {
        for robot in robots(source) {
            datasets.push((source, robot, imported(source, robot, &place(source, data))?));
        }
        like_others(source, &mut datasets);
        for (_, robot, imported) in datasets.iter().filter(|it| it.0.name == source.name) {
            let whose = robot.map_or_else(|| source.name.clone(), |robot| format!("{} {robot}", source.name));
            imported.clocks.said.iter().for_each(|said| listener.says(&format!("{whose}: {said}")));
        }
    }
    let mut worlds: BTreeMap<&str, Ready> = BTreeMap::new();
    for (source, _, Imported { dataset, .. }) in &datasets {
        if !worlds.contains_key(source.nominal.as_str()) {
            let asked = diagnose::Asked {
                nominal: Some(PathBuf::from(&source.nominal)),
                libraries: libraries.to_owned(),
                calibrate: Some(0),
                real: true,
                ..diagnose::Asked::default()
            };
            worlds.insert(&source.nominal, Ready::new(&dataset.log, &asked, listener)?);
        }
    }
    let prepared: Vec<Prepared<'_>> = datasets
        .into_iter()
        .map(|(source, robot, Imported { dataset, original, clocks, .. })| {
            let ready = &worlds[source.nominal.as_str()];
            let hash = blake3::hash(format!("{:?}\n{:?}", dataset.log, dataset.truth).as_bytes()).to_hex();
            Prepared { source, robot, dataset, original, clocks, ready, hash: hash.to_string() }
        })
        .collect();
    let logs: Vec<&str> = prepared.iter().map(|it| it.hash.as_str()).collect();
    let parts = [real.hash(), logs.concat(), options.program.clone()];
    let key = blake3::hash(parts.join("\n").as_bytes()).to_hex();
    let store = Store::open(&options.out, key.as_ref()).map_err(crate::verb::plain)?;
    let keeps = Keeps { store, libraries, options, watcher };
    let diagnosed = |parts: &[Part], among: bool, prior: &dyn Fn(&Prepared<'_>) -> Option<Prior>| {
        keeps.diagnosed(&cases(&prepared, parts, prior), among).map_err(crate::verb::plain)
    };
    let halves = diagnosed(&Part::HALVES, false, &|_| Some(Prior::NONE))?;
    let wholes = diagnosed(&[Part::Whole], false, &|it| Some(it.as_far_as(&halves)))?;
    let among = diagnosed(&Part::ALL, true, &|it| beside_make(&wholes, &halves, &it.source.name, it.robot))?;
    let records = in_order(wholes, halves);
    let mut all = Vec::new();
    for source in &real.asked.logs {
        if let Some(learning) = real.asked.learning.as_ref().filter(|_| source.learned_in.is_some()) {
            let ready = &worlds[source.nominal.as_str()];
            let of = prepared.iter().filter(|it| it.source.name == source.name);
            let originals = of.map(|it| (it.robot, it.original.clone())).collect();
            let (path, by) = (place(source, data), (ready, &originals));
            all.extend(lessons(learning, source, &path, &records, by, options, listener)?);
        }
    }
    Ok(Results { real: real.clone(), records, among, lessons: all })
}

/// Where a recording lies.
fn place(source: &Source, data: Option<&Path>) -> PathBuf {
    data.map_or_else(|| manifest::repository().join(&source.source), Path::to_owned)
}

fn robots(source: &Source) -> Vec<Option<u16>> {
    source.robots.as_ref().map_or(vec![None], |robots| robots.iter().copied().map(Some).collect())
}

/// A log, readied.
struct Imported {
    /// As it was.
    given: Log,
    dataset: Dataset,
    original: Original,
    clocks: Clocks,
}

fn imported(source: &Source, robot: Option<u16>, path: &Path) -> Result<Imported, miette::Report> {
    let importers = import::catalogue();
    let importer = importers.iter().find(|it| it.name == source.format);
    // The scenario's check has said so already.
    let importer = importer.ok_or_else(|| miette::miette!("unknown format {}", source.format))?;
    match importer.import(path, robot) {
        Ok(imported) => {
            let Dataset { log: given, truth, provenance } = imported.dataset;
            let told = source.readied().but_for_clocks().of(&given).0.commands.to_vec();
            let original = Original::of(&given, &of_axle(&truth.track), told);
            let (log, clocks) = source.readied().of(&given);
            Ok(Imported { given, dataset: Dataset { log, truth, provenance }, original, clocks })
        }
        Err(error) if path.exists() => Err(miette::miette!("{error}")),
        Err(error) => Err(miette::miette!(help = "if it lies elsewhere: --only NAME --data DIR", "{error}")),
    }
}

/// Has a robot whose own log does not tell its clocks have such as others of its make have, where three and more tell theirs and its log tells
/// when such clocks strike.
fn like_others(source: &Source, datasets: &mut [(&Source, Option<u16>, Imported)]) {
    let of_make = || datasets.iter().filter(|it| it.0.name == source.name).map(|it| &it.2.clocks);
    let told = |period_s: fn(&Clocks) -> Option<f64>| {
        let told_s: Vec<f64> = of_make().filter_map(period_s).collect();
        median(&told_s).filter(|_| told_s.len() >= LEAST)
    };
    let others = OfOthers { picture_s: told(|it| it.picture_period_s), cycle_s: told(|it| it.command_cycle_s) };
    for (_, _, imported) in datasets.iter_mut().filter(|it| it.0.name == source.name) {
        let Clocks { picture_period_s, command_cycle_s, .. } = imported.clocks;
        let lacks_either = [(picture_period_s, others.picture_s), (command_cycle_s, others.cycle_s)];
        if lacks_either.iter().any(|(own, of_others)| own.is_none() && of_others.is_some()) {
            (imported.dataset.log, imported.clocks) = source.readied().of_make(&imported.given, others);
        }
    }
}

/// A part of a log, and what is known beforehand.
type Case<'a> = (&'a Prepared<'a>, Part, Prior);

/// Parts of all logs of which something is known beforehand, be it that there is nothing.
fn cases<'a>(
    prepared: &'a [Prepared<'a>],
    parts: &[Part],
    prior: &dyn Fn(&Prepared<'_>) -> Option<Prior>,
) -> Vec<Case<'a>> {
    let known = prepared.iter().filter_map(|it| Some((it, prior(it)?)));
    known.flat_map(|(it, prior)| parts.iter().map(move |part| (it, *part, prior.clone()))).collect()
}

/// Where records are kept, and who watches them being made.
struct Keeps<'a> {
    store: Store,
    libraries: &'a Path,
    options: &'a Options,
    watcher: &'a dyn Watcher,
}

impl Keeps<'_> {
    /// Diagnoses what is not done yet.
    fn diagnosed(&self, cases: &[Case<'_>], among: bool) -> Result<Vec<Record>, CannotSweep> {
        let program = &self.options.program;
        let case = |(it, part, prior): &Case<'_>| {
            (name(&it.source.name, it.robot, *part, among), it.of(*part, prior, program))
        };
        let kept = Kept::open(&self.store, self.libraries, cases.iter().map(case).collect())?;
        let found = kept.find::<Record>()?;
        if !cases.is_empty() {
            self.watcher.begins(&found.count, 1);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.options.jobs.unwrap_or(0)).build()?;
        pool.install(|| {
            let work: Vec<_> = cases.iter().zip(found.records).enumerate().collect();
            work.into_par_iter()
                .with_max_len(1)
                .map(|(i, ((prepared, part, prior), done))| {
                    if let Some(done) = done {
                        return Ok(done);
                    }
                    let record = Record { among, ..prepared.record(*part, prior) };
                    kept.keep(i, &record)?;
                    let case = trial::Case { seed: i as u64, robot: prepared.robot, ..trial::Case::default() };
                    self.watcher.finished(&case, &record.timing);
                    Ok(record)
                })
                .collect()
        })
    }
}

impl Prepared<'_> {
    /// What is known of the whole log once halves of its recording's logs are diagnosed: how far it is to be believed. A car's diagnosis
    /// asks that of seconds.
    fn as_far_as(&self, halves: &[Record]) -> Prior {
        let is_car = self.ready.held.simulation.robot == Robot::Car;
        if is_car { Prior::NONE } else { as_halves_differ(halves, &self.source.name) }
    }

    /// All that a diagnosis of a part hangs on.
    fn of(&self, part: Part, prior: &Prior, program: &str) -> String {
        let Self { source, robot, clocks, ready, hash, .. } = self;
        let asked = (&source.name, &source.nominal, &ready.held.text, source.search(), robot, part, prior);
        format!("{asked:?}\n{clocks:?}\n{hash}\n{program}")
    }

    fn record(&self, part: Part, prior: &Prior) -> Record {
        let began = Instant::now();
        let log = part.of(&self.dataset.log);
        let scans = log.firings.is_some();
        let answer = catch_unwind(AssertUnwindSafe(|| {
            let limited = of_real(&log).map_err(|error| error.to_string())?;
            self.ready.diagnose_real(&limited.log, prior, self.source.search()).map_err(|error| error.to_string())
        }));
        let (found, error) = match answer {
            Ok(Ok(found)) => (Some(found), String::new()),
            Ok(Err(error)) => (None, error),
            Err(panic) => (None, panic_message(&*panic)),
        };
        let took_s = began.elapsed().as_secs_f64();
        let named: Vec<&str> = found
            .iter()
            .filter_map(|it| it.diagnosis.said())
            .flat_map(|it| it.effects.iter().map(String::as_str))
            .collect();
        // Truth comes in only now.
        let (captured, capture_errors, checked) = if scans {
            let lasers = found.as_ref().map_or(&[][..], |found| &found.lasers);
            let on = scanner::on(part).of(&self.dataset.log);
            (Capture::default(), BTreeMap::new(), scanner::checked(&on, lasers, &self.dataset.truth.track))
        } else {
            let seen = self.seen(log);
            let shown = |seen: &Dataset| {
                let mut captured = self.captured(seen);
                captured.suit(&named);
                captured
            };
            (shown(&seen), errors(&seen, |part| shown(part).values), None)
        };
        let Clocks { picture_period_s, command_cycle_s, .. } = self.clocks;
        Record {
            log: self.source.name.clone(),
            robot: self.robot,
            part,
            among: false,
            diagnosis: found.map(|Found { diagnosis, .. }| Diagnosis {
                picture_period_s,
                command_cycle_s,
                ..diagnosis
            }),
            capture: captured.values,
            capture_errors,
            shares: captured.shares.into_iter().map(|(name, share)| (name.to_owned(), share)).collect(),
            checked,
            error,
            timing: Timing { log_s: 0.0, trials_s: vec![took_s] },
        }
    }

    /// A part of the log, and the truth of that.
    fn seen(&self, log: Log) -> Dataset {
        let (first_s, last_s) = log.span_s().unwrap_or_default();
        let mut seen = Dataset { log, ..self.dataset.clone() };
        seen.truth.track = seen.truth.track.window(&(first_s..last_s));
        seen
    }

    /// What motion capture shows of a log.
    fn captured(&self, seen: &Dataset) -> Capture {
        if let Some(car) = self.ready.held.simulation.car() {
            return of_car(seen, car);
        }
        let own_lag_s = match &self.ready.held.simulation.drive {
            Policy::Roam(roams) => roams.create.wheels.lag_s,
            _ => 0.0,
        };
        capture(seen, &self.original.told, own_lag_s)
    }
}
