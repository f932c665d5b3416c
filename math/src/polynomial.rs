//! Polynomials in a centred and scaled argument.

use serde::{Deserialize, Serialize};

/// `p(x) = sum_i coefficients[i] * u^i` with `u = (x - centre) / scale`.
///
/// Centring and scaling keep the normal equations well conditioned; they change no fitted curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    /// Coefficients of `u^0, u^1, ...`, in the unit of the value.
    pub coefficients: Vec<f64>,
    /// Subtracted from the argument, in its unit.
    pub centre: f64,
    /// Divides the centred argument, in its unit; not zero.
    pub scale: f64,
}

impl Polynomial {
    /// A polynomial in the plain argument (`centre` 0, `scale` 1).
    #[must_use]
    pub fn plain(coefficients: Vec<f64>) -> Self {
        Self { coefficients, centre: 0.0, scale: 1.0 }
    }

    /// Degree as stored: the number of coefficients less one.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    /// The scaled argument `u`.
    #[must_use]
    pub fn scaled(&self, x: f64) -> f64 {
        (x - self.centre) / self.scale
    }

    /// Value at `x`, by Horner's rule.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        let u = self.scaled(x);
        self.coefficients.iter().rev().fold(0.0, |sum, c| sum * u + c)
    }

    /// Derivative with respect to `x` at `x`.
    #[must_use]
    pub fn slope_at(&self, x: f64) -> f64 {
        let u = self.scaled(x);
        let by_u = self.coefficients.iter().enumerate().skip(1).rev().fold(0.0, |sum, (i, c)| sum * u + i as f64 * c);
        by_u / self.scale
    }
}
