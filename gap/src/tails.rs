//! How often an innovation is far off: in whitened coordinates, of variance 1 each, size and bearing together follow a Student
//! distribution. A gait is not as noisy at every step, and a Gaussian of its mean noise would have each noisier one speak for some
//! cause that makes noise.

use asami_math::elementary::{exp, ln, ln_1p};
use asami_math::optimise::golden_section;
use serde::{Deserialize, Serialize};

/// The inverse of the degrees of freedom; 0 of a Gaussian.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Tails(f64);

/// Heavier ones are not thought of: below five degrees of freedom a square's own variance is infinite, or nearly so.
const HEAVIEST: f64 = 0.2;
/// As near as the inverse is found.
const NEAR_ENOUGH: f64 = 1e-4;

impl Tails {
    /// The likeliest of innovations with these squares, each a sum over size and bearing; Gaussian where there are none.
    #[must_use]
    pub fn learn(squares: &[f64]) -> Self {
        let unlikely = |inverse: f64| squares.iter().fold(0.0, |sum, squares| sum - Self(inverse).ln_density(*squares));
        let found = golden_section(unlikely, 0.0, HEAVIEST, NEAR_ENOUGH);
        if found.x > NEAR_ENOUGH && found.value < unlikely(0.0) { Self(found.x) } else { Self::default() }
    }

    /// How likely an innovation with this square is, times `TAU`.
    #[must_use]
    pub fn density(self, squares: f64) -> f64 {
        exp(self.ln_density(squares))
    }

    /// Of `n` degrees of freedom `ln(n / (n - 2)) - (n / 2 + 1) ln(1 + q / (n - 2))` (Kotz and Nadarajah 2004, equation 1.1, with
    /// the variance made 1).
    fn ln_density(self, squares: f64) -> f64 {
        if self.0 <= 0.0 {
            return -0.5 * squares;
        }
        let (half_n, less) = (0.5 / self.0, 1.0 - 2.0 * self.0);
        -ln(less) - (half_n + 1.0) * ln_1p(squares * self.0 / less)
    }

    /// What is to be expected of minus its logarithm.
    #[must_use]
    pub fn entropy(self) -> f64 {
        // Of the logarithm that is twice the inverse: 1 + q / n is distributed as the inverse of a uniform number's 2 / n-th power.
        if self.0 > 0.0 { ln(1.0 - 2.0 * self.0) + 1.0 + 2.0 * self.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use rand::RngExt;

    use super::*;

    /// Squares of innovations, their distribution's inverse at uniform numbers.
    fn squares(tails: Tails, n: usize) -> Vec<f64> {
        let mut rng = Seed(1).stream("tails/test");
        let square = |u: f64| {
            if tails.0 > 0.0 {
                (exp(-2.0 * tails.0 * ln(u)) - 1.0) * (1.0 - 2.0 * tails.0) / tails.0
            } else {
                -2.0 * ln(u)
            }
        };
        (0..n).map(|_| square(1.0 - rng.random::<f64>())).collect()
    }

    /// Over the plane, in rings: 2 pi r dr is pi dq.
    fn integral(of: impl Fn(f64) -> f64) -> f64 {
        let h = 1e-3;
        let ring = |i: u32| {
            let u = (f64::from(i) + 0.5) * h;
            // From 0 to 1 is from nothing to beyond all.
            let q = u / (1.0 - u);
            0.5 * of(q) * h / ((1.0 - u) * (1.0 - u))
        };
        (0..1000).map(ring).sum()
    }

    #[test]
    fn all_of_them_are_distributions_of_variance_one() {
        for tails in [0.0, 0.05, 0.1, 0.15].map(Tails) {
            let (all, squares) = (integral(|q| tails.density(q)), integral(|q| q * tails.density(q)));
            let entropy = integral(|q| -tails.density(q) * tails.ln_density(q));
            assert!((all - 1.0).abs() < 1e-3, "{tails:?}: {all}");
            assert!((squares - 2.0).abs() < 0.01, "{tails:?}: {squares}");
            assert!((entropy - tails.entropy()).abs() < 5e-3, "{tails:?}: {entropy} {}", tails.entropy());
        }
    }

    /// The standard error of a sixth from 20 000 is about 0.004.
    #[test]
    fn tails_are_found_again() {
        for tails in [0.0, 0.05, 1.0 / 6.0].map(Tails) {
            let found = Tails::learn(&squares(tails, 20_000));
            assert!((found.0 - tails.0).abs() < 0.016, "{found:?} {tails:?}");
        }
        assert_eq!(Tails::learn(&[]), Tails::default());
    }
}
