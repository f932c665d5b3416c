//! From simulated runs, with their truth, to the numbers of a response.

use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::{ln, sin_cos};

use crate::columns::{Columns, Group};
use crate::shape::{BANDS, Numbers, SPEEDS, Shape, Sight, speed_class};
use crate::view::View;

/// Motion noise is measured over blocks of so long: from frame to frame a gait sways.
const BLOCK_S: f64 = 1.0;
/// Sightings further out than so many standard deviations are of something else.
const OUTLYING: f64 = 5.0;
/// Least share of sightings of something else: none seen in a library's runs is no proof that there are none.
const LEAST_FALSE: f64 = 3e-4;
/// Prior sightings of each bin of detection, at the share of the response that the fit starts from.
const PRIOR_SIGHTINGS: f64 = 20.0;
/// Prior standard deviation of every column's number, in the unit of what it makes.
const PRIOR_MOTION: [f64; 3] = [0.3, 0.3, 2.0];

/// A run: what was logged, and where the robot was at each frame.
struct Run {
    view: View,
    poses: Vec<TruePose>,
}

/// The layout that the logs of a nominal world call for; `None` where no run has a sighting.
#[must_use]
pub fn shape(runs: &[Dataset]) -> Option<Shape> {
    let first = runs.first()?;
    let landmarks = first.log.known.landmarks.len();
    let columns = Columns::new(runs.iter().flat_map(|run| run.log.commands.iter()), landmarks);
    let (mut distances_m, mut offs_rad, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    let mut ranges = false;
    for run in runs {
        let Ok(run) = Run::new(run, &columns) else { continue };
        ranges |= run.view.ranges;
        for (i, step) in run.view.steps.iter().enumerate() {
            for seen in &run.view.seen[step.seen.clone()] {
                let sight = run.sight(i, seen.landmark);
                distances_m.push(sight.distance_m);
                offs_rad.push(sight.off_rad.abs());
                sizes.push(seen.size);
            }
        }
    }
    for values in [&mut distances_m, &mut offs_rad, &mut sizes] {
        values.sort_by(f64::total_cmp);
    }
    let at = |values: &[f64], share: f64| values.get(((values.len() as f64 - 1.0) * share) as usize).copied();
    Some(Shape {
        columns,
        landmarks,
        ranges,
        near_far_m: [at(&distances_m, 0.01)?, at(&distances_m, 0.99)?],
        off_rad: at(&offs_rad, 0.99)?,
        size_span: (at(&sizes, 1.0)? - at(&sizes, 0.0)?).max(1e-6),
    })
}

/// What a fit may change of the response that it starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// Whether motion may change with the time in the log.
    pub wear: bool,
}

/// The response that runs show, as a change of `base`; zeros are no bad base for the nominal one.
#[must_use]
pub fn fit(shape: &Shape, runs: &[Dataset], base: &[f64], free: Free) -> Vec<f64> {
    let runs: Vec<Run> = runs.iter().filter_map(|run| Run::new(run, &shape.columns).ok()).collect();
    let mut numbers = base.to_vec();
    motion(shape, &runs, free, &mut numbers);
    motion_noise(shape, &runs, &mut numbers);
    // Once with what may be of something else, and twice without.
    for round in 0..3 {
        sensor(shape, &runs, round > 0, &mut numbers);
    }
    detection(shape, &runs, &mut numbers);
    numbers
}

impl Run {
    fn new(run: &Dataset, columns: &Columns) -> Result<Self, crate::view::CannotSee> {
        let view = View::new(&run.log, columns)?;
        let first = run.truth.track.first().copied();
        let last = run.truth.track.last().copied();
        let at = |t_s: f64| {
            let beyond = if first.is_some_and(|first| t_s < first.t_s) { first } else { last };
            pose_at(&run.truth.track, t_s).or(beyond)
        };
        let none = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let poses = view.steps.iter().map(|step| at(step.t_s).unwrap_or(none)).collect();
        Ok(Self { view, poses })
    }

    /// How a landmark really lies at a step.
    fn sight(&self, i: usize, landmark: usize) -> Sight {
        let TruePose { x_m, y_m, theta_rad, .. } = self.poses[i];
        self.view.sight(i, landmark, [x_m, y_m, theta_rad])
    }

    /// The displacement before a step in the robot's frame, R(-theta) (w' - w), and its row of columns with the
    /// heading's filled in.
    fn moved(&self, i: usize, columns: &Columns, row: &mut Vec<f64>) -> Option<[f64; 3]> {
        let (before, after) = (self.poses.get(i.checked_sub(1)?)?, &self.poses[i]);
        if self.view.steps[i].dt_s <= 0.0 {
            return None;
        }
        let (sin, cos) = sin_cos(before.theta_rad);
        let (dx, dy) = (after.x_m - before.x_m, after.y_m - before.y_m);
        row.clear();
        row.extend_from_slice(self.view.row(i));
        let heading = columns.range(Group::Heading).start;
        row[heading + 1] = row[heading] * sin;
        row[heading] *= cos;
        Some([cos * dx + sin * dy, cos * dy - sin * dx, wrap_rad(after.theta_rad - before.theta_rad)])
    }
}

/// Ridge regression of displacements on the columns that are free.
fn motion(shape: &Shape, runs: &[Run], free: Free, numbers: &mut [f64]) {
    let columns = &shape.columns;
    let width = columns.len();
    let mut is_free = vec![true; width];
    let fixed = [(Group::Heading, !columns.heading), (Group::Held, columns.heading), (Group::Wear, !free.wear)];
    for (group, _) in fixed.into_iter().filter(|(_, is_fixed)| *is_fixed) {
        is_free[columns.range(group)].fill(false);
    }
    let of: Vec<usize> = (0..width).filter(|i| is_free[*i]).collect();
    let mut normal = vec![vec![0.0; of.len()]; of.len()];
    let mut right = vec![[0.0; 3]; of.len()];
    let (mut squares, mut count) = ([0.0; 3], 0.0);
    let (mut row, mut x) = (Vec::with_capacity(width), vec![0.0; of.len()]);
    for run in runs {
        for i in 0..run.view.steps.len() {
            let Some(moved) = run.moved(i, columns, &mut row) else { continue };
            let dt_s = run.view.steps[i].dt_s;
            for (x, column) in x.iter_mut().zip(&of) {
                *x = row[*column] * dt_s;
            }
            let left: [f64; 3] = std::array::from_fn(|axis| {
                let known = &numbers[axis * width..(axis + 1) * width];
                moved[axis] - dt_s * row.iter().zip(known).fold(0.0, |sum, (column, number)| sum + column * number)
            });
            for a in 0..of.len() {
                if x[a] == 0.0 {
                    continue;
                }
                for b in 0..=a {
                    normal[a][b] += x[a] * x[b];
                }
                for axis in 0..3 {
                    right[a][axis] += x[a] * left[axis];
                }
            }
            for axis in 0..3 {
                squares[axis] += left[axis] * left[axis];
            }
            count += 1.0;
        }
    }
    for axis in 0..3 {
        let ridge = (squares[axis] / f64::max(count, 1.0)).max(1e-12) / (PRIOR_MOTION[axis] * PRIOR_MOTION[axis]);
        let target: Vec<f64> = right.iter().map(|it| it[axis]).collect();
        let solved = solve(&normal, &target, |_| ridge);
        for (column, change) in of.iter().zip(solved) {
            numbers[axis * width + column] += change;
        }
    }
}

/// Solves the normal equations, of which the lower triangle is given, with a ridge on each unknown.
fn solve(normal: &[Vec<f64>], right: &[f64], ridge: impl Fn(usize) -> f64) -> Vec<f64> {
    let n = right.len();
    let full: Vec<Vec<f64>> = (0..n)
        .map(|a| (0..n).map(|b| normal[a.max(b)][a.min(b)] + if a == b { ridge(a) } else { 0.0 }).collect())
        .collect();
    cholesky(&full).map_or_else(|| vec![0.0; n], |l| cholesky_solve(&l, right))
}

/// Variances in one second, from what is left of the displacements in blocks.
fn motion_noise(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
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
                let known = &numbers[axis * width..(axis + 1) * width];
                sum[axis] += moved[axis]
                    - step.dt_s * row.iter().zip(known).fold(0.0, |sum, (column, number)| sum + column * number);
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
    let at = shape.range(Numbers::MotionNoise).start;
    let all_s: f64 = times_s.iter().sum();
    for class in 0..SPEEDS {
        for axis in 0..3 {
            let all: f64 = squares.iter().map(|it| it[axis]).sum();
            // A class that hardly occurs takes after the others.
            let few = 3.0 * BLOCK_S;
            let mean = if all_s > 0.0 { all / all_s } else { 1e-6 };
            let variance = (squares[class][axis] + few * mean) / (times_s[class] + few);
            numbers[at + 3 * class + axis] = ln(variance.max(1e-10));
        }
    }
}

/// Sums of the two sensors' regressions.
struct Sums {
    normal: Vec<Vec<f64>>,
    right: Vec<f64>,
}

impl Sums {
    fn new(width: usize) -> Self {
        Self { normal: vec![vec![0.0; width]; width], right: vec![0.0; width] }
    }

    fn add(&mut self, x: &[f64], y: f64, weight: f64) {
        for a in 0..x.len() {
            if x[a] == 0.0 {
                continue;
            }
            for b in 0..=a {
                self.normal[a][b] += weight * x[a] * x[b];
            }
            self.right[a] += weight * x[a] * y;
        }
    }
}

/// The sensor's curves and noise, as changes of what stands in `numbers`.
fn sensor(shape: &Shape, runs: &[Run], robust: bool, numbers: &mut [f64]) {
    let (size, bearing) = (shape.range(Numbers::Size), shape.range(Numbers::Bearing));
    let noise = [shape.range(Numbers::SizeNoise).start, shape.range(Numbers::BearingNoise).start];
    let sd = |numbers: &[f64], which: usize, band: usize| asami_math::elementary::exp(numbers[noise[which] + band]);
    let mut sums = [Sums::new(size.len()), Sums::new(bearing.len())];
    let (mut of_size, mut of_bearing, mut slopes) = (vec![0.0; size.len()], vec![0.0; bearing.len()], [0.0; 4]);
    let mut left: Vec<(usize, [f64; 2])> = Vec::new();
    let mut walk = |numbers: &[f64], sums: Option<&mut [Sums; 2]>, left: &mut Vec<(usize, [f64; 2])>| {
        let mut sums = sums;
        left.clear();
        for run in runs {
            for (i, step) in run.view.steps.iter().enumerate() {
                for seen in &run.view.seen[step.seen.clone()] {
                    let sight = run.sight(i, seen.landmark);
                    shape.size_columns(&sight, &mut of_size, &mut slopes);
                    shape.bearing_columns(&sight, &mut of_bearing);
                    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
                    let residual = [
                        seen.size - dot(&of_size, &numbers[size.clone()]),
                        wrap_rad(seen.bearing_rad - sight.bearing_rad - dot(&of_bearing, &numbers[bearing.clone()])),
                    ];
                    let band = shape.band(sight.distance_m);
                    let outlying = (0..2).any(|it| residual[it].abs() > OUTLYING * sd(numbers, it, band));
                    if robust && outlying {
                        left.push((usize::MAX, residual));
                        continue;
                    }
                    left.push((band, residual));
                    if let Some(sums) = &mut sums {
                        sums[0].add(&of_size, residual[0], 1.0);
                        sums[1].add(&of_bearing, residual[1], 1.0);
                    }
                }
            }
        }
    };
    walk(numbers, Some(&mut sums), &mut left);
    for (sums, of) in sums.iter().zip([size.clone(), bearing.clone()]) {
        // Only enough to make the equations solvable where a column never occurs.
        let ridge = |i: usize| 1e-6 * sums.normal[i][i] + 1e-9;
        let change = solve(&sums.normal, &sums.right, ridge);
        for (number, change) in numbers[of].iter_mut().zip(change) {
            *number += change;
        }
    }
    walk(numbers, None, &mut left);
    for which in 0..2 {
        let squares = |band: usize| -> (f64, f64) {
            let of = left.iter().filter(|(it, _)| *it == band);
            of.fold((0.0, 0.0), |(sum, n), (_, residual)| (sum + residual[which] * residual[which], n + 1.0))
        };
        let (all, n_all) = (0..BANDS).map(squares).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        for band in 0..BANDS {
            let (sum, n) = squares(band);
            let few = 10.0;
            let variance = (sum + few * all / f64::max(n_all, 1.0)) / (n + few);
            numbers[noise[which] + band] = 0.5 * ln(variance.max(1e-12));
        }
    }
    let outlying = left.iter().filter(|(band, _)| *band == usize::MAX).count() as f64;
    let share = (outlying / (left.len() as f64 + 1.0)).max(LEAST_FALSE);
    numbers[shape.range(Numbers::False).start] = ln(share / (1.0 - share));
}

/// How often landmarks are seen, by bin.
fn detection(shape: &Shape, runs: &[Run], numbers: &mut [f64]) {
    let of = shape.range(Numbers::Detection);
    let mut counts = vec![[0.0; 2]; of.len()];
    for run in runs.iter().filter(|run| run.view.misses) {
        for (i, step) in run.view.steps.iter().enumerate() {
            for landmark in 0..run.view.landmarks.len() {
                let sight = run.sight(i, landmark);
                let Some(bin) = shape.bin(sight.distance_m, sight.off_rad) else { continue };
                let seen = run.view.seen[step.seen.clone()].iter().any(|it| it.landmark == landmark);
                counts[bin][usize::from(seen)] += 1.0;
            }
        }
    }
    for ([missed, seen], logit) in counts.into_iter().zip(&mut numbers[of]) {
        let prior = PRIOR_SIGHTINGS / (1.0 + asami_math::elementary::exp(-*logit));
        let share = ((seen + prior) / (seen + missed + PRIOR_SIGHTINGS)).clamp(0.02, 0.98);
        *logit = ln(share / (1.0 - share));
    }
}
