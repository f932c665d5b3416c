//! How landmarks look: the sensor's curves, their noise, false sightings, and how often landmarks are seen at all.

use std::f64::consts::TAU;

use asami_math::angle::wrap_rad;
use asami_math::elementary::{exp, ln, logistic, logit, sin_cos};
use rayon::prelude::*;

use super::motion::moved;
use super::{Run, dot, frame_s};
use crate::memory::{Memory, Sway};
use crate::rhythm::Heard;
use crate::shape::{BANDS, Numbers, Shape, Sight};
use crate::shrink::{Sums, ridged, shrunk};
use crate::touch::Touch;

/// Rounds in which it is told which sightings are of something else.
const ROUNDS: usize = 4;
/// Share of sightings of something else that is thought of first.
const FIRST_FALSE: f64 = 0.01;
/// Least share: none seen in a library's runs is no proof that there are none.
const LEAST_FALSE: f64 = 3e-4;
/// Prior sightings of each bin of detection, at the share of the response that the fit starts from.
const PRIOR_SIGHTINGS: f64 = 20.0;
/// Least share of landmarks that are seen, and missed, wherever they are: none in a library's runs is no proof.
const LEAST_SEEN: f64 = 0.002;
/// Prior standard deviation of a curve of which nothing is known: none to speak of.
const ANY_CURVE: f64 = 1e4;

/// A sighting less what the numbers say of it.
struct Left {
    step: usize,
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
pub fn changed(shape: &Shape, runs: &[Run], touch: Touch, numbers: &mut [f64]) {
    let known = numbers.to_vec();
    let (bends, scatters) = (touch.changes(Numbers::Size), touch.changes(Numbers::False));
    // A bias must not be taken for a great many false sightings.
    let noises = [Numbers::SizeNoise, Numbers::BearingNoise].map(|group| shape.range(group));
    noises.into_iter().flatten().for_each(|i| numbers[i] += ln(3.0));
    numbers[shape.range(Numbers::False).start] = logit(FIRST_FALSE);
    for _ in 0..ROUNDS {
        if bends {
            curves(shape, runs, Some(&known), numbers);
        }
        noise(shape, runs, Some(&known), numbers);
    }
    if !scatters {
        let of_false = shape.range(Numbers::False);
        numbers[of_false.clone()].copy_from_slice(&known[of_false]);
    }
}

/// What sizes and bearings are explained by: the size's columns, the bearing's, the landmarks' places.
struct Row {
    /// Of a sighting's size, and of its bearing.
    of: [Vec<f64>; 2],
    /// Where each part begins.
    starts: [usize; 3],
}

impl Row {
    fn new(shape: &Shape) -> Self {
        let [size, bearing, places] = [Numbers::Size, Numbers::Bearing, Numbers::Moved].map(|group| shape.width(group));
        let width = size + bearing + places;
        Self { of: [vec![0.0; width], vec![0.0; width]], starts: [0, size, size + bearing] }
    }

    /// Fills both for a sight, and gives what is expected. A place that is off moves sizes by their slope, and bearings
    /// by the angle that it takes up.
    fn fill(&mut self, shape: &Shape, numbers: &[f64], sight: &Sight) -> [f64; 2] {
        let [_, bearing, places] = self.starts;
        let mut slopes = [0.0; 4];
        self.of.iter_mut().for_each(|of| of.fill(0.0));
        shape.size_columns(sight, &mut self.of[0][..bearing], &mut slopes);
        shape.bearing_columns(sight, &mut self.of[1][bearing..places]);
        let of_size = &numbers[shape.range(Numbers::Size)];
        let expected = [
            dot(&self.of[0][..bearing], of_size),
            sight.bearing_rad + dot(&self.of[1][bearing..places], &numbers[shape.range(Numbers::Bearing)]),
        ];
        if shape.landmarks > 1 {
            let slope = dot(&slopes[..shape.curve_width()], of_size);
            let d = sight.distance_m.max(0.05);
            // The world's y axis is bearing 0 of a robot with heading 0.
            let (sin, cos) = sin_cos(sight.bearing_rad + sight.theta_rad);
            let at = places + 2 * sight.landmark;
            self.of[0][at..at + 2].copy_from_slice(&[-slope * sin, slope * cos]);
            self.of[1][at..at + 2].copy_from_slice(&[-cos / d, -sin / d]);
        }
        expected
    }
}

/// Everything seen in a run, with the rows of its size and bearing.
fn each(shape: &Shape, run: &Run, numbers: &[f64], mut with: impl FnMut(&Left, &[Vec<f64>; 2])) {
    let mut row = Row::new(shape);
    let noise = [shape.range(Numbers::SizeNoise).start, shape.range(Numbers::BearingNoise).start];
    let false_share = logistic(numbers[shape.range(Numbers::False).start]);
    for (i, step) in run.view.steps.iter().enumerate() {
        for seen in &run.view.seen[step.seen.clone()] {
            let sight = run.sight(i, seen.landmark, shape.moved(numbers, seen.landmark));
            let expected = row.fill(shape, numbers, &sight);
            let residual = [seen.size - expected[0], wrap_rad(seen.bearing_rad - expected[1])];
            let band = shape.band(sight.distance_m);
            let ln_sd = [0, 1].map(|k| numbers[noise[k] + band]);
            let squares = (0..2).fold(0.0, |sum, k| sum + (residual[k] / exp(ln_sd[k])).powi(2));
            let of_it = ln(1.0 - false_share) - 0.5 * squares - ln(TAU) - ln_sd[0] - ln_sd[1];
            let off_rad = wrap_rad(seen.bearing_rad - step.pan_rad);
            let of_something_else = ln(false_share * shape.elsewhere(seen.size, off_rad));
            let genuine = 1.0 / (1.0 + exp((of_something_else - of_it).min(700.0)));
            with(&Left { step: i, band, residual, genuine }, &row.of);
        }
    }
}

/// The sensor's curves and the landmarks' places; of `known` ones only what the runs show to change. Nominally landmarks
/// stand where they are said to.
fn curves(shape: &Shape, runs: &[Run], known: Option<&[f64]>, numbers: &mut [f64]) {
    let of: Vec<usize> =
        [Numbers::Size, Numbers::Bearing, Numbers::Moved].into_iter().flat_map(|group| shape.range(group)).collect();
    let noise = [Numbers::SizeNoise, Numbers::BearingNoise].map(|group| shape.range(group).start);
    let change: Vec<f64> = of.iter().map(|i| numbers[*i] - known.map_or(0.0, |known| known[*i])).collect();
    let width = if known.is_some() { of.len() } else { of.len() - shape.width(Numbers::Moved) };
    let before: &[f64] = numbers;
    let mut sums: Vec<Sums> = runs
        .par_iter()
        .map(|run| {
            let mut sums = Sums::new(width);
            each(shape, run, before, |left, rows| {
                for k in 0..2 {
                    let y = left.residual[k] + dot(&rows[k][..width], &change[..width]);
                    sums.add(&rows[k][..width], y, left.genuine * exp(-2.0 * before[noise[k] + left.band]));
                }
            });
            sums
        })
        .collect();
    if let (None, Some(first)) = (known, sums.first_mut()) {
        for (column, prior_sd) in shape.off_columns() {
            let row: Vec<f64> = (0..width).map(|i| if i == column { 1.0 } else { 0.0 }).collect();
            first.add(&row, 0.0, 1.0 / (prior_sd * prior_sd));
        }
    }
    let curves = shape.width(Numbers::Size) + shape.width(Numbers::Bearing);
    let group: Vec<usize> = (0..width).map(|i| i.min(curves)).collect();
    let found = if known.is_some() { shrunk(&sums, &group) } else { ridged(&sums, ANY_CURVE) };
    for (i, found) in of.into_iter().zip(found) {
        numbers[i] = known.map_or(0.0, |known| known[i]) + found;
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

/// What every sighting of a run is off, in the order of the view.
pub fn heard(shape: &Shape, run: &Run, numbers: &[f64]) -> Vec<Heard> {
    let noise = [shape.range(Numbers::SizeNoise).start, shape.range(Numbers::BearingNoise).start];
    let mut heard = Vec::with_capacity(run.view.seen.len());
    each(shape, run, numbers, |left, _| {
        let sd = [0, 1].map(|k| exp(numbers[noise[k] + left.band]));
        let off = [0, 1].map(|k| left.residual[k] / sd[k]);
        heard.push(Heard { t_s: run.view.steps[left.step].t_s, off: (left.genuine > 0.5).then_some(off), sd });
    });
    heard
}

/// The noise's sways, as runs with these numbers show them.
pub fn memory(shape: &Shape, runs: &[Run], numbers: &[f64]) -> Memory {
    let noise = [shape.range(Numbers::SizeNoise).start, shape.range(Numbers::BearingNoise).start];
    let mut noises: [Vec<Vec<Option<f64>>>; 2] = Default::default();
    for run in runs {
        // Of several landmarks in a frame the mean: what sways is common to all.
        let mut sums = vec![([0.0; 2], 0.0); run.view.steps.len()];
        each(shape, run, numbers, |left, _| {
            if left.genuine > 0.5 {
                let (sum, n) = &mut sums[left.step];
                (0..2).for_each(|k| sum[k] += left.residual[k] / exp(numbers[noise[k] + left.band]));
                *n += 1.0;
            }
        });
        for (k, noises) in noises.iter_mut().enumerate() {
            noises.push(sums.iter().map(|(sum, n)| (*n > 0.0).then(|| sum[k] / n)).collect());
        }
    }
    Memory::at_any_pace([0, 1].map(|k| Sway::learn(&noises[k])), frame_s(runs))
}

/// How often landmarks are seen, by bin. What was taken for a landmark hides whether the landmark would have been seen.
pub fn detection(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    let of = shape.range(Numbers::Detection);
    let bearing = shape.range(Numbers::Bearing);
    let mut columns = vec![0.0; bearing.len()];
    let mut counts = vec![[0.0; 2]; of.len()];
    for run in runs.iter().filter(|run| run.view.misses) {
        let mut genuine = Vec::with_capacity(run.view.seen.len());
        each(shape, run, numbers, |left, _| genuine.push(left.genuine));
        for (i, step) in run.view.steps.iter().enumerate() {
            for landmark in 0..run.view.landmarks.len() {
                let sight = run.sight(i, landmark, shape.moved(numbers, landmark));
                let off_rad = shape.off_read(&sight, &numbers[bearing.clone()], &mut columns);
                let Some(bin) = shape.bin(sight.distance_m, off_rad) else { continue };
                match step.seen.clone().find(|it| run.view.seen[*it].landmark == landmark) {
                    Some(seen) => counts[bin][1] += genuine[seen],
                    None => counts[bin][0] += 1.0,
                }
            }
        }
    }
    // What is known of each bin, with misses that are as much likelier or rarer everywhere.
    let known: Vec<f64> = numbers[of.clone()].iter().map(|it| logistic(*it)).collect();
    let sums = counts.iter().zip(&known).fold([0.0; 2], |[of_seen, of_expected], ([missed, seen], share)| {
        [of_seen + seen, of_expected + (missed + seen) * share]
    });
    let ratio = if sums[1] > 0.0 { sums[0] / sums[1] } else { 1.0 };
    for (([missed, seen], share), number) in counts.into_iter().zip(known).zip(&mut numbers[of]) {
        let prior = PRIOR_SIGHTINGS * (share * ratio).min(1.0);
        let share = ((seen + prior) / (seen + missed + PRIOR_SIGHTINGS)).clamp(LEAST_SEEN, 1.0 - LEAST_SEEN);
        *number = logit(share);
    }
}
