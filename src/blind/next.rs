//! What came of the advice on what to record next: where causes are tied, the advised log is recorded in the true world, and
//! beside it another with the old commands, as long.

use asami_gap::Diagnosis;
use serde::{Deserialize, Serialize};

use super::answer::{Key, NONE, UNKNOWN};
use super::draw::{Case, Planting};
use super::referee::{speaks_for, stands_for};
use super::walk::Contest;
use crate::scenario::Simulation;

/// A log that speaks for the truth by so many nats has split the tie: odds of 20 to 1.
const SPLIT_NATS: f64 = 3.0;

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

/// Records both logs and asks them; `None` where nothing was advised, or the truth is not one of the two that were tied.
pub(super) fn follow(
    diagnosis: &Diagnosis,
    key: &Key<'_>,
    contest: &dyn Contest,
    planting: &Planting,
    case: &Case,
) -> Option<Next> {
    let advised = contest.driven(diagnosis.next_keys.as_deref()?)?;
    let [truth, rival] = tied(diagnosis, key)?;
    let seed = planting.seed_of_next(case.number);
    let nats = |nominal: Simulation| {
        let duration_s = diagnosis.next_length_s.unwrap_or(nominal.duration_s);
        let nominal = Simulation { duration_s, ..nominal };
        let driven = Planting { nominal, ..planting.clone() };
        let log = driven.simulate(&Case { seed, ..case.clone() }, "").ok()?.log;
        let likelihood = contest.judges().of(&log).ok()?;
        Some(speaks_for(&*likelihood, [truth, rival], contest.variants()))
    };
    let promised_nats = diagnosis.next_nats.map(|[_, promised]| promised);
    Some(Next { advised_nats: nats(advised)?, again_nats: nats(planting.nominal.clone())?, promised_nats })
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
