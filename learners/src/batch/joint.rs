//! All poses and all models at once: residuals, their derivatives, and the bordered normal equations.
//!
//! Expectations over what is still unknown of the poses are taken at a few points around each pose, spread
//! as the last inverse said (Barfoot, Forbes and Yoon 2020, "Exactly sparse Gaussian variational inference"):
//! the sine of an uncertain heading is on average shorter than the sine of the mean heading.

use asami_math::angle::wrap_rad;
use asami_math::bordered::{Bordered, Link, STATE, Segment};
use asami_math::elementary::sin_cos;
use asami_math::polynomial::Polynomial;

use super::spread::{Spread, between, given_parameters};
use crate::plane::{Plane, Seen};
use crate::view::View;

/// Kinds of residuals: size, bearing, motion rightward, forward, turn. Each has a variance of its own.
pub(super) const KINDS: usize = 5;
/// Column of the right-hand sides for what no kind accounts for: scatter over the points, and priors.
const OTHER: usize = KINDS;
/// How vaguely the start of the trajectory is known beforehand, in m and rad.
const START_SD: [f64; STATE] = [100.0, 100.0, 100.0];

/// Everything that is estimated.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    /// `w_t` of each frame; headings are not wrapped.
    pub(super) poses: Vec<[f64; STATE]>,
    /// Velocity of each action, then the sensor's coefficients.
    pub(super) parameters: Vec<f64>,
    /// Variances by kind; those of motion are of a step of median length.
    pub(super) variances: [f64; KINDS],
}

/// A residual: on average over the points around a pose, its value, and its derivatives by some of the link's
/// unknowns.
pub(super) struct Row<'a> {
    pub(super) kind: usize,
    /// Of which sighting it is, if of one.
    sighting: Option<usize>,
    /// How much it counts.
    pub(super) weight: f64,
    value: f64,
    pub(super) by: &'a [Derivative],
    /// Variance of the value over the points.
    scatter: f64,
    /// How the derivatives by the sensor's coefficients, the last of `by`, differ from their mean, at each point.
    differences: &'a [[f64; MOST]],
}

/// A residual's derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Derivative {
    /// By which of the link's unknowns.
    pub(super) at: usize,
    /// Its mean over the points.
    pub(super) mean: f64,
    /// Its covariance with the value over the points.
    scatter: f64,
}

/// A change of an estimate.
pub(super) struct Change {
    pub(super) poses: Vec<[f64; STATE]>,
    pub(super) parameters: Vec<f64>,
}

/// What is added to the information so that a step does not go too far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    /// On poses, 1/m^2 and 1/rad^2.
    pub(super) poses: f64,
    /// Whether the sensor's coefficients are held by the scatter of distances over the points: part of the cost's
    /// curvature, though not of what the sightings tell of the sensor.
    pub(super) sensor: bool,
}

/// The log as the joint estimate sees it.
pub(super) struct Joint<'a> {
    pub(super) plane: &'a Plane,
    /// The sensor's polynomial is in powers of `(distance - centre) / scale`.
    pub(super) centre_m: f64,
    pub(super) scale_m: f64,
    pub(super) coefficients: usize,
    /// Index of the first sighting of each frame.
    first_sighting: Vec<usize>,
    pub(super) spreads: Vec<Spread>,
    /// How much each sighting counts: the chance that it is of what it says.
    pub(super) weights: Vec<f64>,
    /// Information and mean of the parameters beforehand.
    pub(super) prior: Vec<[f64; 2]>,
}

impl<'a> Joint<'a> {
    pub(super) fn new(plane: &'a Plane, centre_m: f64, scale_m: f64, prior: Vec<[f64; 2]>) -> Self {
        let mut first_sighting = vec![0];
        for t in 0..plane.frames.len() {
            first_sighting.push(first_sighting[t] + plane.seen(t).len());
        }
        Self {
            centre_m,
            scale_m,
            coefficients: prior.len().saturating_sub(STATE * plane.actions.len()),
            first_sighting,
            spreads: vec![Spread::default(); plane.frames.len()],
            weights: vec![1.0; plane.sightings.len()],
            prior,
            plane,
        }
    }

    /// The form of the normal equations: a segment for each stretch of one action.
    pub(super) fn system(&self) -> Option<Bordered> {
        let links = self.plane.frames.len().checked_sub(1)?;
        let mut segments: Vec<Segment> = Vec::new();
        let sensor = STATE * self.plane.actions.len();
        for t in 0..links {
            let action = self.plane.frames[t].action;
            match segments.last_mut() {
                Some(last) if last.parameters[0] == STATE * action => last.last = t + 1,
                _ => {
                    let velocity = STATE * action..STATE * (action + 1);
                    let parameters = velocity.chain(sensor..sensor + self.coefficients).collect();
                    segments.push(Segment { first: t, last: t + 1, parameters });
                }
            }
        }
        Bordered::new(segments, self.prior.len(), KINDS + 1)
    }

    pub(super) fn sensor(&self, estimate: &Estimate) -> Polynomial {
        let coefficients = estimate.parameters[STATE * self.plane.actions.len()..].to_vec();
        Polynomial { coefficients, centre: self.centre_m, scale: self.scale_m }
    }

    /// Information and right-hand side of the prior at an estimate.
    pub(super) fn pull(&self, estimate: &Estimate) -> Vec<[f64; 2]> {
        let pull = |([information, mean], value): (&[f64; 2], &f64)| [*information, information * (mean - value)];
        self.prior.iter().zip(&estimate.parameters).map(pull).collect()
    }

    /// Adds what link `t` brings: motion from frame `t` to the next, and what was seen in frame `t` (and in
    /// the last frame, for the last link).
    pub(super) fn fill(&self, estimate: &Estimate, hold: Hold, t: usize, link: &mut Link) {
        self.rows(estimate, t, &mut |row| {
            let information = row.weight / estimate.variances[row.kind];
            for i in row.by {
                let scaled = information * i.mean;
                for j in row.by {
                    *link.at_mut(i.at, j.at) += scaled * j.mean;
                }
                *link.side_mut(i.at, row.kind) -= scaled * row.value;
                *link.side_mut(i.at, OTHER) -= information * i.scatter;
            }
            if hold.sensor {
                for by in row.differences {
                    let sensor = row.by.iter().zip(by).skip(STATE);
                    for (i, by_i) in sensor.clone() {
                        let scaled = information * by_i / row.differences.len() as f64;
                        for (j, by_j) in sensor.clone() {
                            *link.at_mut(i.at, j.at) += scaled * by_j;
                        }
                    }
                }
            }
        });
        if t == 0 {
            for (i, sd) in START_SD.iter().enumerate() {
                *link.at_mut(i, i) += 1.0 / (sd * sd);
            }
        }
        for i in 0..2 * STATE {
            *link.at_mut(i, i) += hold.poses;
        }
    }

    /// What an estimate leaves unexplained.
    pub(super) fn misfit(&self, estimate: &Estimate) -> Misfit {
        let prior = self.prior.iter().zip(&estimate.parameters);
        let prior = prior.fold(0.0, |sum, ([information, mean], x)| sum + information * (x - mean) * (x - mean));
        let mut misfit = Misfit { squares: [0.0; KINDS], cost: prior };
        for t in 0..self.plane.frames.len().saturating_sub(1) {
            self.rows(estimate, t, &mut |row| {
                let information = row.weight / estimate.variances[row.kind];
                misfit.squares[row.kind] += information * row.value * row.value;
                misfit.cost += information * (row.value * row.value + row.scatter);
            });
        }
        misfit
    }

    /// Visits every residual of link `t`.
    pub(super) fn rows(&self, estimate: &Estimate, t: usize, visit: &mut impl FnMut(&Row)) {
        self.motion_rows(estimate, t, visit);
        self.sighting_rows(estimate, t, 0, visit);
        if t + 2 == self.plane.frames.len() {
            self.sighting_rows(estimate, t + 1, STATE, visit);
        }
    }

    /// `D(w_t, w_(t+1)) - A(c_t) dt` (Stronger 2008, section 4.2), in the robot's frame.
    fn motion_rows(&self, estimate: &Estimate, t: usize, visit: &mut impl FnMut(&Row)) {
        let frame = &self.plane.frames[t];
        let (w, next) = (&estimate.poses[t], &estimate.poses[t + 1]);
        let velocity = &estimate.parameters[STATE * frame.action..STATE * (frame.action + 1)];
        let (dt_s, spread, weight) = (frame.dt_s, &self.spreads[t], self.step_weight(t));
        let at = |side: f64| {
            let (sin, cos) = sin_cos(w[2] + side * spread.heading);
            let dx = next[0] - w[0] + side * spread.displacement[0];
            let dy = next[1] - w[1] + side * spread.displacement[1];
            (sin, cos, [cos * dx + sin * dy, cos * dy - sin * dx])
        };
        let ((sin_a, cos_a, d_a), (sin_b, cos_b, d_b)) = (at(-1.0), at(1.0));
        let by_x = [[-cos_a, -cos_b], [sin_a, sin_b]];
        let by_y = [[-sin_a, -sin_b], [-cos_a, -cos_b]];
        let by_heading = [[d_a[1], d_b[1]], [-d_a[0], -d_b[0]]];
        for i in 0..2 {
            let half = 0.5 * (d_b[i] - d_a[i]);
            let of = |at: usize, [a, b]: [f64; 2], sign: f64| Derivative {
                at,
                mean: sign * 0.5 * (a + b),
                scatter: sign * 0.5 * (b - a) * half,
            };
            visit(&Row {
                kind: 2 + i,
                sighting: None,
                weight,
                value: 0.5 * (d_a[i] + d_b[i]) - velocity[i] * dt_s,
                by: &[
                    of(0, by_x[i], 1.0),
                    of(1, by_y[i], 1.0),
                    of(2, by_heading[i], 1.0),
                    of(3, by_x[i], -1.0),
                    of(4, by_y[i], -1.0),
                    Derivative { at: 2 * STATE + i, mean: -dt_s, scatter: 0.0 },
                ],
                scatter: half * half,
                differences: &[],
            });
        }
        let of = |at: usize, mean: f64| Derivative { at, mean, scatter: 0.0 };
        let by = &[of(2, -1.0), of(5, 1.0), of(8, -dt_s)];
        let value = wrap_rad(next[2] - w[2] - velocity[2] * dt_s);
        visit(&Row { kind: 4, sighting: None, weight, value, by, scatter: 0.0, differences: &[] });
    }

    /// `f(dist(w_t)) - o_1` and `ang(w_t) - o_2` (eq. 2.29), of frame `t`, whose pose begins at `at` in the link.
    fn sighting_rows(&self, estimate: &Estimate, t: usize, at: usize, visit: &mut impl FnMut(&Row)) {
        let spread = &self.spreads[t];
        let root_2 = std::f64::consts::SQRT_2;
        let points = [(0, root_2), (0, -root_2), (1, root_2), (1, -root_2)];
        let points = &points[..if spread.heading > 0.0 { points.len() } else { 1 }];
        for (i, seen) in self.plane.seen(t).iter().enumerate() {
            let (mut size, mut bearing) = (Average::default(), Average::default());
            let mut differences = [[0.0; MOST]; 4];
            for ((column, side), by) in points.iter().zip(&mut differences) {
                let offset = spread.pose[*column];
                let w = std::array::from_fn(|k| estimate.poses[t][k] + side * offset[k]);
                *by = self.look(estimate, &w, seen, [&mut size, &mut bearing]);
            }
            let (sighting, share) = (self.first_sighting[t] + i, 1.0 / points.len() as f64);
            for by in &mut differences[..points.len()] {
                for (by, sum) in by.iter_mut().zip(&size.by) {
                    *by -= share * sum;
                }
            }
            let place = |k: usize| if k < STATE { at + k } else { 2 * STATE + k };
            for (kind, average, count) in [(0, &size, STATE + self.coefficients), (1, &bearing, STATE)] {
                let value = share * average.value;
                let mut by = [Derivative::default(); MOST];
                for (k, by) in by.iter_mut().enumerate().take(count) {
                    let mean = share * average.by[k];
                    *by = Derivative { at: place(k), mean, scatter: share * average.value_by[k] - value * mean };
                }
                let (weight, scatter) = (self.weights[sighting], share * average.square - value * value);
                let differences = if kind == 0 && points.len() > 1 { &differences[..] } else { &[] };
                visit(&Row { kind, sighting: Some(sighting), weight, value, by: &by[..count], scatter, differences });
            }
        }
    }

    /// Adds both residuals of a sighting from one pose, and their derivatives by it and by the sensor; those of the
    /// size are the answer.
    fn look(
        &self,
        estimate: &Estimate,
        w: &[f64; STATE],
        seen: &Seen,
        [size, bearing]: [&mut Average; 2],
    ) -> [f64; MOST] {
        let view = View::of(w, seen.landmark_m, self.plane.sensor_origin_m);
        let u = (view.distance_m - self.centre_m) / self.scale_m;
        let coefficients = &estimate.parameters[STATE * self.plane.actions.len()..];
        let mut by = [0.0; MOST];
        let (mut height, mut slope, mut power) = (0.0, 0.0, 1.0);
        for (k, c) in coefficients.iter().enumerate() {
            by[STATE + k] = power;
            slope += if k > 0 { k as f64 * c * by[STATE + k - 1] } else { 0.0 };
            height += c * power;
            power *= u;
        }
        for (by, distance_by) in by.iter_mut().zip(view.distance_by) {
            *by = slope / self.scale_m * distance_by;
        }
        size.add(height - seen.size, &by[..STATE + coefficients.len()]);
        bearing.add(wrap_rad(view.bearing_rad - seen.bearing_rad), &view.bearing_by);
        by
    }

    /// Sums over all residuals that the noise is told from; and what the inverse says is unknown of each pose.
    pub(super) fn sums(&self, estimate: &Estimate, system: &Bordered, change: &Change) -> (Sums, Vec<Spread>) {
        let mut sums = Sums {
            squares: [0.0; KINDS],
            ahead: [0.0; KINDS],
            leverage: [0.0; KINDS],
            count: [0.0; KINDS],
            sightings: vec![[0.0; 2]; self.weights.len()],
        };
        let mut spreads = vec![Spread::default(); self.spreads.len()];
        let mut own = Link { rows: 2 * STATE, width: 2 * STATE, entries: vec![0.0; 4 * STATE * STATE] };
        let mut left = Vec::new();
        system.visit_inverse(|t, covariance| {
            self.rows(estimate, t, &mut |row| {
                let (mut leverage, mut ahead) = (0.0, row.value);
                for i in row.by {
                    ahead += i.mean * self.change_at(change, t, i.at);
                    leverage += i.mean * row.by.iter().fold(0.0, |sum, j| sum + covariance.at(i.at, j.at) * j.mean);
                }
                let per_variance = 1.0 / estimate.variances[row.kind];
                sums.squares[row.kind] += row.weight * per_variance * row.value * row.value;
                sums.ahead[row.kind] += row.weight * per_variance * ahead * ahead;
                sums.leverage[row.kind] += row.weight * per_variance * leverage;
                // Motion counts once, however long it took.
                sums.count[row.kind] += if row.sighting.is_some() { row.weight } else { 1.0 };
                if let Some(sighting) = row.sighting {
                    sums.sightings[sighting][row.kind] = per_variance * (ahead * ahead + leverage);
                }
            });
            given_parameters(covariance, &mut left, &mut own);
            spreads[t] = Spread::of(&own);
        });
        if let [.., before, last] = spreads.as_mut_slice() {
            *last = Spread { displacement: [0.0; 2], ..*before };
        }
        (sums, spreads)
    }

    /// Moves the points half-way to where `spreads` has them: all the way, estimate and spread would chase each other.
    pub(super) fn spread_towards(&mut self, spreads: &[Spread]) {
        for (mine, other) in self.spreads.iter_mut().zip(spreads) {
            *mine = if mine.heading > 0.0 { between(mine, other) } else { *other };
        }
    }

    /// Inverse length of a step: a walk's variance grows with time.
    fn step_weight(&self, t: usize) -> f64 {
        self.plane.step_s / self.plane.frames[t].dt_s.max(1e-3 * self.plane.step_s)
    }

    /// Change of one of the unknowns of link `t`.
    fn change_at(&self, change: &Change, t: usize, at: usize) -> f64 {
        match at {
            0..STATE => change.poses[t][at],
            _ if at < 2 * STATE => change.poses[t + 1][at - STATE],
            _ if at < 3 * STATE => change.parameters[STATE * self.plane.frames[t].action + at - 2 * STATE],
            _ => change.parameters[STATE * self.plane.actions.len() + at - 3 * STATE],
        }
    }

    /// The estimate moved by a part of a change.
    pub(super) fn moved(estimate: &Estimate, change: &Change, part: f64) -> Estimate {
        let mut next = estimate.clone();
        for (w, step) in next.poses.iter_mut().flatten().zip(change.poses.iter().flatten()) {
            *w += part * step;
        }
        for (x, step) in next.parameters.iter_mut().zip(&change.parameters) {
            *x += part * step;
        }
        next
    }
}

/// Most unknowns that a residual depends on.
const MOST: usize = STATE + 10;

/// Sums over the points around a pose.
#[derive(Default)]
struct Average {
    value: f64,
    square: f64,
    by: [f64; MOST],
    value_by: [f64; MOST],
}

impl Average {
    fn add(&mut self, value: f64, by: &[f64]) {
        self.value += value;
        self.square += value * value;
        for (k, by) in by.iter().enumerate() {
            self.by[k] += by;
            self.value_by[k] += value * by;
        }
    }
}

/// What an estimate leaves unexplained.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    /// Squares of the residuals by their variances, by kind.
    pub(super) squares: [f64; KINDS],
    /// All of them on average over the points, and the prior's: what is to be made small.
    pub(super) cost: f64,
}

/// Sums over residuals, each divided by its variance, by kind.
pub(super) struct Sums {
    pub(super) squares: [f64; KINDS],
    /// The squares where the change leads that the system was solved for.
    pub(super) ahead: [f64; KINDS],
    /// What is unknown of the residuals themselves.
    pub(super) leverage: [f64; KINDS],
    pub(super) count: [f64; KINDS],
    /// Of each sighting: expected squares of its two residuals.
    pub(super) sightings: Vec<[f64; 2]>,
}
