//! From evidence to probabilities that mean what they say: learned from planted cases.
//!
//! Of every planted case the evidence of each cause is known, and the truth. A cause's probability is
//! `P(g) ~ prior_g exp(beta_g + tau(g) log Z_g)`, with evidence counting for the less, the more of it there
//! is: a library's error grows with what it describes. What a second effect says beyond the first, and a flexible block
//! beyond the leading cause, is small, but a library's error in the first is taken for it: a share of what the first explains,
//! for some effects more than for others, is taken off. A second effect that does not show is never ruled
//! out, so that what shows alone is at most as probable as planted cases have it. The parameters are those of least
//! penalised log-loss, and the set is found by leaving folds out (Vovk 2015).

mod fit;
mod less;

use std::collections::BTreeMap;

use asami_math::elementary::{exp, ln};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::weigh::causes::{Evidence, NONE, PRIOR_OF_A_SECOND, UNKNOWN, is_single, is_unknown, leader};
use crate::weigh::practice::Case;
pub use fit::log_loss;
use fit::{Weights, fit};
pub use less::{Left, less};

/// The class of all causes of several effects.
const SEVERAL: &str = "+";
/// The same, where one of the effects does not show beside the other.
const HIDDEN: &str = "+?";

/// How evidence becomes probability.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Weight of the evidence.
    tau: f64,
    /// How fast that weight falls with the greatest evidence, per nat.
    fade: f64,
    /// Weight of what flexible blocks explain beyond the leading cause.
    tau_beyond: f64,
    /// The share of an effect's evidence that the library's error in it makes pass for something else besides.
    error: f64,
    /// The logarithm of how many times that is so much, by effect.
    own_error: BTreeMap<String, f64>,
    /// What is added for each cause; of a flexible block to its evidence, for what its freedom costs.
    beta: BTreeMap<String, f64>,
    /// The least probability that a cause in the 90 % set has, by stratum.
    thresholds: [f64; STRATA],
    /// How far truths were exceeded by flexible blocks, increasing.
    absorbed_nats: Vec<f64>,
    /// By how much sizes' intervals are too narrow.
    stretch: f64,
    /// How many planted cases there were.
    pub cases: usize,
}

/// Prior probability of no cause; the causes in the list share what this and [`PRIOR_UNKNOWN`] leave.
const PRIOR_NONE: f64 = 0.3;
/// What is left to causes in nobody's list, and the prior odds of each flexible block beside the cause that it is put on.
const PRIOR_UNKNOWN: f64 = 0.1;
/// Probability that the evidence misleads altogether, as a library that is wrong somewhere does; without it a few such
/// cases would have all evidence distrusted. Its order still says something: the `r`-th most probable cause is then the true
/// one as `1 / (r (r + 1))`.
const SLIP: f64 = 0.02;
/// Folds of the cross-validation.
const FOLDS: usize = 5;
/// Strata of the 90 % set: below, between and above these nats of greatest evidence; and, of what is above both, where the most
/// probable cause is as far ahead. In every one so many truths are in the set: what is clear needs no wide set because other logs
/// do (Mondrian conformal prediction: Vovk, Gammerman and Shafer 2005, section 4.5).
const STRATA_NATS: [f64; 2] = [3.0, 10.0];
const STRATA: usize = 4;
/// Of a stratum's truths this share is not in the set. What does not show of two effects is in none either, and takes the rest of
/// the tenth, or more.
const MISSED: f64 = 1.0 / 12.0;

impl Default for Calibration {
    /// The evidence as it is.
    fn default() -> Self {
        let (beta, own_error, absorbed_nats) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        Self {
            tau: 1.0,
            fade: 0.0,
            tau_beyond: 1.0,
            error: 0.0,
            own_error,
            beta,
            thresholds: [0.05; STRATA],
            absorbed_nats,
            stretch: 1.0,
            cases: 0,
        }
    }
}

impl Calibration {
    /// The calibration of these cases.
    #[must_use]
    pub fn learn(cases: &[Case]) -> Self {
        Self::of(&less(cases, &[]))
    }

    /// The calibration of cases of which effects were taken out of the list; without any, the evidence as it is.
    #[must_use]
    pub fn of(cases: &[Left]) -> Self {
        if cases.is_empty() {
            return Self::default();
        }
        let all: Vec<&Left> = cases.iter().collect();
        let of = |fold: usize, held: bool| {
            cases.iter().enumerate().filter(move |(i, _)| (i % FOLDS == fold) == held).map(|(_, case)| case)
        };
        // The first learns from all of them.
        let learned: Vec<Self> = (0..=FOLDS)
            .into_par_iter()
            .map(|k| fit(&k.checked_sub(1).map_or_else(|| all.clone(), |fold| of(fold, false).collect())))
            .collect();
        let mut scores: [Vec<(f64, f64)>; STRATA] = Default::default();
        let weights = Weights::of(&all);
        for (fold, rest) in learned.iter().skip(1).enumerate() {
            for left in of(fold, true) {
                let case = &left.case;
                let shown = case.shown.as_ref().unwrap_or(&case.truth);
                let truth = if is_unknown(shown) { UNKNOWN } else { shown };
                let probabilities = rest.probabilities(&case.evidence);
                let probability = probabilities.get(truth).copied().unwrap_or(0.0);
                scores[rest.stratum(&case.evidence, &probabilities)].push((probability, weights.weight(left)));
            }
        }
        let mut calibration = learned.into_iter().next().unwrap_or_default();
        for (threshold, scores) in calibration.thresholds.iter_mut().zip(&mut scores) {
            scores.sort_by(|a, b| a.0.total_cmp(&b.0));
            *threshold = least_in_set(scores).unwrap_or(0.05);
        }
        calibration.absorbed_nats = cases.iter().filter_map(|left| left.case.absorbed_nats).collect();
        calibration.absorbed_nats.sort_by(f64::total_cmp);
        let mut off_by: Vec<f64> = cases.iter().filter_map(|left| left.case.off_by).collect();
        off_by.sort_by(f64::total_cmp);
        let nine_in_ten = (off_by.len() * 9).div_ceil(10).checked_sub(1).and_then(|i| off_by.get(i));
        // A handful of sizes says nothing of their scatter.
        calibration.stretch = nine_in_ten.filter(|_| off_by.len() >= 20).map_or(1.0, |it| it.max(1.0));
        calibration.cases = cases.len();
        calibration
    }

    /// A 90 % interval of a size about the one found, as wide as planted sizes show it to be.
    #[must_use]
    pub fn interval(&self, found: f64, [low, high]: [f64; 2]) -> [f64; 2] {
        [(found - self.stretch * (found - low).max(0.0)).max(0.0), found + self.stretch * (high - found).max(0.0)]
    }

    /// Probabilities of all causes, *none* and [`UNKNOWN`] among them.
    #[must_use]
    pub fn probabilities(&self, evidence: &Evidence) -> BTreeMap<String, f64> {
        let mut probabilities = BTreeMap::new();
        for (cause, p) in self.by_block(evidence) {
            let cause = if is_unknown(cause) { UNKNOWN } else { cause };
            *probabilities.entry(cause.to_owned()).or_insert(0.0) += p;
        }
        probabilities
    }

    /// The flexible block in which a cause in nobody's list would lie.
    #[must_use]
    pub fn block(&self, evidence: &Evidence) -> Option<String> {
        let unknown = self.by_block(evidence).into_iter().filter(|(cause, _)| is_unknown(cause));
        let best = unknown.reduce(|a, b| if b.1 > a.1 { b } else { a });
        best.and_then(|(cause, _)| cause.split_once('/').map(|(_, block)| block.to_owned()))
    }

    /// Probabilities with each flexible block of the unknown by itself.
    fn by_block<'a>(&self, evidence: &'a Evidence) -> BTreeMap<&'a str, f64> {
        self.sharp_and_slipped(evidence).into_iter().map(|(cause, [sharp, slipped])| (cause, sharp + slipped)).collect()
    }

    /// What of these is by the evidence's size, and what by its order alone.
    fn sharp_and_slipped<'a>(&self, evidence: &'a Evidence) -> BTreeMap<&'a str, [f64; 2]> {
        let mut ranked: Vec<(&str, f64)> = softmax(self.scores(evidence)).into_iter().collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        // The sum of 1 / (r (r + 1)) up to n is n / (n + 1).
        let n = ranked.len() as f64;
        let slipped = |r: f64| SLIP * (n + 1.0) / (n * r * (r + 1.0));
        let each =
            ranked.into_iter().zip(1..).map(|((cause, p), r)| (cause, [(1.0 - SLIP) * p, slipped(f64::from(r))]));
        each.collect()
    }

    /// Logarithms of the probabilities, but for a constant. A block is held against the cause that it was put on top of.
    fn scores<'a>(&self, evidence: &'a Evidence) -> Vec<(&'a str, f64)> {
        let weight = self.tau / (1.0 + self.fade * greatest(evidence));
        let singles = evidence.keys().filter(|cause| is_single(cause)).count().max(1) as f64;
        let top = self.top(evidence);
        let named = |cause: &str| {
            let Said { of_top, class, beyond } = self.said(cause, evidence, &top);
            ln(prior(cause, singles)) + self.beta(class) + weight * of_top + self.tau * beyond
        };
        let leader = leader(evidence);
        let (of_leader, leader_nats) = (named(leader), nats(evidence, leader));
        let block = |cause: &str| {
            let beyond = nats(evidence, cause) - leader_nats + self.beta(cause);
            of_leader + ln(PRIOR_UNKNOWN) + self.tau_beyond * (beyond - top.error)
        };
        let score = |cause: &'a str| (cause, if is_unknown(cause) { block(cause) } else { named(cause) });
        evidence.keys().map(|cause| score(cause)).chain([score(NONE)]).collect()
    }

    /// The causes of the 90 % set, the most probable first; never empty. Two effects of which the one does not show beside the other
    /// are in none: the one that shows stands for both.
    #[must_use]
    pub fn set90(&self, evidence: &Evidence, probabilities: &BTreeMap<String, f64>) -> Vec<String> {
        let threshold = self.thresholds[self.stratum(evidence, probabilities)];
        let top = self.top(evidence);
        let shows = |cause: &&String| !self.hides(cause, evidence, &top);
        let mut causes: Vec<(&String, f64)> =
            probabilities.iter().filter(|(cause, _)| shows(cause)).map(|(cause, p)| (cause, *p)).collect();
        causes.sort_by(|a, b| b.1.total_cmp(&a.1));
        let in_set = causes.iter().enumerate().filter(|(i, (_, p))| *i == 0 || *p >= threshold);
        in_set.map(|(_, (cause, _))| (*cause).clone()).collect()
    }

    /// Share of planted truths that were exceeded by a flexible block by at least so much; `None` without cases.
    #[must_use]
    pub fn adequacy_p(&self, absorbed_nats: f64) -> Option<f64> {
        let n = self.absorbed_nats.len();
        let below = self.absorbed_nats.partition_point(|it| *it < absorbed_nats);
        (n > 0).then(|| (n - below + 1) as f64 / (n + 1) as f64)
    }

    /// The stratum of what is said of a log.
    fn stratum(&self, evidence: &Evidence, probabilities: &BTreeMap<String, f64>) -> usize {
        let [_, clear] = STRATA_NATS;
        let by_greatest = STRATA_NATS.iter().filter(|nats| greatest(evidence) > **nats).count();
        by_greatest + usize::from(by_greatest == STRATA_NATS.len() && self.ahead(evidence, probabilities) > clear)
    }

    /// By how much the evidence of the most probable cause in the list is ahead of that of all which it is no part of, in nats.
    fn ahead(&self, evidence: &Evidence, probabilities: &BTreeMap<String, f64>) -> f64 {
        let most = self.top(evidence);
        let shows = |cause: &str| !is_unknown(cause) && !self.hides(cause, evidence, &most);
        let shown = probabilities.iter().filter(|(cause, _)| shows(cause));
        let Some((top, _)) = shown.reduce(|a, b| if b.1 > a.1 { b } else { a }) else { return 0.0 };
        let apart = |cause: &str| !is_unknown(cause) && cause != top && !cause.split('+').any(|effect| effect == top);
        let others = evidence.iter().filter(|(cause, _)| apart(cause)).map(|(_, nats)| *nats);
        let best = others.fold(if top == NONE { f64::NEG_INFINITY } else { 0.0 }, f64::max);
        nats(evidence, top) - best
    }

    /// Whether a cause is of several effects of which not all show.
    fn hides(&self, cause: &str, evidence: &Evidence, top: &Top<'_>) -> bool {
        self.said(cause, evidence, top).class == HIDDEN
    }

    fn beta(&self, class: &str) -> f64 {
        self.beta.get(class).copied().unwrap_or(0.0)
    }

    /// The most evident effect alone.
    fn top<'a>(&self, evidence: &'a Evidence) -> Top<'a> {
        let singles = evidence.iter().filter(|(cause, _)| is_single(cause));
        let most = singles.reduce(|a, b| if b.1 > a.1 { b } else { a });
        let (effect, nats) = most.map_or((None, 0.0), |(effect, nats)| (Some(effect.as_str()), nats.max(0.0)));
        let own = effect.and_then(|effect| self.own_error.get(effect)).copied().unwrap_or(0.0);
        Top { effect, nats, error: self.error * exp(own) * nats }
    }

    /// What is said for a cause beside the most evident effect.
    fn said<'a>(&self, cause: &'a str, evidence: &Evidence, top: &Top<'_>) -> Said<'a> {
        let (of_top, beyond) = top.parts(cause, nats(evidence, cause));
        let (class, beyond) = self.beyond(cause, beyond - top.error);
        Said { of_top, class, beyond }
    }

    /// A cause's class, and what is said for it beyond the leading effect. A second effect that hardly shows is about as
    /// probable as one that does not show at all.
    fn beyond<'a>(&self, cause: &'a str, beyond: f64) -> (&'a str, f64) {
        match class(cause) {
            SEVERAL if self.beta(SEVERAL) + self.tau * beyond < self.beta(HIDDEN) => (HIDDEN, 0.0),
            SEVERAL => (SEVERAL, beyond),
            single => (single, 0.0),
        }
    }
}

/// The least of these probabilities, increasing, each with its weight, below which less than [`MISSED`] of the weight lies, one more
/// case of weight 1 counted (of cases that are not as frequent as they are to be expected: Tibshirani et al. 2019).
fn least_in_set(scores: &[(f64, f64)]) -> Option<f64> {
    let most = MISSED * (1.0 + scores.iter().fold(0.0, |sum, (_, weight)| sum + weight));
    let below = scores.iter().scan(0.0, |below, (probability, weight)| {
        *below += weight;
        Some((*probability, *below))
    });
    below.take_while(|(_, below)| *below <= most).last().map(|(probability, _)| probability).or(Some(scores.first()?.0))
}

/// The most evident effect alone.
struct Top<'a> {
    /// Its name, where any is in the list.
    effect: Option<&'a str>,
    /// Its evidence; that of *none*, 0, where there is more for that.
    nats: f64,
    /// What of the evidence for more than it is the library's error in it.
    error: f64,
}

impl Top<'_> {
    /// What is said by it for a cause that has so many nats, and beyond it. For several of which it is none, it says no more than
    /// they have together.
    fn parts(&self, cause: &str, nats: f64) -> (f64, f64) {
        if is_single(cause) || cause == NONE {
            return (nats, 0.0);
        }
        let is_in = cause.split('+').any(|effect| self.effect == Some(effect));
        (if is_in { self.nats } else { nats.clamp(0.0, self.nats) }, nats - self.nats)
    }
}

/// What is said for a cause.
struct Said<'a> {
    /// By the most evident effect.
    of_top: f64,
    /// What it shares an addend with.
    class: &'a str,
    /// Beyond that effect.
    beyond: f64,
}

/// What shares one addend: all causes of several effects do.
fn class(cause: &str) -> &str {
    if cause.contains('+') { SEVERAL } else { cause }
}

fn prior(cause: &str, singles: f64) -> f64 {
    if cause == NONE {
        return PRIOR_NONE;
    }
    // Each further effect costs its odds, shared by all that it could have been.
    let further = cause.matches('+').count() as i32;
    (1.0 - PRIOR_NONE - PRIOR_UNKNOWN) / singles * (PRIOR_OF_A_SECOND / singles).powi(further)
}

/// Evidence of a cause, none of *none*.
fn nats(evidence: &Evidence, cause: &str) -> f64 {
    evidence.get(cause).copied().unwrap_or(0.0).clamp(-1e6, 1e9)
}

fn greatest(evidence: &Evidence) -> f64 {
    evidence.values().copied().fold(0.0, f64::max)
}

fn softmax(scores: Vec<(&str, f64)>) -> BTreeMap<&str, f64> {
    let top = scores.iter().map(|(_, score)| *score).fold(f64::NEG_INFINITY, f64::max);
    let sum = scores.iter().fold(0.0, |sum, (_, score)| sum + exp(score - top));
    scores.into_iter().map(|(cause, score)| (cause, exp(score - top) / sum)).collect()
}

#[cfg(test)]
mod tests;
