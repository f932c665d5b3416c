//! How landmarks look: the sensor's curves, their noise, false sightings, and how often landmarks are seen at all.

use std::f64::consts::TAU;

use asami_math::angle::wrap_rad;
use asami_math::elementary::{exp, ln};

use super::motion::moved;
use super::{Run, dot};
use crate::shape::{BANDS, Numbers, Shape};
use crate::shrink::{Sums, ridged, shrunk};

/// Rounds in which it is told which sightings are of something else.
const ROUNDS: usize = 4;
/// Share of sightings of something else that is thought of first.
const FIRST_FALSE: f64 = 0.01;
/// Least share: none seen in a library's runs is no proof that there are none.
const LEAST_FALSE: f64 = 3e-4;
/// Prior sightings of each bin of detection, at the share of the response that the fit starts from.
const PRIOR_SIGHTINGS: f64 = 20.0;
/// Prior standard deviation of a curve of which nothing is known: none to speak of.
const ANY_CURVE: f64 = 1e4;

/// A sighting less what the numbers say of it.
struct Left {
    band: usize,
    /// Size, bearing.
    residual: [f64; 2],
    /// Probability that it is of the landmark that it says.
    genuine: f64,
}

/// The nominal sensor.
pub fn nominal(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    // At first noise is whatever sizes and bearings there are.
    let span = shape.sizes[1] - shape.sizes[0];
    numbers[shape.range(Numbers::SizeNoise)].fill(ln(span.max(1e-6)));
    numbers[shape.range(Numbers::BearingNoise)].fill(0.0);
    numbers[shape.range(Numbers::False).start] = logit(FIRST_FALSE);
    for _ in 0..ROUNDS {
        curves(shape, runs, None, numbers);
        noise(shape, runs, None, numbers);
    }
}

/// The sensor with an effect, as a change of the nominal one.
pub fn changed(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    let known = numbers.to_vec();
    // A bias must not be taken for a great many false sightings.
    let noises = [Numbers::SizeNoise, Numbers::BearingNoise].map(|group| shape.range(group));
    noises.into_iter().flatten().for_each(|i| numbers[i] += ln(3.0));
    numbers[shape.range(Numbers::False).start] = logit(FIRST_FALSE);
    for _ in 0..ROUNDS {
        curves(shape, runs, Some(&known), numbers);
        noise(shape, runs, Some(&known), numbers);
    }
}

fn logit(share: f64) -> f64 {
    ln(share / (1.0 - share))
}

/// Everything seen in a run, with its columns.
fn each(shape: &Shape, run: &Run, numbers: &[f64], mut with: impl FnMut(&Left, [&[f64]; 2])) {
    let (size, bearing) = (shape.range(Numbers::Size), shape.range(Numbers::Bearing));
    let (mut of_size, mut of_bearing, mut slopes) = (vec![0.0; size.len()], vec![0.0; bearing.len()], [0.0; 4]);
    let noise = [shape.range(Numbers::SizeNoise).start, shape.range(Numbers::BearingNoise).start];
    let false_share = 1.0 / (1.0 + exp(-numbers[shape.range(Numbers::False).start]));
    for (i, step) in run.view.steps.iter().enumerate() {
        for seen in &run.view.seen[step.seen.clone()] {
            let sight = run.sight(i, seen.landmark);
            shape.size_columns(&sight, &mut of_size, &mut slopes);
            shape.bearing_columns(&sight, &mut of_bearing);
            let residual = [
                seen.size - dot(&of_size, &numbers[size.clone()]),
                wrap_rad(seen.bearing_rad - sight.bearing_rad - dot(&of_bearing, &numbers[bearing.clone()])),
            ];
            let band = shape.band(sight.distance_m);
            let ln_sd = [0, 1].map(|k| numbers[noise[k] + band]);
            let squares = (0..2).fold(0.0, |sum, k| sum + (residual[k] / exp(ln_sd[k])).powi(2));
            let of_it = ln(1.0 - false_share) - 0.5 * squares - ln(TAU) - ln_sd[0] - ln_sd[1];
            let off_rad = wrap_rad(seen.bearing_rad - step.pan_rad);
            let of_something_else = ln(false_share) + shape.ln_elsewhere(seen.size, off_rad);
            let genuine = 1.0 / (1.0 + exp((of_something_else - of_it).min(700.0)));
            with(&Left { band, residual, genuine }, [&of_size, &of_bearing]);
        }
    }
}

/// Both curves; of `known` ones only what the runs show to change.
fn curves(shape: &Shape, runs: &[Run], known: Option<&[f64]>, numbers: &mut [f64]) {
    let of = [Numbers::Size, Numbers::Bearing].map(|group| shape.range(group));
    let noise = [Numbers::SizeNoise, Numbers::BearingNoise].map(|group| shape.range(group).start);
    let nothing = vec![0.0; numbers.len()];
    let from = known.unwrap_or(&nothing);
    let change: Vec<f64> = numbers.iter().zip(from).map(|(number, from)| number - from).collect();
    let sums: Vec<[Sums; 2]> = runs
        .iter()
        .map(|run| {
            let mut sums = of.clone().map(|of| Sums::new(of.len()));
            each(shape, run, numbers, |left, columns| {
                for k in 0..2 {
                    let y = left.residual[k] + dot(columns[k], &change[of[k].clone()]);
                    sums[k].add(columns[k], y, left.genuine * exp(-2.0 * numbers[noise[k] + left.band]));
                }
            });
            sums
        })
        .collect();
    let groups = [shape.size_groups(), shape.bearing_groups()];
    for (k, of) in of.into_iter().enumerate() {
        let runs: Vec<Sums> = sums.iter().map(|run| run[k].clone()).collect();
        let found = if known.is_some() { shrunk(&runs, &groups[k]) } else { ridged(&runs, ANY_CURVE) };
        for (i, found) in of.zip(found) {
            numbers[i] = from[i] + found;
        }
    }
}

/// Noise and the share of false sightings from what is left; of `known` ones only what stands out of chance changes.
fn noise(shape: &Shape, runs: &[Run], known: Option<&[f64]>, numbers: &mut [f64]) {
    let (mut squares, mut counts, mut seen) = ([[0.0; BANDS]; 2], [0.0; BANDS], 0.0);
    for run in runs {
        each(shape, run, numbers, |left, _| {
            for (squares, residual) in squares.iter_mut().zip(left.residual) {
                squares[left.band] += left.genuine * residual * residual;
            }
            counts[left.band] += left.genuine;
            seen += 1.0;
        });
    }
    let genuine: f64 = counts.iter().sum();
    for (k, group) in [Numbers::SizeNoise, Numbers::BearingNoise].into_iter().enumerate() {
        let all: f64 = squares[k].iter().sum();
        for (band, i) in shape.range(group).enumerate() {
            // A band in which hardly anything is seen takes after the others.
            let few = 10.0;
            let variance = (squares[k][band] + few * all / f64::max(genuine, 1.0)) / (counts[band] + few);
            let found = 0.5 * ln(variance.max(1e-12));
            // The logarithm of a standard deviation from n sightings has variance 1 / (2 n).
            let found_var = 0.5 / (counts[band] + few);
            numbers[i] = known.map_or(found, |known| moved(known[i], found, found_var));
        }
    }
    let count = (seen - genuine).max(0.0);
    let found = logit((count / f64::max(seen, 1.0)).clamp(LEAST_FALSE, 0.9));
    let i = shape.range(Numbers::False).start;
    numbers[i] = known.map_or(found, |known| moved(known[i], found, 1.0 / (count + 1.0)));
}

/// How often landmarks are seen, by bin.
pub fn detection(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    let of = shape.range(Numbers::Detection);
    let bearing = shape.range(Numbers::Bearing);
    let mut columns = vec![0.0; bearing.len()];
    let mut counts = vec![[0.0; 2]; of.len()];
    for run in runs.iter().filter(|run| run.view.misses) {
        for (i, step) in run.view.steps.iter().enumerate() {
            for landmark in 0..run.view.landmarks.len() {
                let sight = run.sight(i, landmark);
                let off_rad = shape.off_read(&sight, &numbers[bearing.clone()], &mut columns);
                let Some(bin) = shape.bin(sight.distance_m, off_rad) else { continue };
                let seen = run.view.seen[step.seen.clone()].iter().any(|it| it.landmark == landmark);
                counts[bin][usize::from(seen)] += 1.0;
            }
        }
    }
    for ([missed, seen], known) in counts.into_iter().zip(&mut numbers[of]) {
        let prior = PRIOR_SIGHTINGS / (1.0 + exp(-*known));
        let share = ((seen + prior) / (seen + missed + PRIOR_SIGHTINGS)).clamp(0.02, 0.98);
        *known = logit(share);
    }
}
