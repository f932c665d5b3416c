//! The sways of a gait at each pace, and how much of motion is noise, made most likely together on nominal logs.
//!
//! Runs with their truth do not tell them apart as a filter does: a body that yaws with every step turns, and turns back, and a
//! filter that has no sway for it takes each for motion noise.

use asami_math::elementary::{exp, ln, sin_cos};
use rayon::prelude::*;

use super::Base;
use crate::memory::{Memory, Sway};
use crate::newton::{Curvature, climb};
use crate::shape::Numbers;
use crate::sighted::Sighted;

/// Numbers of a sway as they are searched: log-odds of its share, two partial autocorrelations on Fisher's scale, the logarithm of
/// its scale.
const OF_A_SWAY: usize = 4;
/// A step goes so far in each of them, as a prior about where it starts has it.
const UNITS: [f64; OF_A_SWAY] = [0.5, 0.3, 0.3, 0.2];
/// The same of the logarithms of motion's variances.
const NOISE_UNIT: f64 = 0.5;
/// Differences are taken over this share of a unit.
const DIFFERENCE: f64 = 0.02;
/// Steps of Newton's method, in each round.
const ITERATIONS: usize = 20;
/// Rounds: a sway is sought anew once others have taken what was theirs from motion's noise.
const ROUNDS: usize = 2;
/// Sways that are tried at each pace: so often a second, so much of all noise, fading to 1/e in such a time, of these scales.
const SOUGHT_HZ: [f64; 8] = [1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0];
const SOUGHT_SHARE: f64 = 0.9;
const SOUGHT_FADES_S: f64 = 1.0;
const SOUGHT_SCALES: [f64; 3] = [0.4, 0.8, 1.6];
/// What gains less a log in place of another is not taken, in nats.
const SOUGHT_GAINS_NATS: f64 = 1.0;
/// A step that gains less a log is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 0.5;
/// Greatest share, and greatest partial autocorrelation: what never fades is no noise.
const MOST: f64 = 0.998;

/// What is searched, and where it starts.
struct Searched<'a> {
    base: &'a Base,
    logs: &'a [Sighted<'a>],
    start: Vec<f64>,
}

/// Numbers with the motion noise, and the memory, that make logs most likely.
pub(super) fn swaying(base: &Base, logs: &[Sighted<'_>]) -> (Vec<f64>, Memory) {
    let mut searched = Searched::new(base, logs);
    for _ in 0..ROUNDS {
        searched.seek();
        searched.ascend();
    }
    searched.read(&searched.start)
}

impl<'a> Searched<'a> {
    fn new(base: &'a Base, logs: &'a [Sighted<'a>]) -> Self {
        let noise = base.numbers[base.shape.range(Numbers::MotionNoise)].iter().map(|it| it / NOISE_UNIT);
        let sways = base.memory.sways.iter().flatten().flat_map(written);
        Self { base, logs, start: noise.chain(sways).collect() }
    }

    /// Puts in place of each sway, one after another, the likeliest of those that are tried.
    fn seek(&mut self) {
        let first = self.start.len() - self.base.memory.sways.as_flattened().len() * OF_A_SWAY;
        let tried = sought(self.base.memory.frame_s);
        let least = SOUGHT_GAINS_NATS * self.logs.len() as f64;
        let mut best = sum(&self.terms(&self.start));
        for at in (first..self.start.len()).step_by(OF_A_SWAY) {
            for sway in &tried {
                let mut there = self.start.clone();
                there[at..at + OF_A_SWAY].copy_from_slice(sway);
                let found = sum(&self.terms(&there));
                if found > best + least {
                    (best, self.start) = (found, there);
                }
            }
        }
    }

    /// Ascends from the start until nothing is gained.
    fn ascend(&mut self) {
        let mut here = self.terms(&self.start);
        for _ in 0..ITERATIONS {
            let Some((gained, at, terms)) = self.step(&here) else { break };
            (self.start, here) = (at, terms);
            if gained < GAINS_NOTHING_NATS * self.logs.len() as f64 {
                break;
            }
        }
    }

    fn read(&self, at: &[f64]) -> (Vec<f64>, Memory) {
        let (mut numbers, mut memory) = (self.base.numbers.clone(), self.base.memory);
        let of = self.base.shape.range(Numbers::MotionNoise);
        let (noise, sways) = at.split_at(of.len());
        numbers[of].iter_mut().zip(noise).for_each(|(number, at)| *number = NOISE_UNIT * at);
        for (sway, at) in memory.sways.iter_mut().flatten().zip(sways.chunks_exact(OF_A_SWAY)) {
            *sway = read(at);
        }
        (numbers, memory)
    }

    fn terms(&self, at: &[f64]) -> Vec<f64> {
        let (numbers, memory) = self.read(at);
        let of_each: Vec<Vec<f64>> = self.logs.par_iter().map(|log| log.swayed(&numbers, memory)).collect();
        of_each.concat()
    }

    /// A step from the start with the curvature of the scores: what it gains, and where it leads.
    fn step(&self, here: &[f64]) -> Option<(f64, Vec<f64>, Vec<f64>)> {
        let score = |i: usize| {
            let mut beside = self.start.clone();
            beside[i] += DIFFERENCE;
            let there = self.terms(&beside);
            there.iter().zip(here).map(|(there, here)| (there - here) / DIFFERENCE).collect()
        };
        let scores: Vec<Vec<f64>> = (0..self.start.len()).map(score).collect();
        let slope: Vec<f64> = scores.iter().map(|score| sum(score)).collect();
        let step = Curvature::new(&scores, 1.0)?.step(&slope);
        let from = sum(here);
        let better = climb(from, &[2.0], |share| {
            let at: Vec<f64> = self.start.iter().zip(&step).map(|(at, step)| at + share * step).collect();
            let terms = self.terms(&at);
            (sum(&terms), (at, terms))
        });
        better.map(|(found, (at, terms))| (found - from, at, terms))
    }
}

fn sum(terms: &[f64]) -> f64 {
    terms.iter().fold(0.0, |sum, it| sum + it)
}

fn fisher(r: f64) -> f64 {
    let r = r.clamp(-MOST, MOST);
    0.5 * ln((1.0 + r) / (1.0 - r))
}

fn correlation(z: f64) -> f64 {
    let e = exp(-2.0 * z.clamp(-20.0, 20.0));
    MOST * (1.0 - e) / (1.0 + e)
}

/// Sways that are tried.
fn sought(frame_s: f64) -> Vec<[f64; OF_A_SWAY]> {
    let fades = exp(-frame_s / SOUGHT_FADES_S);
    let of = |hz: f64, scale: f64| {
        let turn_rad = std::f64::consts::TAU * hz * frame_s;
        Sway { share: SOUGHT_SHARE, on: [2.0 * fades * sin_cos(turn_rad).1, -fades * fades], scale }
    };
    SOUGHT_HZ.into_iter().flat_map(|hz| SOUGHT_SCALES.map(|scale| written(&of(hz, scale)))).collect()
}

/// A sway as it is searched.
fn written(sway: &Sway) -> [f64; OF_A_SWAY] {
    let [p, q] = sway.on;
    let share = sway.share.clamp(0.01, 0.99);
    let at = [ln(share / (1.0 - share)), fisher(p / (1.0 - q)), fisher(q), ln(sway.scale)];
    std::array::from_fn(|i| at[i] / UNITS[i])
}

fn read(at: &[f64]) -> Sway {
    let [share, first, second, scale] = std::array::from_fn(|i| at[i] * UNITS[i]);
    let [first, second] = [first, second].map(correlation);
    let share = MOST / (1.0 + exp(-share.clamp(-20.0, 20.0)));
    Sway { share, on: [first * (1.0 - second), second], scale: exp(scale) }
}
