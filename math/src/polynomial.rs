//! Polynomials in a centred and scaled argument.

use serde::{Deserialize, Serialize};

use crate::regression::{Regression, least_squares};

/// `1, u, u^2, ..., u^degree`.
#[must_use]
pub fn powers(u: f64, degree: usize) -> Vec<f64> {
    std::iter::successors(Some(1.0), |power| Some(power * u)).take(degree + 1).collect()
}

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

    /// The least-squares polynomial through `(x, y)` points, in powers of `(x - centre) / scale`, and
    /// the regression that holds its rank, residual and standard errors; `None` without points.
    #[must_use]
    pub fn fit(
        points: impl IntoIterator<Item = (f64, f64)>,
        degree: usize,
        centre: f64,
        scale: f64,
    ) -> Option<(Self, Regression)> {
        let rows = points.into_iter().map(|(x, y)| (powers((x - centre) / scale, degree), y));
        let regression = least_squares(degree + 1, rows);
        let coefficients = regression.solve()?.coefficients;
        Some((Self { coefficients, centre, scale }, regression))
    }

    /// The same polynomial in powers of another centre and scale.
    #[must_use]
    pub fn rebased(&self, centre: f64, scale: f64) -> Self {
        // u = p + q v with v the new argument; Horner's rule over polynomials in v.
        let (p, q) = ((centre - self.centre) / self.scale, scale / self.scale);
        let mut coefficients = vec![0.0; self.coefficients.len()];
        for c in self.coefficients.iter().rev() {
            for i in (0..coefficients.len()).rev() {
                let below = if i == 0 { *c } else { coefficients[i - 1] * q };
                coefficients[i] = coefficients[i] * p + below;
            }
        }
        Self { coefficients, centre, scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn another_basis_is_the_same_curve(
            coefficients in proptest::collection::vec(-2.0..2.0f64, 1..6),
            (c1, s1, c2, s2) in (-3.0..3.0f64, 0.5..4.0f64, -3.0..3.0f64, 0.5..4.0f64),
            x in -3.0..3.0f64,
        ) {
            let p = Polynomial { coefficients, centre: c1, scale: s1 };
            let q = p.rebased(c2, s2);
            let size = p.rebased(c2, s2).coefficients.iter().map(|c| c.abs()).sum::<f64>() + 1.0;
            let reach = powers(1.0 + q.scaled(x).abs(), p.degree()).iter().sum::<f64>();
            prop_assert!((p.at(x) - q.at(x)).abs() < 1e-12 * size * reach);
        }

        #[test]
        fn fit_recovers_a_polynomial(coefficients in proptest::collection::vec(-2.0..2.0f64, 1..6)) {
            let truth = Polynomial { coefficients, centre: 20.0, scale: 7.0 };
            let points = (0..30).map(|i| 11.0 + f64::from(i) * 0.9).map(|x| (x, truth.at(x)));
            let (fitted, _) = Polynomial::fit(points, truth.degree(), 25.0, 13.0).unwrap();
            for x in [11.0, 20.0, 37.0] {
                prop_assert!((fitted.at(x) - truth.at(x)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn slope_is_the_limit_of_differences() {
        let p = Polynomial { coefficients: vec![1.0, -2.0, 0.5, 0.3], centre: 1.0, scale: 2.0 };
        let h = 1e-5;
        assert!((p.slope_at(1.7) - (p.at(1.7 + h) - p.at(1.7 - h)) / (2.0 * h)).abs() < 1e-9);
    }
}
