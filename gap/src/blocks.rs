//! *Unknown*: five flexible blocks into which an effect that is in nobody's list would fall.
//!
//! A block is a handful of directions in which a response may change, each with a Gaussian prior. Its
//! evidence is Laplace's; the curvature is that of the scores of single frames, so that means and noise are treated alike.
//!
//! Few effects take all of a block's directions, and each that is free costs nats: as likely as all of them are one, two or three
//! alone, whichever (subsets by forward selection).

use asami_math::elementary::{exp, ln};
use rayon::prelude::*;

use crate::directions::Direction;
use crate::judge::Judge;
use crate::newton::{Curvature, climb};

/// The blocks' names, in the order in which they are tried; the last is all of them together.
pub const BLOCKS: [&str; 6] = ["static_motion", "timing", "drift", "sensor", "noise", "all"];

/// A block fitted to a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// One of [`BLOCKS`].
    pub block: &'static str,
    /// Logarithm of its evidence over that of the response that it was added to.
    pub evidence_nats: f64,
    /// The response with it.
    pub numbers: Vec<f64>,
}

/// Subsets of a block have so many directions and fewer.
const SUBSET: usize = 3;
/// A subset is fitted where its evidence comes so near to that of the best, in nats.
const NEAR: f64 = 5.0;
/// Steps of Newton's method for a block that a log speaks for; the others get one.
const ITERATIONS: usize = 4;
/// Evidence from which on a block is worth more than one step, in nats.
const SPEAKS: f64 = 2.0;
/// Directions are in units of their prior standard deviations.
const PRIOR_PRECISION: f64 = 1.0;
/// Differences are taken over this share of a prior standard deviation.
const DIFFERENCE: f64 = 0.05;

/// Fits every block on top of `numbers`, to the steps for which `of` says so.
#[must_use]
pub fn fit(judge: &dyn Judge, numbers: &[f64], of: &dyn Fn(usize) -> bool) -> Vec<Fitted> {
    let each: Vec<Vec<Direction>> = BLOCKS[..5].iter().map(|block| judge.directions(numbers, block)).collect();
    let all = each.concat();
    let on = On { judges: &[judge], numbers, directions: &all, of };
    let mut start = 0;
    let mut members: Vec<Vec<usize>> = Vec::new();
    for directions in &each {
        members.push((start..start + directions.len()).collect());
        start += directions.len();
    }
    members.push((0..all.len()).collect());
    on.scored(|_, here, scores| {
        BLOCKS.into_iter().zip(members).map(|(block, of)| on.whole_or_part(block, &of, here, scores)).collect()
    })
}

/// The response from `numbers` that makes several logs of one world most likely, as far as one block may change it, or a part of
/// it, in those of its directions that change `free` numbers alone; `numbers` themselves where nothing is gained that its freedom
/// is worth.
#[must_use]
pub fn polished(judges: &[&dyn Judge], numbers: &[f64], block: &'static str, free: &dyn Fn(usize) -> bool) -> Vec<f64> {
    let mut directions = judges.first().map_or_else(Vec::new, |judge| judge.directions(numbers, block));
    directions.retain(|direction| direction.iter().enumerate().all(|(i, change)| *change == 0.0 || free(i)));
    let on = On { judges, numbers, directions: &directions, of: &|_| true };
    let fitted = on.scored(|all, here, scores| on.whole_or_part(block, all, here, scores));
    if fitted.evidence_nats > 0.0 { fitted.numbers } else { numbers.to_vec() }
}

/// The same of a whole block, whatever its freedom is worth.
#[must_use]
pub fn likeliest(judges: &[&dyn Judge], numbers: &[f64], block: &'static str) -> Vec<f64> {
    let directions = judges.first().map_or_else(Vec::new, |judge| judge.directions(numbers, block));
    let on = On { judges, numbers, directions: &directions, of: &|_| true };
    on.scored(|all, here, scores| on.block(block, all, here, scores)).numbers
}

/// A response, the ways in which it may change, and the steps that count.
struct On<'a> {
    judges: &'a [&'a dyn Judge],
    numbers: &'a [f64],
    directions: &'a [Direction],
    of: &'a dyn Fn(usize) -> bool,
}

impl On<'_> {
    fn at(&self, b: &[f64]) -> Vec<f64> {
        let mut numbers = self.numbers.to_vec();
        for (b, direction) in b.iter().zip(self.directions).filter(|(b, _)| **b != 0.0) {
            for (number, change) in numbers.iter_mut().zip(direction) {
                *number += b * change;
            }
        }
        numbers
    }

    /// Log-likelihoods of the logs' steps that count, one log after another; 0 of the others.
    fn likely(&self, b: &[f64]) -> Vec<f64> {
        let numbers = self.at(b);
        let all: Vec<Vec<f64>> = self.judges.par_iter().map(|judge| judge.terms(&numbers)).collect();
        all.concat().into_iter().enumerate().map(|(i, it)| if (self.of)(i) { it } else { 0.0 }).collect()
    }

    /// What comes of all directions, with the log-likelihoods and scores where none is taken.
    fn scored<T>(&self, fit: impl FnOnce(&[usize], &[f64], &[Vec<f64>]) -> T) -> T {
        let none = vec![0.0; self.directions.len()];
        let here = self.likely(&none);
        let scores: Vec<Vec<f64>> = (0..none.len()).map(|i| self.score(&none, &here, i)).collect();
        fit(&(0..none.len()).collect::<Vec<_>>(), &here, &scores)
    }

    /// Derivatives of the steps' log-likelihoods along a direction.
    fn score(&self, b: &[f64], here: &[f64], direction: usize) -> Vec<f64> {
        let mut beside = b.to_vec();
        beside[direction] += DIFFERENCE;
        self.likely(&beside).iter().zip(here).map(|(there, here)| (there - here) / DIFFERENCE).collect()
    }

    /// Fits a block as a whole and its best subsets; of all, the mixture's evidence, and the response of the most evident.
    fn whole_or_part(&self, block: &'static str, of: &[usize], at_zero: &[f64], scores: &[Vec<f64>]) -> Fitted {
        let mut best = self.block(block, of, at_zero, scores);
        let mut evidences = vec![best.evidence_nats];
        let mut chosen: Vec<usize> = Vec::new();
        let mut ln_subsets = 0.0;
        for k in 0..SUBSET.min(of.len().saturating_sub(1)) {
            let left = of.iter().filter(|i| !chosen.contains(i));
            let with = |i: &usize| [&chosen[..], &[*i]].concat();
            let tried = left.map(|i| (linear_evidence(&with(i), scores), *i));
            let Some((evidence, next)) = tried.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            chosen.push(next);
            ln_subsets += ln((of.len() - k) as f64 / (k + 1) as f64);
            let mut evidence_nats = evidence - ln_subsets;
            if evidence_nats >= f64::max(SPEAKS, best.evidence_nats - NEAR) {
                let fitted = self.block(block, &chosen, at_zero, scores);
                evidence_nats = fitted.evidence_nats - ln_subsets;
                if evidence_nats > best.evidence_nats {
                    best = Fitted { evidence_nats, ..fitted };
                }
            }
            evidences.push(evidence_nats);
        }
        let most = evidences.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean = evidences.iter().map(|it| exp(it - most)).sum::<f64>() / evidences.len() as f64;
        Fitted { evidence_nats: if most.is_finite() { most + ln(mean) } else { most }, ..best }
    }

    /// Fits the block of some of the directions by Newton's method.
    fn block(&self, block: &'static str, of: &[usize], at_zero: &[f64], scores: &[Vec<f64>]) -> Fitted {
        let mut b = vec![0.0; self.directions.len()];
        let mut terms = at_zero.to_vec();
        let mut of_block: Vec<Vec<f64>> = of.iter().map(|i| scores[*i].clone()).collect();
        let mut evidence_nats = f64::NEG_INFINITY;
        for iteration in 0..ITERATIONS {
            if iteration > 0 {
                of_block = of.iter().map(|i| self.score(&b, &terms, *i)).collect();
            }
            let Some(curvature) = Curvature::new(&of_block, PRIOR_PRECISION) else { break };
            let slope: Vec<f64> = of_block.iter().zip(of).map(|(score, i)| sum(score) - b[*i]).collect();
            let step = curvature.step(&slope);
            let objective = |terms: &[f64], b: &[f64]| sum(terms) - 0.5 * b.iter().fold(0.0, |sum, b| sum + b * b);
            let here = objective(&terms, &b);
            // Logarithms of noise are far from quadratic: longer steps may help.
            let better = climb(here, &[2.0, 4.0], |share| {
                let mut there = b.clone();
                for (i, step) in of.iter().zip(&step) {
                    there[*i] += share * step;
                }
                let terms = self.likely(&there);
                (objective(&terms, &there), (there, terms))
            });
            let moved = better.is_some();
            if let Some((_, (there, of_there))) = better {
                (b, terms) = (there, of_there);
            }
            let found = objective(&terms, &b);
            evidence_nats = found - sum(at_zero) - 0.5 * curvature.ln_determinant();
            if !moved || evidence_nats < SPEAKS || found - here < 0.1 {
                break;
            }
        }
        Fitted { block, evidence_nats, numbers: self.at(&b) }
    }
}

/// The evidence of some directions, were the log-likelihood quadratic; none where it is not finite.
fn linear_evidence(of: &[usize], scores: &[Vec<f64>]) -> f64 {
    let of: Vec<&Vec<f64>> = of.iter().map(|i| &scores[*i]).collect();
    let Some(curvature) = Curvature::new(&of, PRIOR_PRECISION) else { return f64::NEG_INFINITY };
    let slope: Vec<f64> = of.iter().copied().map(|score| sum(score)).collect();
    let step = curvature.step(&slope);
    0.5 * slope.iter().zip(&step).fold(0.0, |sum, (a, b)| sum + a * b) - 0.5 * curvature.ln_determinant()
}

fn sum(terms: &[f64]) -> f64 {
    terms.iter().fold(0.0, |sum, it| sum + it)
}
