//! How commands move the robot: the columns' numbers, and the noise that is left.

use asami_math::elementary::{exp, ln};

use super::{Free, Run, dot};
use crate::columns::{Columns, Group};
use crate::shape::{Numbers, SPEEDS, Shape, speed_class};
use crate::shrink::{Sums, ridged, shrunk, stands_out};

/// Motion noise is measured over blocks of so long: from frame to frame a gait sways.
const BLOCK_S: f64 = 2.0;
/// Prior standard deviation of every column's number, in the unit of what it makes.
const PRIOR_MOTION: [f64; 3] = [0.3, 0.3, 2.0];
/// Noise of a class of speed counts at least this share of the greatest: standing still is not measured endlessly well.
const LEAST_SHARE: f64 = 0.01;

/// Columns that a fit may change.
fn free_columns(columns: &Columns, wear: bool) -> Vec<usize> {
    let fixed = [(Group::Heading, !columns.heading), (Group::Held, columns.heading), (Group::Wear, !wear)];
    let is_fixed = |i: usize| fixed.iter().any(|(group, is_fixed)| *is_fixed && columns.range(*group).contains(&i));
    (0..columns.len()).filter(|i| !is_fixed(*i)).collect()
}

/// Normal equations of a run for each axis: of its displacements less what `numbers` explain, on these columns.
fn sums(shape: &Shape, run: &Run, of: &[usize], numbers: &[f64], weights: &[[f64; 3]; SPEEDS]) -> [Sums; 3] {
    let columns = &shape.columns;
    let width = columns.len();
    let mut sums: [Sums; 3] = std::array::from_fn(|_| Sums::new(of.len()));
    let (mut row, mut x) = (Vec::with_capacity(width), vec![0.0; of.len()]);
    for i in 0..run.view.steps.len() {
        let Some(moved) = run.moved(i, columns, &mut row) else { continue };
        let step = &run.view.steps[i];
        for (x, column) in x.iter_mut().zip(of) {
            *x = row[*column] * step.dt_s;
        }
        let weight = weights[speed_class(step.attempt)];
        for (axis, sums) in sums.iter_mut().enumerate() {
            let known = step.dt_s * dot(&row, &numbers[axis * width..(axis + 1) * width]);
            sums.add(&x, moved[axis] - known, weight[axis] / step.dt_s);
        }
    }
    sums
}

/// Ridge regression of the nominal world's displacements on the columns.
pub fn nominal(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    let of = free_columns(&shape.columns, false);
    let width = shape.columns.len();
    let all: Vec<[Sums; 3]> = runs.iter().map(|run| sums(shape, run, &of, numbers, &[[1.0; 3]; SPEEDS])).collect();
    for axis in 0..3 {
        let runs: Vec<Sums> = all.iter().map(|run| run[axis].clone()).collect();
        for (column, number) in of.iter().zip(ridged(&runs, PRIOR_MOTION[axis])) {
            numbers[axis * width + column] = number;
        }
    }
}

/// The numbers at several sizes of an effect, in shares of the greatest, from those that it left alone; of several
/// sizes they change as a polynomial of third degree.
pub fn changed(shape: &Shape, runs: &[(f64, Vec<Run>)], free: Free, responses: &mut [Vec<f64>]) {
    let Some(base) = responses.first().cloned() else { return };
    let of = free_columns(&shape.columns, free.wear);
    let width = shape.columns.len();
    let weights = weights(shape, &base);
    // Powers of the size, each with what it counts beside the first: effects are nearly as large as their sizes.
    let powers: &[(i32, f64)] = if runs.len() > 1 { &[(1, 1.0), (2, 0.3), (3, 0.1)] } else { &[(0, 1.0)] };
    let all: Vec<(f64, [Sums; 3])> = runs
        .iter()
        .flat_map(|(share, runs)| runs.iter().map(|run| (*share, sums(shape, run, &of, &base, &weights))))
        .collect();
    for axis in 0..3 {
        let terms = terms(shape, &base, &of, axis);
        let of_runs: Vec<Sums> = all
            .iter()
            .map(|(share, sums)| {
                let scaled = |(power, counts): &(i32, f64)| {
                    let by = counts * share.powi(*power);
                    terms.iter().map(move |(_, row)| row.iter().map(|(i, it)| (*i, by * it)).collect())
                };
                sums[axis].combined(&powers.iter().flat_map(scaled).collect::<Vec<Vec<_>>>())
            })
            .collect();
        let group: Vec<usize> = powers.iter().flat_map(|_| terms.iter().map(|(group, _)| *group)).collect();
        let found = shrunk(&of_runs, &group);
        for ((share, _), numbers) in runs.iter().zip(responses.iter_mut()) {
            for ((power, counts), found) in powers.iter().zip(found.chunks_exact(terms.len())) {
                for ((_, row), found) in terms.iter().zip(found) {
                    for (i, it) in row {
                        numbers[axis * width + of[*i]] += counts * share.powi(*power) * found * it;
                    }
                }
            }
        }
    }
}

/// What an axis's motion may change by, each term with the group of its prior: every column by itself, and ahead of
/// them what most effects do: shares of each axis's own curve, and a velocity while moving.
fn terms(shape: &Shape, base: &[f64], of: &[usize], axis: usize) -> Vec<(usize, Vec<(usize, f64)>)> {
    let columns = &shape.columns;
    let width = columns.len();
    let curve = columns.range(Group::Curve);
    let greatest =
        |axis: usize| base[axis * width..][curve.clone()].iter().fold(0.0, |most, it| f64::max(most, it.abs()));
    let whole = |value: &dyn Fn(usize) -> f64| -> Vec<(usize, f64)> {
        let within = of.iter().enumerate().filter(|(_, column)| curve.contains(column));
        within.map(|(i, column)| (i, value(*column))).collect()
    };
    let mut terms = Vec::new();
    for from in (0..3).filter(|from| greatest(*from) > 0.0) {
        let unit = greatest(axis).max(1e-3) / greatest(from);
        let group = usize::from(from != axis);
        terms.push((group, whole(&|column| unit * base[from * width + column])));
    }
    terms.push((2, whole(&|_| greatest(axis).max(1e-3))));
    let group = |column: usize| {
        let order = [Group::Curve, Group::Lingering, Group::Heading, Group::Held, Group::Wear];
        let index = order.iter().position(|group| columns.range(*group).contains(&column));
        // What lingers of the axis's own velocity is of another kind than what does of others'.
        match (index.unwrap_or(0), column - columns.range(Group::Lingering).start.min(column)) {
            (1, within) => 8 + usize::from(within % 3 != axis),
            (index, _) => 3 + index,
        }
    };
    terms.extend(of.iter().enumerate().map(|(i, column)| (group(*column), vec![(i, 1.0)])));
    terms
}

/// Inverse variances of one second's motion, by class of speed.
fn weights(shape: &Shape, numbers: &[f64]) -> [[f64; 3]; SPEEDS] {
    let at = shape.range(Numbers::MotionNoise).start;
    let variance = |class: usize, axis: usize| exp(numbers[at + 3 * class + axis]);
    let greatest = |axis: usize| (0..SPEEDS).map(|class| variance(class, axis)).fold(0.0, f64::max);
    std::array::from_fn(|class| {
        std::array::from_fn(|axis| 1.0 / variance(class, axis).max(LEAST_SHARE * greatest(axis)))
    })
}

/// Variances in one second, from what is left of the displacements in blocks. Of those that `numbers` say already, `known`
/// ones, only what stands out of chance is changed.
pub fn noise(shape: &Shape, runs: &[Run], known: bool, numbers: &mut [f64]) {
    let (squares, times_s) = left(shape, runs, numbers);
    let at = shape.range(Numbers::MotionNoise).start;
    let all_s: f64 = times_s.iter().sum();
    for class in 0..SPEEDS {
        for axis in 0..3 {
            let all: f64 = squares.iter().map(|it| it[axis]).sum();
            // A class that hardly occurs takes after the others.
            let few = 3.0 * BLOCK_S;
            let mean = if all_s > 0.0 { all / all_s } else { 1e-6 };
            let variance = (squares[class][axis] + few * mean) / (times_s[class] + few);
            let (number, found) = (&mut numbers[at + 3 * class + axis], ln(variance.max(1e-10)));
            // The logarithm of a variance from n blocks has variance 2 / n.
            let found_var = 2.0 * BLOCK_S / (times_s[class] + few);
            *number = if known { moved(*number, found, found_var) } else { found };
        }
    }
}

/// Sums of squares, and seconds, of what is left of the displacements in blocks, by class of speed.
fn left(shape: &Shape, runs: &[Run], numbers: &[f64]) -> ([[f64; 3]; SPEEDS], [f64; SPEEDS]) {
    let columns = &shape.columns;
    let width = columns.len();
    let (mut squares, mut times_s) = ([[0.0; 3]; SPEEDS], [0.0; SPEEDS]);
    let mut row = Vec::with_capacity(width);
    for run in runs {
        let (mut sum, mut time_s, mut class) = ([0.0; 3], 0.0, 0);
        for i in 0..run.view.steps.len() {
            let Some(moved) = run.moved(i, columns, &mut row) else { continue };
            let step = &run.view.steps[i];
            if speed_class(step.attempt) != class {
                (sum, time_s, class) = ([0.0; 3], 0.0, speed_class(step.attempt));
            }
            for axis in 0..3 {
                sum[axis] += moved[axis] - step.dt_s * dot(&row, &numbers[axis * width..(axis + 1) * width]);
            }
            time_s += step.dt_s;
            if time_s >= BLOCK_S {
                for axis in 0..3 {
                    squares[class][axis] += sum[axis] * sum[axis];
                }
                times_s[class] += time_s;
                (sum, time_s) = ([0.0; 3], 0.0);
            }
        }
    }
    (squares, times_s)
}

/// Where a number moves that was found anew with some variance: as far as that stands out of chance.
pub fn moved(known: f64, found: f64, found_var: f64) -> f64 {
    known + stands_out(found - known, found_var)
}
