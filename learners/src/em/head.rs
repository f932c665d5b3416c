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
const MOST: f64 = 0.99;

impl Frames {
    /// Counts a frame.
    pub fn add(&mut self, sightings: f64, squares: f64, square_of_sum: f64) {
        if sightings > 1.0 {
            self.frames.push([sightings, squares, square_of_sum]);
        }
    }

    /// The next share, if `bearing_var` is the variance of one bearing's error and `share` was the last: the common
    /// variance that frames' means have beyond what differences within frames account for, by weighted least squares.
    /// As it was where no frame has several bearings.
    #[must_use]
    pub fn share(&self, bearing_var: f64, share: f64) -> f64 {
        let (mut differences, mut freedom) = (0.0, 0.0);
        for [k, squares, of_sum] in &self.frames {
            differences += squares - of_sum / k;
            freedom += k - 1.0;
        }
        let own = differences / freedom;
        let (mut common, mut weights) = (0.0, 0.0);
        for [k, _, of_sum] in &self.frames {
            // The mean of k errors has the variance common + own / k.
            let var = bearing_var * (share + (1.0 - share) / k);
            let weight = 1.0 / (var * var);
            common += weight * (of_sum / (k * k) - own / k);
            weights += weight;
        }
        let next = common / weights / bearing_var;
        if next.is_finite() { next.clamp(0.0, MOST) } else { share }
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

    /// Expected sums of squares lead to the share that they were made with.
    #[test]
    fn the_share_is_found_in_its_own_sums() {
        let (bearing_var, share) = (0.02, 0.7);
        let mut frames = Frames::default();
        for k in [1.0, 2.0, 3.0, 5.0] {
            frames.add(k, k * bearing_var, k * bearing_var * (1.0 + (k - 1.0) * share));
        }
        assert!((frames.share(bearing_var, 0.2) - share).abs() < 1e-12);
    }
}
