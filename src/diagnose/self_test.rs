//! `--self-test`: effects planted in the nominal world, and how often they are named and covered.

use std::fmt::Write as _;
use std::sync::Mutex;

use asami_dataset::{Log, Seed};
use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::Verdict;
use asami_gap::weigh::groups::SPLIT_NATS;
use rayon::prelude::*;

use super::Ready;
use super::progress::Listener;
use crate::blind::answer::{NONE, UNKNOWN};
use crate::blind::draw::Case;
use crate::blind::{Mix, Planting};
use crate::scenario::Simulation;
use crate::simulate::CannotSimulate;

/// No case that is scored or calibrated on is ever drawn by this salt.
const SALT: &str = "asami self-test 1";

/// What became of the cases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Cases without an effect, and how many of them were given none.
    pub none: [usize; 2],
    /// Cases with one, and how many were named by it or by its group.
    pub one: [usize; 2],
    /// Cases with two, and how many were named by both.
    pub two: [usize; 2],
    /// Cases whose cause is in the 90 % set, of all.
    pub in_set: [usize; 2],
    /// Sizes within their 90 % interval, of those of effects that were named.
    pub covered: [usize; 2],
    /// Confident names, above 0.9, and how many of them were wrong.
    pub confident: [usize; 2],
    /// Ties for which another course was advised, and how many of them a log of it split.
    pub advised: [usize; 2],
    /// The same ties, and how many of them as much of the same commands split.
    pub repeated: [usize; 2],
    /// Cases whose logs showed nothing at all.
    pub blind: usize,
}

/// Plants so many cases of this length and diagnoses each.
///
/// # Errors
/// If a case cannot be simulated.
pub fn self_test(
    ready: &Ready,
    length_s: f64,
    cases: usize,
    listener: &dyn Listener,
) -> Result<Counts, CannotSimulate> {
    let nominal = Simulation { duration_s: length_s, ..(*ready.held.simulation).clone() };
    let planting = Planting { nominal, salt: SALT.to_owned(), mix: Mix::default(), places: Vec::new() };
    ready.courses.play_ahead();
    listener.begins("self-test", 0, cases);
    let counts = Mutex::new(Counts::default());
    (0..cases).into_par_iter().with_max_len(1).try_for_each(|i| {
        let case = planting.case(1 + i);
        let log = planting.simulate(&case, &ready.held.name)?.log;
        let diagnosis = ready.diagnose(&log);
        let split = match &diagnosis {
            Ok(diagnosis) => further(ready, &planting, &case, &log, diagnosis)?,
            Err(_) => None,
        };
        if let Ok(mut counts) = counts.lock() {
            match diagnosis {
                Ok(diagnosis) => counts.add(&truth(&case, &ready.without), &case, &diagnosis),
                // A robot that saw nothing says nothing.
                Err(_) => counts.blind += 1,
            }
            if let Some([advised, repeated]) = split {
                tally(&mut counts.advised, advised);
                tally(&mut counts.repeated, repeated);
            }
        }
        listener.steps();
        Ok::<(), CannotSimulate>(())
    })?;
    Ok(counts.into_inner().unwrap_or_default())
}

/// Of a tie about one effect for which another course is advised: whether a log of that course, and one more of the same
/// commands, splits it together with the first.
fn further(
    ready: &Ready,
    planting: &Planting,
    case: &Case,
    log: &Log,
    diagnosis: &Diagnosis,
) -> Result<Option<[bool; 2]>, CannotSimulate> {
    let driven = diagnosis.next_keys.as_deref().and_then(|keys| ready.courses.driven(keys));
    let (Some(driven), [only]) = (driven, case.planted.as_slice()) else { return Ok(None) };
    let tied = |name: &str| diagnosis.set90.iter().any(|cause| cause.len() == 1 && cause[0] == name);
    let (name, Ok(first)) = (only.variant.about.name, ready.evidence(log)) else { return Ok(None) };
    if !tied(name) {
        return Ok(None);
    }
    let again = Case { seed: Seed(case.seed.0 ^ 1), ..case.clone() };
    let duration_s = diagnosis.next_length_s.unwrap_or(planting.nominal.duration_s);
    let mut split = [false; 2];
    for (split, nominal) in split.iter_mut().zip([driven, planting.nominal.clone()]) {
        let planting = Planting { nominal: Simulation { duration_s, ..nominal }, ..planting.clone() };
        let log = planting.simulate(&again, &ready.held.name)?.log;
        let Ok(second) = ready.evidence(&log) else { continue };
        let both = |name: &str| first.get(name).unwrap_or(&0.0) + second.get(name).unwrap_or(&0.0);
        let others = first.keys().filter(|cause| *cause != name && tied(cause));
        *split = others.map(|other| both(name) - both(other)).all(|nats| nats > SPLIT_NATS);
    }
    Ok(Some(split))
}

/// The right answer: the planted effects' names in alphabetical order, *none*, or *unknown* where one of them is out of the
/// catalogue.
fn truth(case: &Case, without: &[String]) -> Vec<String> {
    let mut truth: Vec<String> = case.planted.iter().map(|it| it.variant.about.name.to_owned()).collect();
    if truth.is_empty() {
        truth.push(NONE.to_owned());
    } else if truth.iter().any(|name| without.contains(name)) {
        truth = vec![UNKNOWN.to_owned()];
    }
    truth.sort();
    truth
}

impl Counts {
    fn add(&mut self, expected: &[String], case: &Case, diagnosis: &Diagnosis) {
        let top = diagnosis.which.first();
        let named = top.map(|cause| {
            let mut named = cause.effects.clone();
            named.sort();
            named
        });
        let alike = |found: &[String]| {
            let group = |group: &Vec<String>| {
                let is_in = |names: &[String]| names.iter().all(|name| group.contains(name));
                found.len() == expected.len() && is_in(found) && is_in(expected)
            };
            found == expected || diagnosis.cannot_tell_apart.iter().any(group)
        };
        let right = match case.planted.len() {
            0 => diagnosis.verdict == Verdict::None,
            _ => named.as_deref().is_some_and(alike),
        };
        let of = match case.planted.len() {
            0 => &mut self.none,
            1 => &mut self.one,
            _ => &mut self.two,
        };
        tally(of, right);
        let in_set = diagnosis.set90.iter().any(|it| {
            let mut it = it.clone();
            it.sort();
            alike(&it)
        });
        tally(&mut self.in_set, in_set);
        let sure = top.is_some_and(|cause| cause.probability > 0.9) && diagnosis.verdict == Verdict::Named;
        if sure {
            tally(&mut self.confident, !right);
        }
        let Some(top) = top.filter(|_| right) else { return };
        for planted in &case.planted {
            let (name, null) = planted.variant.sized();
            let value = null + planted.variant.sign * planted.size;
            if let Some(estimate) = top.parameters.get(&format!("{}.{name}", planted.variant.about.name)) {
                let [low, high] = estimate.interval;
                tally(&mut self.covered, low <= value && value <= high);
            }
        }
    }

    /// In a few lines.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        let mut say = |what: &str, [n, right]: [usize; 2], then: &str| {
            if n > 0 {
                let _ = writeln!(out, "self-test  {what}: {right} of {n} {then}");
            }
        };
        say("no effect planted", self.none, "called none");
        say("one effect planted", self.one, "named first, or one that this log cannot tell from it");
        say("two effects planted", self.two, "both named first");
        say("all cases", self.in_set, "in the 90 % set");
        say("effects named rightly", self.covered, "sizes within the 90 % interval");
        say("names given with more than 0.9", self.confident, "wrong");
        say("ties with another course advised", self.advised, "split by as long a log of that course");
        say("the same ties", self.repeated, "split by as much of the same commands");
        if self.blind > 0 {
            let _ = writeln!(out, "self-test  {} more showed nothing at all", self.blind);
        }
        out
    }
}

fn tally([n, right]: &mut [usize; 2], is_right: bool) {
    *n += 1;
    *right += usize::from(is_right);
}
