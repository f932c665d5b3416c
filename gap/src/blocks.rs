//! *Unknown*: five flexible blocks into which an effect that is in nobody's list would fall.
//!
//! A block is a handful of directions in which a response may change, each with a Gaussian prior. Its
//! evidence is Laplace's; the curvature is that of the scores of single frames (Berndt, Hall, Hall and
//! Hausman 1974), so that means and noise are treated alike.

use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::{exp, ln};

use crate::columns::Group;
use crate::judge::Judge;
use crate::shape::{Numbers, SPEEDS, Shape};

/// The blocks' names, in the order in which they are tried; the last is all of them together.
pub const BLOCKS: [&str; 6] = ["static_motion", "timing", "drift", "sensor", "noise", "all"];

/// A way in which a response may change: what is added to its numbers for one prior standard deviation.
pub type Direction = Vec<f64>;

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
/// Differences are taken over this share of a prior standard deviation.
const DIFFERENCE: f64 = 0.05;

/// Fits every block on top of `numbers`, to the steps for which `of` says so.
#[must_use]
pub fn fit(judge: &Judge<'_>, numbers: &[f64], of: &dyn Fn(usize) -> bool) -> Vec<Fitted> {
    let shape = &judge.library.base.shape;
    let each: Vec<Vec<Direction>> = BLOCKS[..5].iter().map(|block| directions(shape, numbers, block)).collect();
    let all = each.concat();
    let on = On { judge, numbers, directions: &all, of };
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

/// A response, the ways in which it may change, and the steps that count.
struct On<'a> {
    judge: &'a Judge<'a>,
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

    /// Log-likelihoods of the steps that count; 0 of the others.
    fn likely(&self, b: &[f64]) -> Vec<f64> {
        let all = self.judge.filtered(&self.at(b)).log_likelihoods;
        all.into_iter().enumerate().map(|(i, it)| if (self.of)(i) { it } else { 0.0 }).collect()
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
            let Some((step, ln_det)) = newton(&b[range.clone()], &of_block) else { break };
            let objective = |terms: &[f64], b: &[f64]| sum(terms) - 0.5 * b.iter().fold(0.0, |sum, b| sum + b * b);
            let here = objective(&terms, &b);
            let along = |share: f64| {
                let mut there = b.clone();
                for (b, step) in there[range.clone()].iter_mut().zip(&step) {
                    *b += share * step;
                }
                let terms = self.likely(&there);
                (objective(&terms, &there), there, terms)
            };
            // Shortened until it is no longer a step down; lengthened for as long as that helps, since logarithms of
            // noise are far from quadratic.
            let mut better = [1.0, 0.5, 0.2, 0.05].into_iter().map(along).find(|(found, _, _)| *found > here);
            for longer in [2.0, 4.0].map(along) {
                if better.as_ref().is_some_and(|(found, _, _)| longer.0 > *found) {
                    better = Some(longer);
                }
            }
            let moved = better.is_some();
            if let Some((_, there, of_there)) = better {
                (b, terms) = (there, of_there);
            }
            let found = objective(&terms, &b);
            evidence_nats = found - sum(at_zero) - 0.5 * ln_det;
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

/// A step of Newton's method, and the logarithm of the determinant of the curvature over the prior's.
fn newton(b: &[f64], scores: &[Vec<f64>]) -> Option<(Vec<f64>, f64)> {
    let p = b.len();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    let mut curvature = vec![vec![0.0; p]; p];
    for i in 0..p {
        for j in 0..=i {
            curvature[i][j] = product(&scores[i], &scores[j]) + if i == j { 1.0 } else { 0.0 };
            curvature[j][i] = curvature[i][j];
        }
    }
    let slope: Vec<f64> = (0..p).map(|i| sum(&scores[i]) - b[i]).collect();
    let l = cholesky(&curvature)?;
    let ln_determinant = 2.0 * (0..p).fold(0.0, |sum, i| sum + ln(l[i][i]));
    Some((cholesky_solve(&l, &slope), ln_determinant))
}

/// The directions of a block about a response.
#[must_use]
pub fn directions(shape: &Shape, numbers: &[f64], block: &str) -> Vec<Direction> {
    let mut made = Making { shape, numbers, made: Vec::new() };
    match block {
        "static_motion" => made.static_motion(),
        "timing" => made.timing(),
        "drift" => made.drift(),
        "sensor" => made.sensor(),
        "noise" => made.noise(),
        _ => {}
    }
    made.made
}

struct Making<'a> {
    shape: &'a Shape,
    numbers: &'a [f64],
    made: Vec<Direction>,
}

impl Making<'_> {
    fn push(&mut self, changes: impl IntoIterator<Item = (usize, f64)>) {
        let mut direction = vec![0.0; self.numbers.len()];
        for (i, change) in changes {
            direction[i] += change;
        }
        if direction.iter().any(|it| *it != 0.0) {
            self.made.push(direction);
        }
    }

    /// Indices of an axis's motion numbers of a group.
    fn motion(&self, axis: usize, group: Group) -> std::ops::Range<usize> {
        let range = self.shape.columns.range(group);
        let at = axis * self.shape.columns.len();
        at + range.start..at + range.end
    }

    /// Greatest velocity of an axis.
    fn greatest(&self, axis: usize) -> f64 {
        self.numbers[self.motion(axis, Group::Curve)].iter().fold(0.0, |most, it| f64::max(most, it.abs()))
    }

    /// Shares of each axis's own velocity and of the others', a velocity while moving, a bend, a slope.
    fn static_motion(&mut self) {
        for axis in 0..3 {
            let greatest = self.greatest(axis);
            for from in 0..3 {
                let unit = 0.15 * if self.greatest(from) > 0.0 { greatest / self.greatest(from) } else { 0.0 };
                let pairs = self.motion(axis, Group::Curve).zip(self.motion(from, Group::Curve));
                let changes: Vec<_> = pairs.map(|(i, j)| (i, unit * self.numbers[j])).collect();
                self.push(changes);
            }
            let of = self.motion(axis, Group::Curve);
            let moving: Vec<_> = of.clone().map(|i| (i, 0.05 * greatest)).collect();
            self.push(moving);
            let bend = |i: usize| 0.2 * self.numbers[i] * (self.numbers[i].abs() / greatest.max(1e-9));
            let bends: Vec<_> = of.map(|i| (i, bend(i))).collect();
            self.push(bends);
            if self.shape.columns.heading {
                for i in self.motion(axis, Group::Heading) {
                    self.push([(i, 0.05 * greatest)]);
                }
            }
        }
    }

    /// What lingers of each axis's own command, by age; and sensing that is late.
    fn timing(&mut self) {
        let ages = self.shape.columns.width(Group::Lingering) / 3;
        for age in 0..ages {
            let changes: Vec<_> = (0..3)
                .map(|axis| (self.motion(axis, Group::Lingering).start + 3 * age + axis, 0.3 * self.greatest(axis)))
                .collect();
            self.push(changes);
        }
        let bearing = self.shape.range(Numbers::Bearing).start;
        self.push([(bearing + 3, 0.05)]);
        self.push([(bearing + 4, 0.05 * self.greatest(2))]);
    }

    /// Each axis's velocity, growing with time.
    fn drift(&mut self) {
        for axis in 0..3 {
            let start = self.motion(axis, Group::Wear).start;
            self.push([(start + axis, 0.15 * self.greatest(axis))]);
            self.push([(start + 3, 0.05 * self.greatest(axis))]);
        }
    }

    /// Both curves, in units of twice their own noise.
    fn sensor(&mut self) {
        let size = self.shape.range(Numbers::Size);
        let bearing = self.shape.range(Numbers::Bearing);
        let sd = |group: Numbers| 2.0 * exp(self.numbers[self.shape.range(group).start]);
        let (of_size, of_bearing) = (sd(Numbers::SizeNoise), sd(Numbers::BearingNoise));
        let curve = self.shape.curve_width();
        let scaled: Vec<_> = (0..curve).map(|i| (size.start + i, 0.1 * self.numbers[size.start + i])).collect();
        self.push(scaled);
        for i in 0..2 {
            self.push([(size.start + i, of_size)]);
        }
        self.push([(size.start + curve, of_size / (self.shape.off_rad * self.shape.off_rad).max(1e-6))]);
        self.push([(size.start + curve + 1, of_size)]);
        let off = self.shape.off_rad.max(1e-3);
        self.push([(bearing.start, of_bearing)]);
        self.push([(bearing.start + 1, of_bearing / off)]);
        self.push([(bearing.start + 2, of_bearing / (off * off * off))]);
        self.push([(bearing.start + 5, of_bearing)]);
        for i in size.start + curve + 3..size.end {
            self.push([(i, 2.0 * of_size)]);
        }
        for i in bearing.start + 6..bearing.end {
            self.push([(i, of_bearing)]);
        }
    }

    /// Sizes of all noise, false sightings, misses.
    fn noise(&mut self) {
        let all = |group: Numbers, change: f64| {
            let range = self.shape.range(group);
            range.map(move |i| (i, change)).collect::<Vec<_>>()
        };
        let motion = self.shape.range(Numbers::MotionNoise).start;
        let made = [
            all(Numbers::SizeNoise, 0.3),
            all(Numbers::BearingNoise, 0.3),
            all(Numbers::False, 4.0),
            all(Numbers::Detection, 1.0),
        ];
        for changes in made {
            self.push(changes);
        }
        for axis in 0..3 {
            self.push((0..SPEEDS).map(|class| (motion + 3 * class + axis, 0.6)));
        }
    }
}
