//! How commands move the robot: the columns' numbers, and the noise that is left.

use asami_math::elementary::{exp, ln};
use rayon::prelude::*;

use super::{Free, Run, dot};
use crate::columns::{Columns, Group};
use crate::shape::{CHANGING, Numbers, SPEEDS, STANDING, Shape, speed_class};
use crate::shrink::{Sums, ridged, shrunk, stands_out};
use crate::view::Step;

/// Motion noise is measured over blocks of so long: from frame to frame a gait sways.
const BLOCK_S: f64 = 2.0;
/// Prior standard deviation of every column's number, in the unit of what it makes.
const PRIOR_MOTION: [f64; 3] = [0.3, 0.3, 2.0];
/// Noise of a class of speed counts at least this share of the greatest: standing still is not measured endlessly well.
const LEAST_SHARE: f64 = 0.01;

/// Steps are weighed by the noise that was found so often.
const REWEIGHTED: usize = 2;

/// Columns that a fit may change.
fn free_columns(columns: &Columns, wear: bool) -> Vec<usize> {
    let fixed = [(Group::Heading, !columns.heading), (Group::Held, columns.heading), (Group::Wear, !wear)];
    let is_fixed = |i: usize| fixed.iter().any(|(group, is_fixed)| *is_fixed && columns.range(*group).contains(&i));
    (0..columns.len()).filter(|i| !is_fixed(*i)).collect()
}

/// Normal equations of a run for each axis: of its displacements less what `numbers` explain, on these columns.
fn sums(shape: &Shape, run: &Run, of: &[usize], numbers: &[f64], variances: Variances) -> [Sums; 3] {
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
        let variance = variances(step);
        for (axis, sums) in sums.iter_mut().enumerate() {
            let known = step.dt_s * dot(&row, &numbers[axis * width..(axis + 1) * width]);
            sums.add(&x, moved[axis] - known, 1.0 / (variance[axis] * step.dt_s));
        }
    }
    sums
}

/// How badly a ridge regression of the other runs foretells each run's displacements: logarithms of mean squares, of all axes.
pub fn unforeseen(shape: &Shape, runs: &[Run]) -> f64 {
    let of = free_columns(&shape.columns, false);
    let nothing = vec![0.0; shape.len()];
    let all: Vec<[Sums; 3]> = runs.par_iter().map(|run| sums(shape, run, &of, &nothing, &|_| [1.0; 3])).collect();
    let left = |axis: usize| {
        let by_others = all.iter().enumerate().map(|(i, run)| {
            let others = all.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, run)| run[axis].clone());
            run[axis].left(&ridged(&others.collect::<Vec<_>>(), PRIOR_MOTION[axis]))
        });
        ln(by_others.sum::<f64>().max(1e-300))
    };
    (0..3).map(left).sum()
}

/// Ridge regression of the nominal world's displacements on the columns, and the noise that it leaves.
pub fn nominal(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    regressed(shape, runs, &|_| [1.0; 3], numbers);
    noise(shape, runs, false, numbers);
    // Where commands change there is more noise, and not in proportion to the change: those steps count for less.
    for _ in 0..REWEIGHTED {
        let known = numbers.to_vec();
        regressed(shape, runs, &variances(shape, &known), numbers);
        noise(shape, runs, false, numbers);
    }
}

/// Ridge regression where steps have these variances.
fn regressed(shape: &Shape, runs: &[Run], variances: Variances, numbers: &mut [f64]) {
    let of = free_columns(&shape.columns, false);
    let width = shape.columns.len();
    let nothing = vec![0.0; numbers.len()];
    let all: Vec<[Sums; 3]> = runs.par_iter().map(|run| sums(shape, run, &of, &nothing, variances)).collect();
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
    let variances = variances(shape, &base);
    // Powers of the size, each with what it counts beside the first: effects are nearly as large as their sizes.
    let powers: &[(i32, f64)] = if runs.len() > 1 { &[(1, 1.0), (2, 0.3), (3, 0.1)] } else { &[(0, 1.0)] };
    let all: Vec<(f64, [Sums; 3])> = runs
        .iter()
        .flat_map(|(share, runs)| runs.iter().map(|run| (*share, sums(shape, run, &of, &base, &variances))))
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
    let in_turns = columns.in_turns().unwrap_or_default();
    let group_of = |column: usize| {
        let index = Group::ALL.iter().position(|group| columns.range(*group).contains(&column));
        // What lingers of the axis's own velocity is of another kind than what does of others'.
        match (index.unwrap_or(0), column - columns.range(Group::Lingering).start.min(column)) {
            (1, within) => 8 + usize::from(within % 3 != axis),
            (5, _) => 10,
            // An effect on turns changes one of those, and hardly any other column of the curve.
            (0, _) if in_turns.contains(&column) => 11,
            (index, _) => 3 + index,
        }
    };
    let at = |column: usize| of.iter().position(|it| *it == column);
    let alone = of.iter().filter(|column| !curve.contains(column)).map(|column| vec![(*column, 1.0)]);
    let single = columns.bends().into_iter().chain(alone).filter_map(|parts| {
        let first = parts.first()?.0;
        let parts: Option<Vec<_>> = parts.into_iter().map(|(column, share)| Some((at(column)?, share))).collect();
        Some((group_of(first), parts?))
    });
    terms.extend(single);
    terms
}

/// Variances of a second's motion at a step.
type Variances<'a> = &'a (dyn Fn(&Step) -> [f64; 3] + Sync);

/// Those that `numbers` say.
fn variances(shape: &Shape, numbers: &[f64]) -> impl Fn(&Step) -> [f64; 3] {
    let at = shape.range(Numbers::MotionNoise).start;
    let of: [[f64; 3]; CHANGING + 1] =
        std::array::from_fn(|class| std::array::from_fn(|axis| exp(numbers[at + 3 * class + axis])));
    let least: [f64; 3] =
        std::array::from_fn(|axis| LEAST_SHARE * (0..SPEEDS).map(|class| of[class][axis]).fold(0.0, f64::max));
    move |step| {
        let class = of[speed_class(step.attempt)];
        std::array::from_fn(|axis| class[axis].max(least[axis]) + step.changing * of[CHANGING][axis])
    }
}

/// Variances in one second, from what is left of the displacements in blocks. Of those that `numbers` say already, `known`
/// ones, only what stands out of chance is changed.
pub fn noise(shape: &Shape, runs: &[Run], known: bool, numbers: &mut [f64]) {
    let mut blocks: Vec<Left> = runs.iter().flat_map(|run| left(shape, run, numbers)).collect();
    // Wheels in Rapier stand still, where others still roll when they are told to stand: standing takes after the rest.
    blocks.retain(|it| it.class != STANDING || !shape.columns.rolls());
    let at = shape.range(Numbers::MotionNoise).start;
    let (steady, changing): (Vec<&Left>, Vec<&Left>) = blocks.iter().partition(|it| it.changed_s < STEADY * it.time_s);
    let time_s = |of: &[&Left]| of.iter().map(|it| it.time_s).sum::<f64>();
    let square = |of: &[&Left], axis: usize| of.iter().map(|it| it.sum[axis] * it.sum[axis]).sum::<f64>();
    for axis in 0..3 {
        let mut set = |class: usize, found: f64, found_var: f64| {
            let (number, found) = (&mut numbers[at + 3 * class + axis], ln(found.max(1e-10)));
            *number = if known { moved(*number, found, found_var) } else { found };
        };
        let all_s = time_s(&steady);
        let mean = if all_s > 0.0 { square(&steady, axis) / all_s } else { 1e-6 };
        let mut of_class = [mean; SPEEDS];
        for (class, variance) in of_class.iter_mut().enumerate() {
            let of: Vec<&Left> = steady.iter().copied().filter(|it| it.class == class).collect();
            // A class that hardly occurs takes after the others.
            let few = 3.0 * BLOCK_S;
            *variance = (square(&of, axis) + few * mean) / (time_s(&of) + few);
            // The logarithm of a variance from n blocks has variance 2 / n.
            set(class, *variance, 2.0 * BLOCK_S / (time_s(&of) + few));
        }
        let [all, plain] = [square(&changing, axis), changing.iter().map(|it| of_class[it.class] * it.time_s).sum()];
        let changed_s = changing.iter().map(|it| it.changed_s).sum::<f64>().max(1e-3);
        let more = (all - plain).max(0.01 * plain).max(1e-9);
        let n = (changing.len() as f64).max(1.0);
        set(CHANGING, more / changed_s, 2.0 / n * (all / more) * (all / more));
    }
}

/// Commands change less than this, on average, in a block that is called steady.
const STEADY: f64 = 0.02;

/// What is left of the displacements in a block.
struct Left {
    sum: [f64; 3],
    time_s: f64,
    /// Integral of how much commands change.
    changed_s: f64,
    class: usize,
}

/// Of a run, block by block, each of one class of speed.
fn left(shape: &Shape, run: &Run, numbers: &[f64]) -> Vec<Left> {
    let columns = &shape.columns;
    let width = columns.len();
    let mut row = Vec::with_capacity(width);
    let mut blocks: Vec<Left> = Vec::new();
    let mut open = Left { sum: [0.0; 3], time_s: 0.0, changed_s: 0.0, class: 0 };
    for i in 0..run.view.steps.len() {
        let Some(moved) = run.moved(i, columns, &mut row) else { continue };
        let step = &run.view.steps[i];
        let class = speed_class(step.attempt);
        if class != open.class {
            open = Left { sum: [0.0; 3], time_s: 0.0, changed_s: 0.0, class };
        }
        for axis in 0..3 {
            open.sum[axis] += moved[axis] - step.dt_s * dot(&row, &numbers[axis * width..(axis + 1) * width]);
        }
        open.time_s += step.dt_s;
        open.changed_s += step.dt_s * step.changing;
        if open.time_s >= BLOCK_S {
            blocks.push(std::mem::replace(&mut open, Left { sum: [0.0; 3], time_s: 0.0, changed_s: 0.0, class }));
        }
    }
    blocks
}

/// Where a number moves that was found anew with some variance: as far as that stands out of chance.
pub fn moved(known: f64, found: f64, found_var: f64) -> f64 {
    known + stands_out(found - known, found_var)
}
