//! The residuals of a log and their derivatives, on average over the points around each pose.

use asami_math::angle::wrap_rad;
use asami_math::bordered::STATE;
use asami_math::elementary::sin_cos;

use super::joint::{Estimate, Joint};
use crate::em::curve::{self, SizeCurve};
use crate::plane::Seen;
use crate::view::View;

/// A residual: on average over the points around a pose, its value, and its derivatives by some of the link's
/// unknowns.
pub(super) struct Row<'a> {
    pub(super) kind: usize,
    /// Of which sighting it is, if of one.
    pub(super) sighting: Option<usize>,
    /// How much it counts.
    pub(super) weight: f64,
    pub(super) value: f64,
    pub(super) by: &'a [Derivative],
    /// Variance of the value over the points.
    pub(super) scatter: f64,
    /// How the derivatives by the sensor's coefficients, the last of `by`, differ from their mean, at each point.
    pub(super) differences: &'a [[f64; MOST]],
}

/// A residual's derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Derivative {
    /// By which of the link's unknowns.
    pub(super) at: usize,
    /// Its mean over the points.
    pub(super) mean: f64,
    /// Its covariance with the value over the points.
    pub(super) scatter: f64,
}

impl Joint<'_> {
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
        let f = self.f(estimate);
        for (i, seen) in self.plane.seen(t).iter().enumerate() {
            let (mut size, mut bearing) = (Average::default(), Average::default());
            let mut differences = [[0.0; MOST]; 4];
            for ((column, side), by) in points.iter().zip(&mut differences) {
                let offset = spread.pose[*column];
                let w = std::array::from_fn(|k| estimate.poses[t][k] + side * offset[k]);
                *by = self.look(&f, &w, seen, [&mut size, &mut bearing]);
            }
            let (sighting, share) = (self.first_sighting[t] + i, 1.0 / points.len() as f64);
            for by in &mut differences[..points.len()] {
                for (by, sum) in by.iter_mut().zip(&size.by) {
                    *by -= share * sum;
                }
            }
            let place = |k: usize| if k < STATE { at + k } else { 2 * STATE + k };
            for (kind, average, count) in [(0, &size, STATE + f.n), (1, &bearing, STATE)] {
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
    fn look(&self, f: &SizeCurve, w: &[f64; STATE], seen: &Seen, [size, bearing]: [&mut Average; 2]) -> [f64; MOST] {
        let view = View::of(w, seen.landmark_m, self.plane.sensor_origin_m);
        let (u, (height, slope)) = (f.scaled(view.distance_m), f.at(view.distance_m));
        let (mut by, mut power) = ([0.0; MOST], 1.0);
        for by in &mut by[STATE..STATE + f.n] {
            *by = power;
            power *= u;
        }
        for (by, distance_by) in by.iter_mut().zip(view.distance_by) {
            *by = slope * distance_by;
        }
        size.add(height - seen.size, &by[..STATE + f.n]);
        bearing.add(wrap_rad(view.bearing_rad - seen.bearing_rad), &view.bearing_by);
        by
    }

    /// Inverse length of a step: a walk's variance grows with time.
    fn step_weight(&self, t: usize) -> f64 {
        self.plane.step_s / self.plane.frames[t].dt_s.max(1e-3 * self.plane.step_s)
    }
}

/// Most unknowns that a residual depends on.
const MOST: usize = STATE + curve::MOST;

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
