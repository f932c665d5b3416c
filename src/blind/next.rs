//! What came of the advice on what to record next: where causes are tied, the advised log is recorded in the true world, and
//! beside it another with the old commands, as long. Each is judged by what is known of the nominal world so driven: whoever
//! records a log with other commands has a scenario with other commands, and a library of its own.

use std::collections::BTreeSet;

use asami_gap::{Diagnosis, Judges};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::answer::{Answer, Key, NONE, UNKNOWN};
use super::draw::{Case, Planting};
use super::referee::{speaks_for, stands_for};
use super::walk::{CannotRun, Contest, Record};
use crate::scenario::Simulation;
use crate::sweep::CannotSweep;

/// A log that speaks for the truth by so many nats has split the tie: odds of 20 to 1.
const SPLIT_NATS: f64 = 3.0;

/// What a diagnoser asks for of a tie that holds the truth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Advised {
    /// The keys that make the robot drive so.
    pub keys: String,
    /// For how long, in seconds; as long as the log where it does not say.
    pub length_s: Option<f64>,
    /// By how many nats the two would part.
    pub promised_nats: Option<f64>,
    /// The truth, and what it is tied with.
    pub tied: [String; 2],
}

impl Advised {
    /// What a diagnosis asks for; `None` where it asks for nothing, or the truth is not one of the two most probable effects.
    #[must_use]
    pub fn of(diagnosis: &Diagnosis, key: &Key<'_>) -> Option<Self> {
        let promised_nats = diagnosis.next_nats.map(|[_, promised]| promised);
        let (keys, length_s) = (diagnosis.next_keys.clone()?, diagnosis.next_length_s);
        Some(Self { keys, length_s, promised_nats, tied: tied(diagnosis, key)?.map(str::to_owned) })
    }
}

/// A nominal world driven otherwise.
pub struct Driven<'a> {
    /// The world.
    pub world: Simulation,
    /// The likelihood of its logs.
    pub judges: Box<dyn Judges + 'a>,
}

/// By how many nats another log speaks for the truth over what it was tied with, by the referee's likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Next {
    /// The log that was driven as advised.
    pub advised_nats: f64,
    /// The log with the old commands.
    pub again_nats: f64,
    /// What was expected of the advised one.
    #[serde(default)]
    pub promised_nats: Option<f64>,
}

impl Next {
    /// Whether the advised log splits the tie.
    #[must_use]
    pub fn splits(&self) -> bool {
        self.advised_nats >= SPLIT_NATS
    }

    /// Whether the other one does.
    #[must_use]
    pub fn again_splits(&self) -> bool {
        self.again_nats >= SPLIT_NATS
    }
}

/// Records what was advised in all these cases and is not recorded yet, and asks it; `keep` is given each case that is done. Ways
/// to drive are taken one after the other, cases with the same one in parallel.
///
/// # Errors
/// [`CannotRun`] where the world so driven cannot be played, or a file not be written.
pub(super) fn follow(
    records: &mut [Record],
    contest: &dyn Contest,
    planting: &Planting,
    keep: &(dyn Fn(&Record) -> Result<(), CannotSweep> + Sync),
) -> Result<(), CannotRun> {
    let waiting = records.iter().flat_map(|record| &record.answers).filter_map(waits_for);
    let ways: BTreeSet<String> = waiting.map(|advised| advised.keys.clone()).collect();
    for keys in &ways {
        let Some(driven) = contest.driven(keys)? else { continue };
        let waits = |answer: &Answer| waits_for(answer).is_some_and(|advised| advised.keys == *keys);
        let waiting = records.par_iter_mut().with_max_len(1).filter(|record| record.answers.iter().any(waits));
        waiting.try_for_each(|record| {
            let case = planting.case(record.number);
            for answer in record.answers.iter_mut().filter(|answer| waits(answer)) {
                answer.next = waits_for(answer).and_then(|it| recorded(it, &driven, contest, planting, &case));
            }
            keep(record)
        })?;
    }
    Ok(())
}

/// What is advised, until it is recorded.
fn waits_for(answer: &Answer) -> Option<&Advised> {
    answer.advised.as_ref().filter(|_| answer.next.is_none())
}

/// Both logs of a case, and what they say; `None` where one of them shows nothing.
fn recorded(
    advised: &Advised,
    driven: &Driven<'_>,
    contest: &dyn Contest,
    planting: &Planting,
    case: &Case,
) -> Option<Next> {
    let [truth, rival] = &advised.tied;
    let seed = planting.seed_of_next(case.number);
    let nats = |world: &Simulation, judges: &dyn Judges| {
        let duration_s = advised.length_s.unwrap_or(world.duration_s);
        let recording = Planting { nominal: Simulation { duration_s, ..world.clone() }, ..planting.clone() };
        let log = recording.simulate(&Case { seed, ..case.clone() }, "").ok()?.log;
        let likelihood = judges.of(&log).ok()?;
        Some(speaks_for(&*likelihood, [truth, rival], contest.variants()))
    };
    Some(Next {
        advised_nats: nats(&driven.world, &*driven.judges)?,
        again_nats: nats(&planting.nominal, contest.judges())?,
        promised_nats: advised.promised_nats,
    })
}

/// Of the two most probable effects the one that is the truth, and the other.
fn tied<'a>(diagnosis: &'a Diagnosis, key: &Key<'_>) -> Option<[&'a str; 2]> {
    let [truth] = &key.reference.effects[..] else { return None };
    let singles = diagnosis.which.iter().filter_map(|cause| match &cause.effects[..] {
        [only] if only != NONE && only != UNKNOWN => Some(only),
        _ => None,
    });
    let first: Vec<&String> = singles.take(2).collect();
    let &[one, two] = first.as_slice() else { return None };
    let is_truth = |name: &String| stands_for(std::slice::from_ref(name), &[truth]);
    match (is_truth(one), is_truth(two)) {
        (true, false) => Some([one, two]),
        (false, true) => Some([two, one]),
        _ => None,
    }
}
