//! What drives differ in though nothing is wrong with the car: hills, and scans that say when a turn begins a little otherwise
//! in every street. Of each of the ways in which motion may be off ([`super::flexible`]), and of the clocks, nominal drives tell
//! how far it is so by chance. A log's own chance is not known beforehand: it is filtered along with what is left of the motion.

use asami_math::decomposition::dot;
use asami_math::elementary::exp;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::flexible::Flexible;
use super::memory::{ASTRAY_SCALE, Fresh, Memory};
use super::motion::Step;
use super::road::Left;

/// Rounds of expectation and maximisation.
const ROUNDS: usize = 60;
/// To begin with, drives are taken to differ by so much of what an unknown effect may do.
const AT_FIRST: f64 = 0.3;
/// Ways that a drive shows by less than this, in nats on average, are none in which drives differ.
const SHOWS_NATS: f64 = 0.1;
/// What an unknown effect may do to the clocks.
const CLOCK_S: f64 = 0.02;
/// Before anything is known of the clocks.
const ANYTHING_S: f64 = 1.0;
/// Over this the change by the clocks is taken.
pub const CLOCK_STEP_S: f64 = 0.01;
/// Scatter and differences between drives are learned so often, each knowing the other.
const ALTERNATIONS: usize = 3;

/// A way in which motion may be off: what a weight of 1 adds to what is left of speed and of turning rate, by step.
#[derive(Clone, Debug)]
pub struct Column {
    /// How far an unknown effect may be expected to go.
    unit: f64,
    values: [Vec<f64>; 2],
}

/// Ways in which drives differ: number of the column, standard deviation of its weight.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Between(Vec<(usize, f64)>);

/// A drive's columns, less what memory keeps of them: by axis and step.
#[derive(Debug)]
pub struct Rows([Vec<Vec<f64>>; 2]);

/// What is known of a drive's own weights.
pub struct Weights {
    mean: Vec<f64>,
    covariance: Vec<Vec<f64>>,
}

/// A drive, to be gone through step by step.
pub struct Course<'a> {
    /// How what is left of each axis scatters.
    pub memory: &'a [Memory; 2],
    /// Its steps.
    pub steps: &'a [Step],
    /// What is left of speeds and of turning rates, by step.
    pub left: &'a [Vec<f64>; 2],
    /// Its columns.
    pub rows: &'a Rows,
}

/// What nominal drives leave.
pub struct Nominally<'a> {
    /// Their steps.
    pub steps: &'a [Step],
    /// What is left of their motion.
    pub left: &'a [Left],
    /// Of [`columns`].
    pub columns: Vec<Column>,
}

/// All ways in which a drive may be off; the last is the clocks', by what is left were they [`CLOCK_STEP_S`] further apart.
#[must_use]
pub fn columns(flexible: &[Flexible], left: &[Left], later: &[Left]) -> Vec<Column> {
    // Of what is late the clocks' column stands for all.
    let flexible = flexible.iter().filter(|it| it.block != "timing").map(|it| {
        let mut values = [vec![0.0; left.len()], vec![0.0; left.len()]];
        values[it.axis].clone_from(&it.values);
        Column { unit: it.unit, values }
    });
    let changed = |axis: usize| left.iter().zip(later).map(|(a, b)| (b[axis] - a[axis]) / CLOCK_STEP_S).collect();
    flexible.chain([Column { unit: CLOCK_S, values: [0, 1].map(changed) }]).collect()
}

/// By how much the clocks are apart in all drives: what makes them most likely together, nothing else being off.
#[must_use]
pub fn apart_s(drives: &[Nominally<'_>]) -> f64 {
    let left: Vec<Vec<Left>> = drives.iter().map(|drive| drive.left.to_vec()).collect();
    let memory = memories(drives, &left);
    let of = |drive: &Nominally<'_>| {
        let rows = Rows::new(&memory, drive.steps, drive.columns.last().into_iter());
        let weights = Weights::after(&memory, drive, &rows, &[ANYTHING_S]);
        let information = 1.0 / weights.covariance[0][0].max(1e-12);
        [weights.mean[0] * information, information]
    };
    let sums = drives.iter().map(of).fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
    sums[0] / sums[1].max(1e-12)
}

/// How what is left of both axes scatters.
fn memories(drives: &[Nominally<'_>], left: &[Vec<Left>]) -> [Memory; 2] {
    [0, 1].map(|axis| {
        let of = |left: &Vec<Left>| left.iter().map(|it| it[axis]).collect();
        Memory::learn(&drives.iter().map(|it| it.steps).zip(left.iter().map(of)).collect::<Vec<_>>())
    })
}

/// How what is left of both axes scatters, and what drives differ in.
#[must_use]
pub fn scatter(drives: &[Nominally<'_>]) -> ([Memory; 2], Between) {
    let mut left: Vec<Vec<Left>> = drives.iter().map(|drive| drive.left.to_vec()).collect();
    let mut learned = ([Memory::default(); 2], Between::default());
    for _ in 0..ALTERNATIONS {
        let memory = memories(drives, &left);
        let rows: Vec<Rows> = drives.par_iter().map(|it| Rows::new(&memory, it.steps, it.columns.iter())).collect();
        let sd = spread(&memory, drives, &rows);
        let weights: Vec<Weights> =
            drives.par_iter().zip(&rows).map(|(drive, rows)| Weights::after(&memory, drive, rows, &sd)).collect();
        left = drives.iter().zip(&weights).map(|(drive, weights)| weights.less(drive)).collect();
        let shows = |k: usize| {
            let all: f64 =
                drives.iter().zip(&rows).map(|(drive, rows)| rows.information(&memory, drive.steps, k)).sum();
            0.5 * sd[k] * sd[k] * all / drives.len() as f64
        };
        let between = (0..sd.len()).filter(|k| shows(*k) > SHOWS_NATS).map(|k| (k, sd[k])).collect();
        learned = (memory, Between(between));
    }
    learned
}

/// Standard deviations of the columns' weights from drive to drive, by expectation and maximisation.
fn spread(memory: &[Memory; 2], drives: &[Nominally<'_>], rows: &[Rows]) -> Vec<f64> {
    let units = drives.first().map_or(&[][..], |first| &first.columns);
    let mut sd: Vec<f64> = units.iter().map(|it| AT_FIRST * it.unit).collect();
    for _ in 0..ROUNDS {
        let weights: Vec<Weights> =
            drives.par_iter().zip(rows).map(|(drive, rows)| Weights::after(memory, drive, rows, &sd)).collect();
        let square = |k: usize| weights.iter().fold(0.0, |sum, it| sum + it.mean[k] * it.mean[k] + it.covariance[k][k]);
        sd = (0..sd.len()).map(|k| (square(k) / drives.len() as f64).sqrt()).collect();
    }
    sd
}

impl Rows {
    fn new<'a>(memory: &[Memory; 2], steps: &[Step], columns: impl Iterator<Item = &'a Column> + Clone) -> Self {
        Self([0, 1].map(|axis| {
            let row = |i: usize| columns.clone().map(|it| memory[axis].new_in(steps, &it.values[axis], i)).collect();
            (0..steps.len()).map(row).collect()
        }))
    }

    /// What a drive says of the weight of a column: the inverse of its variance.
    fn information(&self, memory: &[Memory; 2], steps: &[Step], k: usize) -> f64 {
        let of_axis = |(memory, rows): (&Memory, &Vec<Vec<f64>>)| {
            rows.iter().enumerate().fold(0.0, |sum, (i, row)| sum + (row[k] / memory.spread_of(steps, i)).powi(2))
        };
        memory.iter().zip(&self.0).map(of_axis).fold(0.0, |sum, it| sum + it)
    }
}

impl Between {
    /// The rows of a log.
    #[must_use]
    pub fn rows(&self, memory: &[Memory; 2], steps: &[Step], columns: &[Column]) -> Rows {
        Rows::new(memory, steps, self.0.iter().map(|(k, _)| &columns[*k]))
    }

    /// Before anything was seen of a log.
    #[must_use]
    pub fn unknown(&self) -> Weights {
        Weights::unknown(&self.0.iter().map(|it| it.1).collect::<Vec<_>>())
    }
}

impl Weights {
    fn unknown(sd: &[f64]) -> Self {
        let row = |i: usize| (0..sd.len()).map(|j| if i == j { sd[i] * sd[i] } else { 0.0 }).collect();
        Self { mean: vec![0.0; sd.len()], covariance: (0..sd.len()).map(row).collect() }
    }

    /// After a whole drive.
    fn after(memory: &[Memory; 2], drive: &Nominally<'_>, rows: &Rows, sd: &[f64]) -> Self {
        let mut weights = Self::unknown(sd);
        let left = [0, 1].map(|axis| drive.left.iter().map(|it| it[axis]).collect());
        let course = Course { memory, steps: drive.steps, left: &left, rows };
        for i in 0..drive.steps.len() {
            for axis in 0..2 {
                weights.fresh(&course, axis, i, 0.0);
            }
        }
        weights
    }

    /// What is left of a drive without its own share of all columns.
    fn less(&self, drive: &Nominally<'_>) -> Vec<Left> {
        let off = |axis: usize, i: usize| {
            drive.columns.iter().zip(&self.mean).fold(0.0, |sum, (it, weight)| sum + weight * it.values[axis][i])
        };
        drive.left.iter().enumerate().map(|(i, left)| [left[0] - off(0, i), left[1] - off(1, i)]).collect()
    }

    /// What an axis says at step `i`, were scatter `exp(louder)` times as great; the weights are learned from it.
    pub fn fresh(&mut self, course: &Course<'_>, axis: usize, i: usize, louder: f64) -> Fresh {
        let row = &course.rows.0[axis][i];
        let gains: Vec<f64> = self.covariance.iter().map(|of| dot(of, row)).collect();
        let said = [dot(&self.mean, row), dot(&gains, row)];
        let fresh = course.memory[axis].fresh(course.steps, &course.left[axis], i, louder, said);
        let Some(fresh) = fresh else { return Fresh::default() };
        let scale = exp(fresh.ln_scale);
        // What is of something else says the less of the weights.
        let variance = scale * scale * if fresh.genuine { 1.0 } else { ASTRAY_SCALE * ASTRAY_SCALE };
        for (mean, gain) in self.mean.iter_mut().zip(&gains) {
            *mean += gain * fresh.white * scale / variance;
        }
        for (of, a) in self.covariance.iter_mut().zip(&gains) {
            of.iter_mut().zip(&gains).for_each(|(it, b)| *it -= a * b / variance);
        }
        fresh
    }
}

#[cfg(test)]
mod tests {
    use super::super::flexible;
    use super::*;
    use asami_dataset::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const NOISE: f64 = 0.02;

    fn step(i: usize) -> Step {
        let v_m_per_s = 5.0 + 3.0 * asami_math::elementary::sin(0.07 * i as f64);
        Step { t_s: 0.5 * i as f64, dt_s: 0.5, v_m_per_s, omega_rad_per_s: 0.0 }
    }

    /// Drives that are each too fast by a share of their own, 4 % of them by standard deviation.
    fn drives(n: usize, name: &str) -> Vec<Vec<Left>> {
        let mut rng = Seed(5).stream(name);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let drive = |_| {
            let share = 0.04 * normal();
            (0..120).map(|i| [share * step(i).v_m_per_s + NOISE * normal(), 1e-3 * normal()]).collect()
        };
        (0..n).map(drive).collect()
    }

    fn nominally<'a>(steps: &'a [Step], left: &'a [Left]) -> Nominally<'a> {
        Nominally { steps, left, columns: columns(&flexible::columns(steps, &[]), left, left) }
    }

    /// By step: log-likelihood, and how much less it is than expected.
    fn said(memory: &[Memory; 2], between: &Between, drive: &Nominally<'_>) -> Vec<(f64, f64)> {
        let rows = between.rows(memory, drive.steps, &drive.columns);
        let left = [0, 1].map(|axis| drive.left.iter().map(|it| it[axis]).collect());
        let course = Course { memory, steps: drive.steps, left: &left, rows: &rows };
        let mut weights = between.unknown();
        let mut of = |i: usize| {
            let fresh = weights.fresh(&course, 0, i, 0.0);
            (fresh.log_likelihood, -fresh.log_likelihood - fresh.expected)
        };
        (Memory::SILENT..drive.steps.len()).map(&mut of).collect()
    }

    #[test]
    fn what_drives_differ_in_is_learned_and_no_longer_surprises() {
        let steps: Vec<Step> = (0..120).map(step).collect();
        let (known, new) = (drives(48, "known"), drives(48, "new"));
        let learned: Vec<Nominally<'_>> = known.iter().map(|left| nominally(&steps, left)).collect();
        let (memory, between) = scatter(&learned);
        assert!((memory[0].spread_of(&steps, 0) / NOISE - 1.0).abs() < 0.1, "{memory:?}");
        let all = |between: &Between| -> Vec<(f64, f64)> {
            new.iter().flat_map(|left| said(&memory, between, &nominally(&steps, left))).collect()
        };
        let (with, without) = (all(&between), all(&Between::default()));
        let sum = |said: &[(f64, f64)]| said.iter().fold([0.0; 2], |sum, it| [sum[0] + it.0, sum[1] + it.1]);
        let ([likely, surprise], [rough, _]) = (sum(&with), sum(&without));
        assert!(likely > rough + 48.0 * 10.0, "{likely} {rough}");
        // Half a square has variance 1/2; learning the law costs something.
        let n = with.len() as f64;
        assert!((surprise / n).abs() < 4.0 * (0.5 / n).sqrt() + 0.03, "{}", surprise / n);
    }
}
