//! *Unknown*: five flexible blocks into which an effect that is in nobody's list would fall.
//!
//! A block is a handful of directions in which a response may change, each with a Gaussian prior. Its
//! evidence is Laplace's; the curvature is that of the scores of single frames, so that means and noise are treated alike.

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
    let here = on.likely(&vec![0.0; all.len()]);
    let scores: Vec<Vec<f64>> = (0..all.len()).map(|i| on.score(&vec![0.0; all.len()], &here, i)).collect();
    let mut start = 0;
    let mut ranges: Vec<std::ops::Range<usize>> = Vec::new();
    for directions in &each {
        ranges.push(start..start + directions.len());
        start += directions.len();
    }
    ranges.push(0..all.len());
    BLOCKS.into_iter().zip(ranges).map(|(block, range)| on.block(block, range, &here, &scores)).collect()
}

/// The response from `numbers` that makes several logs of one world most likely, as far as one block may change it, in those
/// of its directions that change `free` numbers alone; `numbers` themselves where nothing is gained that its freedom is worth.
#[must_use]
pub fn polished(judges: &[&dyn Judge], numbers: &[f64], block: &'static str, free: &dyn Fn(usize) -> bool) -> Vec<f64> {
    let fitted = fitted(judges, numbers, block, free);
    fitted.filter(|it| it.evidence_nats > 0.0).map_or_else(|| numbers.to_vec(), |it| it.numbers)
}

/// The same, whatever its freedom is worth.
#[must_use]
pub fn likeliest(judges: &[&dyn Judge], numbers: &[f64], block: &'static str) -> Vec<f64> {
    fitted(judges, numbers, block, &|_| true).map_or_else(|| numbers.to_vec(), |it| it.numbers)
}

fn fitted(judges: &[&dyn Judge], numbers: &[f64], block: &'static str, free: &dyn Fn(usize) -> bool) -> Option<Fitted> {
    let mut directions = judges.first()?.directions(numbers, block);
    directions.retain(|direction| direction.iter().enumerate().all(|(i, change)| *change == 0.0 || free(i)));
    let on = On { judges, numbers, directions: &directions, of: &|_| true };
    let none = vec![0.0; directions.len()];
    let here = on.likely(&none);
    let scores: Vec<Vec<f64>> = (0..directions.len()).map(|i| on.score(&none, &here, i)).collect();
    Some(on.block(block, 0..directions.len(), &here, &scores))
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

    /// Derivatives of the steps' log-likelihoods along a direction.
    fn score(&self, b: &[f64], here: &[f64], direction: usize) -> Vec<f64> {
        let mut beside = b.to_vec();
        beside[direction] += DIFFERENCE;
        self.likely(&beside).iter().zip(here).map(|(there, here)| (there - here) / DIFFERENCE).collect()
    }

    /// Fits the block of some of the directions by Newton's method.
    fn block(
        &self,
        block: &'static str,
        range: std::ops::Range<usize>,
        at_zero: &[f64],
        scores: &[Vec<f64>],
    ) -> Fitted {
        let mut b = vec![0.0; self.directions.len()];
        let mut terms = at_zero.to_vec();
        let mut of_block: Vec<Vec<f64>> = scores[range.clone()].to_vec();
        let mut evidence_nats = f64::NEG_INFINITY;
        for iteration in 0..ITERATIONS {
            if iteration > 0 {
                of_block = range.clone().map(|i| self.score(&b, &terms, i)).collect();
            }
            let Some(curvature) = Curvature::new(&of_block, PRIOR_PRECISION) else { break };
            let slope: Vec<f64> = of_block.iter().zip(&b[range.clone()]).map(|(score, b)| sum(score) - b).collect();
            let step = curvature.step(&slope);
            let objective = |terms: &[f64], b: &[f64]| sum(terms) - 0.5 * b.iter().fold(0.0, |sum, b| sum + b * b);
            let here = objective(&terms, &b);
            // Logarithms of noise are far from quadratic: longer steps may help.
            let better = climb(here, &[2.0, 4.0], |share| {
                let mut there = b.clone();
                for (b, step) in there[range.clone()].iter_mut().zip(&step) {
                    *b += share * step;
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

fn sum(terms: &[f64]) -> f64 {
    terms.iter().fold(0.0, |sum, it| sum + it)
}
