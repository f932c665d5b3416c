//! What a sighting tells of a state, and what becomes of the state if it came about in one way or another.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::state::SWAYING;
use crate::tails::Tails;

/// A sighting as it differs from what is expected, with its derivatives with respect to the state, and its noise.
pub(super) struct Odd<const N: usize> {
    /// Size and bearing.
    pub plain: Vector2<f64>,
    /// Their derivatives.
    pub h: SMatrix<f64, 2, N>,
    /// Variances of their noise.
    pub r: Matrix2<f64>,
    /// How far nominal innovations scatter.
    pub spread: [f64; 2],
    /// And how often they are far off.
    pub tails: Tails,
    /// Whether the bearing was measured.
    pub aims: bool,
}

/// What it tells of a state with some covariance.
pub(super) struct Told<const N: usize> {
    /// The whitened innovation.
    pub white: [f64; 2],
    /// And its scales.
    pub scale: [f64; 2],
    /// What is to be added to the state's mean.
    pub step: SVector<f64, N>,
    /// The covariance then.
    pub covariance: SMatrix<f64, N, N>,
    tails: Tails,
    aims: bool,
}

impl<const N: usize> Odd<N> {
    /// `None` where numbers are none.
    pub fn told(&self, covariance: &SMatrix<f64, N, N>) -> Option<Told<N>> {
        let Self { plain, h, r, spread, tails, aims } = self;
        let across = covariance * h.transpose();
        let (l, inverse) = (h * across + r).cholesky().map(|it| (it.l(), it.inverse()))?;
        let scale = [l[(0, 0)] * spread[0], l[(1, 1)] * spread[1]];
        let first = plain.x / l[(0, 0)];
        let white = [first / spread[0], (plain.y - l[(1, 0)] * first) / scale[1]];
        let gain = across * inverse;
        let covariance = if N == SWAYING {
            // Noise that sways is never next to none, so that this stays positive as well; it is most of what a sighting costs.
            let [first, second] = [0, 1].map(|k| across.column(k));
            let first = first / l[(0, 0)];
            let second = (second - l[(1, 0)] * first) / l[(1, 1)];
            covariance - first * first.transpose() - second * second.transpose()
        } else {
            self.joseph(covariance, &gain)
        };
        Some(Told { white, scale, step: gain * plain, covariance, tails: *tails, aims: *aims })
    }

    /// Joseph's form keeps the covariance symmetric and positive, however little noise there is.
    fn joseph(&self, covariance: &SMatrix<f64, N, N>, gain: &SMatrix<f64, N, 2>) -> SMatrix<f64, N, N> {
        let kept = SMatrix::<f64, N, N>::identity() - gain * self.h;
        kept * covariance * kept.transpose() + gain * self.r * gain.transpose()
    }
}

impl<const N: usize> Told<N> {
    /// The square of how far off the sighting is, in standard deviations.
    pub fn squares(&self) -> f64 {
        let [size, bearing] = self.white;
        if self.aims { size * size + bearing * bearing } else { size * size }
    }

    /// How likely it is, so many times.
    pub fn likely(&self, times: f64) -> f64 {
        let [size, bearing] = self.scale;
        let scales = if self.aims { TAU * size * bearing } else { TAU.sqrt() * size };
        times * self.tails.density(self.squares()) / scales
    }

    /// The state if it is so.
    pub fn part(&self, likely: f64) -> Part<N> {
        Part { likely, step: self.step, covariance: self.covariance }
    }
}

/// One of the ways in which a sighting may have come about.
pub(super) struct Part<const N: usize> {
    /// How likely.
    pub likely: f64,
    /// What is added to the state's mean.
    pub step: SVector<f64, N>,
    /// The covariance.
    pub covariance: SMatrix<f64, N, N>,
}

impl<const N: usize> Part<N> {
    /// A single Gaussian in place of this and another, with the mean and the covariance of both together.
    pub fn or(self, other: Self) -> Self {
        let likely = self.likely + other.likely;
        let share = if likely > 0.0 { self.likely / likely } else { 1.0 };
        let apart = self.step - other.step;
        Self {
            likely,
            step: other.step + share * apart,
            covariance: share * self.covariance
                + (1.0 - share) * other.covariance
                + (share * (1.0 - share)) * apart * apart.transpose(),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix1, Vector1};

    use super::*;

    fn part(likely: f64, step: f64, var: f64) -> Part<1> {
        Part { likely, step: Vector1::new(step), covariance: Matrix1::new(var) }
    }

    /// Three ways, two by two: the mean, and the mean of squares, are those of all of them, in whatever order.
    #[test]
    fn ways_have_their_mean_and_covariance_in_common() {
        let ways = [(0.2, 1.0, 0.5), (0.5, -2.0, 0.1), (0.1, 4.0, 3.0)];
        let sum = |of: fn(f64, f64) -> f64| ways.iter().map(|(p, step, var)| p * of(*step, *var)).sum::<f64>() / 0.8;
        let (mean, squares) = (sum(|step, _| step), sum(|step, var| step * step + var));
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let [a, b, c] = order.map(|i| part(ways[i].0, ways[i].1, ways[i].2));
            let all = a.or(b).or(c);
            assert!((all.likely - 0.8).abs() < 1e-12 && (all.step[0] - mean).abs() < 1e-12);
            assert!((all.covariance[(0, 0)] - (squares - mean * mean)).abs() < 1e-12);
        }
    }

    /// A covariance of so many numbers.
    fn some<const N: usize>() -> SMatrix<f64, N, N> {
        let root = SMatrix::<f64, N, N>::from_fn(|i, j| ((3 * i + 5 * j * j) as f64).sin());
        root * root.transpose() + SMatrix::identity()
    }

    #[test]
    fn where_it_sways_the_covariance_is_that_of_josephs_form() {
        let covariance = some::<SWAYING>();
        let odd = Odd {
            plain: Vector2::new(0.3, -0.2),
            h: SMatrix::<f64, 2, SWAYING>::from_fn(|i, j| ((7 * i + 2 * j) as f64).cos()),
            r: Matrix2::new(0.4, 0.0, 0.0, 0.1),
            spread: [1.0; 2],
            tails: Tails::default(),
            aims: true,
        };
        let across = covariance * odd.h.transpose();
        let gain = across * (odd.h * across + odd.r).try_inverse().unwrap();
        let told = odd.told(&covariance).unwrap();
        assert!((told.covariance - odd.joseph(&covariance, &gain)).norm() < 1e-12, "{}", told.covariance);
        assert!((told.step - gain * odd.plain).norm() < 1e-12);
        assert_eq!(told.covariance, told.covariance.transpose());
    }

    #[test]
    fn what_cannot_be_changes_nothing() {
        let all = part(0.0, 5.0, 1.0).or(part(0.0, 7.0, 1.0)).or(part(0.3, 0.0, 2.0));
        assert_eq!((all.likely, all.step[0], all.covariance[(0, 0)]), (0.3, 0.0, 2.0));
    }
}
