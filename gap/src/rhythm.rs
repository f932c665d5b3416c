//! A gait's rhythm in the noise of sightings: lines at the stride's frequency and its multiples, which a walk keeps up for
//! minutes.
//!
//! They are most of the noise of a walking robot's camera, and say nothing of its pose. Which frequencies there are is
//! learned from the nominal world's own logs; of every log their sines and cosines are then fitted to a few strides about
//! each sighting, beside a line that stands for all that is slow (a short-time harmonic regression), and taken away. What is
//! left is for [`crate::memory`] and for the filter.

use std::f64::consts::TAU;

use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::sin_cos;
use asami_math::optimise::golden_section;
use asami_math::statistics::median;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Lines of sizes and of bearings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rhythm {
    /// Frequencies, in hertz.
    pub hertz: [Vec<f64>; 2],
    /// The response by which it was heard: what sightings should be, and how much they scatter with the rhythm in.
    pub numbers: Vec<f64>,
}

/// What is left of a sighting once what was expected is taken away, in standard deviations: size, bearing; `None` of one
/// that is of something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// When.
    pub t_s: f64,
    /// By how much it was off.
    pub off: Option<[f64; 2]>,
    /// The standard deviations, in pixels or metres and in radians.
    pub sd: [f64; 2],
}

/// Spectra are those of stretches so long.
const STRETCH_S: f64 = 20.0;
/// Lowest frequency of a gait, and so of what is no motion.
const LOWEST_HZ: f64 = 1.0;
/// A line stands so far out of the median of what is within [`NEAR_HZ`] of it.
const STANDS_OUT: f64 = 5.0;
const NEAR_HZ: f64 = 1.0;
/// Lines nearer than this are one.
const APART_HZ: f64 = 0.3;
/// At most so many are taken.
const LINES: usize = 3;
/// Half the time about a sighting to which sines are fitted.
const HALF_S: f64 = 2.0;
/// There must be so many sightings for each number that is fitted.
const PER_NUMBER: f64 = 3.0;

impl Rhythm {
    /// The rhythm in runs; `numbers` are what they were heard by.
    #[must_use]
    pub fn listen(runs: &[Vec<Heard>], frame_s: f64, numbers: &[f64]) -> Self {
        let hertz = [0, 1].map(|k| lines(runs, k, frame_s));
        Self { hertz, numbers: numbers.to_vec() }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.hertz.iter().all(Vec::is_empty)
    }

    /// What of each sighting is rhythm, in pixels or metres and in radians.
    #[must_use]
    pub fn of(&self, run: &[Heard]) -> Vec<[f64; 2]> {
        let (mut from, mut to) = (0, 0);
        let of = |now: &Heard| {
            while run.get(from).is_some_and(|it| it.t_s <= now.t_s - HALF_S) {
                from += 1;
            }
            while run.get(to).is_some_and(|it| it.t_s < now.t_s + HALF_S) {
                to += 1;
            }
            [0, 1].map(|k| now.sd[k] * about(&run[from..to], k, &self.hertz[k], now.t_s).unwrap_or(0.0))
        };
        run.iter().map(of).collect()
    }
}

/// The sum of the lines at a time, of sines and cosines fitted to what is about it.
fn about(near: &[Heard], k: usize, hertz: &[f64], t_s: f64) -> Option<f64> {
    if hertz.is_empty() {
        return None;
    }
    let p = 2 + 2 * hertz.len();
    let (mut matrix, mut right, mut n) = (vec![vec![0.0; p]; p], vec![0.0; p], 0.0);
    let mut row = vec![1.0; p];
    for (since_s, off) in near.iter().filter_map(|it| Some((it.t_s - t_s, it.off?[k]))) {
        // Least at the ends, so that nothing jumps where a sighting leaves.
        let weight = sin_cos(0.25 * TAU * since_s / HALF_S).1.max(0.0);
        row[1] = since_s;
        for (pair, hz) in row[2..].chunks_exact_mut(2).zip(hertz) {
            let (sin, cos) = sin_cos(TAU * hz * since_s);
            pair.copy_from_slice(&[cos, sin]);
        }
        for ((column, right), of) in matrix.iter_mut().zip(&mut right).zip(&row) {
            *right += weight * of * off;
            column.iter_mut().zip(&row).for_each(|(sum, other)| *sum += weight * of * other);
        }
        n += weight;
    }
    if n < PER_NUMBER * p as f64 {
        return None;
    }
    matrix.iter_mut().enumerate().for_each(|(i, column)| column[i] += 1e-6 * n);
    let found = cholesky_solve(&cholesky(&matrix)?, &right);
    // At the time itself sines are 0 and cosines 1.
    Some(found[2..].iter().step_by(2).sum())
}

/// Frequencies that stand out of a channel's spectrum, the clearest first.
fn lines(runs: &[Vec<Heard>], k: usize, frame_s: f64) -> Vec<f64> {
    if frame_s <= 0.0 {
        return Vec::new();
    }
    let step_hz = 0.5 / STRETCH_S;
    let highest_hz = 0.5 / frame_s;
    let count = (highest_hz / step_hz) as usize;
    let spectrum: Vec<f64> =
        (0..=count).into_par_iter().map(|i| power(runs, k, (i as f64 * step_hz).max(1e-9))).collect();
    let near = (NEAR_HZ / step_hz) as usize;
    let above = |i: usize| {
        let around = &spectrum[i.saturating_sub(near)..(i + near).min(spectrum.len())];
        spectrum[i] / median(around).unwrap_or(0.0).max(1e-12)
    };
    let first = (LOWEST_HZ / step_hz) as usize;
    let is_peak = |i: &usize| spectrum[*i] > spectrum[i - 1] && spectrum[*i] >= spectrum[i + 1];
    let mut peaks: Vec<(f64, f64)> = (first.max(1)..count)
        .filter(is_peak)
        .map(|i| (above(i), i as f64 * step_hz))
        .filter(|(above, _)| *above > STANDS_OUT)
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut found: Vec<f64> = Vec::new();
    for (_, hz) in peaks {
        if found.len() < LINES && found.iter().all(|line| (line - hz).abs() > APART_HZ) {
            found.push(golden_section(|hz| -power(runs, k, hz), hz - step_hz, hz + step_hz, 0.002).x);
        }
    }
    found
}

/// Mean power of a channel at a frequency, over all runs' whole stretches.
fn power(runs: &[Vec<Heard>], k: usize, hz: f64) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for run in runs {
        let Some(first) = run.first() else { continue };
        let mut until_s = first.t_s + STRETCH_S;
        let (mut re, mut im, mut count) = (0.0, 0.0, 0.0);
        for (t_s, off) in run.iter().filter_map(|it| Some((it.t_s, it.off?[k]))) {
            if t_s > until_s {
                if count > 0.0 {
                    sum += (re * re + im * im) / count;
                    n += 1.0;
                }
                (re, im, count) = (0.0, 0.0, 0.0);
                until_s = t_s + STRETCH_S;
            }
            let (sin, cos) = sin_cos(TAU * (hz * t_s).fract());
            re += cos * off;
            im += sin * off;
            count += 1.0;
        }
    }
    if n > 0.0 { sum / n } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// White noise, slow noise, and lines of these frequencies whose phases drift, in both channels.
    fn run(hertz: &[f64], seed: u64) -> Vec<Heard> {
        let mut rng = Seed(seed).stream("rhythm/test");
        let (mut slow, mut phases): (f64, Vec<f64>) = (0.0, hertz.iter().map(|_| TAU * rng.random::<f64>()).collect());
        (0..2000)
            .map(|i| {
                let t_s = 0.05 * f64::from(i);
                let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
                slow = 0.95 * slow + 0.1 * normal();
                phases.iter_mut().for_each(|phase| *phase += 0.01 * normal());
                let lines: f64 = hertz.iter().zip(&phases).map(|(hz, phase)| sin_cos(TAU * hz * t_s + phase).0).sum();
                Heard { t_s, off: Some([0.3 * normal() + slow + lines, 0.3 * normal()]), sd: [1.0; 2] }
            })
            .collect()
    }

    #[test]
    fn a_gait_is_heard_and_taken_away_and_nothing_else_is() {
        let hertz = [2.754, 8.262];
        let runs: Vec<_> = (0..6).map(|seed| run(&hertz, seed)).collect();
        let rhythm = Rhythm::listen(&runs, 0.05, &[]);
        let mut found = rhythm.hertz[0].clone();
        found.sort_by(f64::total_cmp);
        assert_eq!((found.len(), rhythm.hertz[1].len()), (2, 0), "{rhythm:?}");
        assert!(found.iter().zip(hertz).all(|(found, hz)| (found - hz).abs() < 0.01), "{found:?}");
        let (heard, silent) = (run(&hertz, 99), run(&[], 99));
        let left: f64 = heard
            .iter()
            .zip(rhythm.of(&heard))
            .filter_map(|(it, of)| Some(it.off?[0] - of[0]))
            .map(|it| it * it)
            .sum::<f64>();
        let without: f64 = silent.iter().filter_map(|it| it.off).map(|off| off[0] * off[0]).sum();
        // Of white noise the share of the numbers fitted goes with it: four of about fifty.
        assert!((0.75..1.15).contains(&(left / without)), "{left} {without}");
    }

    #[test]
    fn noise_without_a_rhythm_is_left_as_it_is() {
        let runs: Vec<_> = (0..6).map(|seed| run(&[], seed)).collect();
        let rhythm = Rhythm::listen(&runs, 0.05, &[]);
        assert!(rhythm.is_silent(), "{rhythm:?}");
        assert!(rhythm.of(&runs[0]).iter().all(|of| *of == [0.0; 2]));
        assert!(Rhythm::listen(&[], 0.05, &[]).is_silent() && Rhythm::listen(&runs, 0.0, &[]).is_silent());
    }
}
