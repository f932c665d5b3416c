//! What one head's angle is wrong by, all bearings of a frame are: they are measured from the same reading of the pan.
//!
//! Errors of the bearings of one frame have the variance `sigma_2^2` each, of which a share is common to them. The
//! common part is carried along with the state while a frame's sightings are taken in, and left behind with it.

use asami_math::elementary::ln;
use asami_math::kalman::Gaussian;
use nalgebra::{SMatrix, SVector};

/// What is known of the error that a frame's bearings have in common.
#[derive(Clone, Debug)]
pub struct Common<const N: usize> {
    mean: f64,
    var: f64,
    /// Covariance with the state.
    cross: SVector<f64, N>,
}

impl<const N: usize> Common<N> {
    /// Nothing but its variance.
    #[must_use]
    pub fn new(var: f64) -> Self {
        Self { mean: 0.0, var, cross: SVector::zeros() }
    }

    /// As [`update`](super::filter::update), of a state and this error: the last part of a sighting has it, `r` being
    /// the variances of what is each part's own.
    pub fn update<const M: usize>(
        &mut self,
        state: &mut Gaussian<N>,
        e: &SVector<f64, M>,
        h: &SMatrix<f64, M, N>,
        r: &SVector<f64, M>,
    ) -> Option<f64> {
        let before = state.mean;
        let (mut nis, mut determinant) = (0.0, 1.0);
        for i in 0..M {
            let (h_i, has) = (h.row(i).transpose(), f64::from(u8::from(i + 1 == M)));
            let p_h = state.covariance * h_i + self.cross * has;
            let own = self.cross.dot(&h_i) + self.var * has;
            let s = h_i.dot(&p_h) + has * own + r[i];
            if s <= 0.0 || !s.is_finite() {
                return None;
            }
            let e_i = e[i] - h_i.dot(&(state.mean - before)) - has * self.mean;
            state.mean += p_h / s * e_i;
            self.mean += own / s * e_i;
            state.covariance -= p_h / s * p_h.transpose();
            self.cross -= p_h / s * own;
            self.var -= own / s * own;
            nis += e_i * e_i / s;
            determinant *= s;
        }
        Some(-0.5 * (nis + ln(determinant) + M as f64 * ln(std::f64::consts::TAU)))
    }
}

/// Sums over frames of several bearings, from which their common error is told.
#[derive(Clone, Debug, Default)]
pub struct Frames {
    /// Of each: how many sightings, `E sum e^2`, `E (sum e)^2`.
    frames: Vec<[f64; 3]>,
}

/// The share that is common is never quite all: two bearings of one frame must not contradict each other.
const MOST: f64 = 0.995;

/// The share to begin with: none at all would stay so.
const START: f64 = 0.5;

/// How often the two variances are estimated from each other in one M-step.
const ROUNDS: usize = 30;

impl Frames {
    /// Counts a frame.
    pub fn add(&mut self, sightings: f64, squares: f64, square_of_sum: f64) {
        if sightings > 0.0 {
            self.frames.push([sightings, squares, square_of_sum]);
        }
    }

    /// The next variance of one bearing's error and the share of it that is common, after `bearing_var` and `share`;
    /// `weight` and `squares` are the sums over all sightings, alone in their frames or not.
    ///
    /// The common errors are missing data like the states: given `n` errors of a frame they are Gaussian with the mean
    /// `g sum e` and the variance `g own`, `g = common / (own + n common)` (Laird and Ware 1982, eq. 3.5). `None` where
    /// no frame has several bearings.
    #[must_use]
    pub fn split(&self, weight: f64, squares: f64, bearing_var: f64, share: f64) -> Option<(f64, f64)> {
        let counted = self.frames.iter().fold([0.0; 2], |sum, [n, of, _]| [sum[0] + n, sum[1] + of]);
        if self.frames.is_empty() {
            return None;
        }
        // Of those alone only the number and the sum of squares count.
        let alone = [weight - counted[0], squares - counted[1]];
        let mut common = if share > 0.0 { share } else { START } * bearing_var;
        let mut own = bearing_var - common;
        for _ in 0..ROUNDS {
            let g = common / (own + common);
            let (mut of_common, mut of_own) = (g * g * alone[1] + alone[0] * g * own, 0.0);
            let mut frames = alone[0];
            of_own += (1.0 - g) * (1.0 - g) * alone[1] + alone[0] * g * own;
            for [n, squares, of_sum] in &self.frames {
                let g = common / (own + n * common);
                let second = g * g * of_sum + g * own;
                of_common += second;
                of_own += squares - 2.0 * g * of_sum + n * second;
                frames += 1.0;
            }
            (common, own) = (of_common / frames, of_own / weight);
        }
        let var = common + own;
        let share = (common / var).clamp(0.0, MOST);
        (var.is_finite() && share.is_finite() && var > 0.0).then_some((var, share))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2x3, Matrix3, Matrix4, Matrix4x3, Vector2, Vector3, Vector4};

    use super::*;

    /// Two sightings one after the other against one of both, with the covariance of their noise written out.
    #[test]
    fn taking_sightings_in_one_by_one_is_taking_them_in_together() {
        let covariance = Matrix3::new(0.04, 0.01, 0.0, 0.01, 0.09, -0.02, 0.0, -0.02, 0.05);
        let before = Gaussian { mean: Vector3::new(0.1, -0.2, 0.3), covariance };
        let h = [Matrix2x3::new(1.0, 0.5, -0.2, 0.3, -0.7, -1.0), Matrix2x3::new(-0.4, 1.1, 0.1, 0.6, 0.2, -1.0)];
        let e = [Vector2::new(0.2, -0.1), Vector2::new(-0.3, 0.25)];
        let (size_var, bearing_var, share) = (0.5, 0.02, 0.8);

        let mut one_by_one = before;
        let mut common = Common::new(share * bearing_var);
        let own = Vector2::new(size_var, (1.0 - share) * bearing_var);
        let mut log_density = 0.0;
        for i in 0..2 {
            let moved = h[i] * (one_by_one.mean - before.mean);
            log_density += common.update(&mut one_by_one, &(e[i] - moved), &h[i], &own).unwrap();
        }

        let mut all = Matrix4x3::zeros();
        all.fixed_rows_mut::<2>(0).copy_from(&h[0]);
        all.fixed_rows_mut::<2>(2).copy_from(&h[1]);
        let e = Vector4::new(e[0][0], e[0][1], e[1][0], e[1][1]);
        let mut r = Matrix4::from_diagonal(&Vector4::new(size_var, bearing_var, size_var, bearing_var));
        (r[(1, 3)], r[(3, 1)]) = (share * bearing_var, share * bearing_var);
        let s = all * covariance * all.transpose() + r;
        let gain = covariance * all.transpose() * s.try_inverse().unwrap();
        let mean = before.mean + gain * e;
        let after = covariance - gain * all * covariance;
        let expected =
            -0.5 * (e.dot(&(s.try_inverse().unwrap() * e)) + s.determinant().ln() + 4.0 * std::f64::consts::TAU.ln());
        assert!((one_by_one.mean - mean).norm() < 1e-12);
        assert!((one_by_one.covariance - after).norm() < 1e-12);
        assert!((log_density - expected).abs() < 1e-12, "{log_density} {expected}");
    }

    /// Expected sums of squares are where the estimates stay.
    #[test]
    fn the_truth_is_found_in_its_own_sums() {
        let (bearing_var, share) = (0.02, 0.7);
        let (mut frames, mut weight) = (Frames::default(), 1.0);
        for k in [2.0, 3.0, 5.0] {
            frames.add(k, k * bearing_var, k * bearing_var * (1.0 + (k - 1.0) * share));
            weight += k;
        }
        let (mut found, squares) = ((0.05, 0.1), weight * bearing_var);
        for _ in 0..100 {
            found = frames.split(weight, squares, found.0, found.1).unwrap();
        }
        assert!((found.0 / bearing_var - 1.0).abs() < 1e-6 && (found.1 - share).abs() < 1e-6, "{found:?}");
    }
}
