//! Symmetric positive definite tridiagonal systems: the Hessian of a chain of scalar states.

use crate::elementary::ln;

/// The factorisation `T = L D L^T` of a symmetric positive definite tridiagonal matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Diagonal of `D`.
    pivots: Vec<f64>,
    /// Below the unit diagonal of `L`.
    below: Vec<f64>,
}

impl Factor {
    /// Factorises the matrix with this `diagonal` and these entries `beside` it (one fewer); `None`
    /// where it is not positive definite.
    #[must_use]
    pub fn new(diagonal: &[f64], beside: &[f64]) -> Option<Self> {
        let (mut pivots, mut below) = (Vec::with_capacity(diagonal.len()), Vec::with_capacity(beside.len()));
        let mut taken = 0.0;
        for (i, d) in diagonal.iter().enumerate() {
            let pivot = d - taken;
            if pivot <= 0.0 || !pivot.is_finite() {
                return None;
            }
            if let Some(e) = beside.get(i) {
                below.push(e / pivot);
                taken = e * e / pivot;
            }
            pivots.push(pivot);
        }
        Some(Self { pivots, below })
    }

    /// Solves `T X = B` in place; `rows` holds the rows of `B`, `width` entries each.
    pub fn solve(&self, rows: &mut [f64], width: usize) {
        let n = self.pivots.len().min(rows.len() / width.max(1));
        for i in 1..n {
            let (above, row) = rows.split_at_mut(i * width);
            for (x, a) in row[..width].iter_mut().zip(&above[(i - 1) * width..]) {
                *x -= self.below[i - 1] * a;
            }
        }
        for i in (0..n).rev() {
            let (row, after) = rows[i * width..].split_at_mut(width);
            let below = self.below.get(i).copied().unwrap_or(0.0);
            for (j, x) in row.iter_mut().enumerate() {
                *x = *x / self.pivots[i] - if i + 1 < n { below * after[j] } else { 0.0 };
            }
        }
    }

    /// Logarithm of the determinant.
    #[must_use]
    pub fn log_det(&self) -> f64 {
        self.pivots.iter().fold(0.0, |sum, pivot| sum + ln(*pivot))
    }

    /// The diagonal of the inverse: variances, if the matrix is one of information.
    #[must_use]
    pub fn inverse_diagonal(&self) -> Vec<f64> {
        let mut diagonal: Vec<f64> = self.pivots.iter().map(|pivot| 1.0 / pivot).collect();
        for i in (0..self.below.len().min(diagonal.len().saturating_sub(1))).rev() {
            diagonal[i] += self.below[i] * self.below[i] * diagonal[i + 1];
        }
        diagonal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_a_dense_inverse(beside in proptest::collection::vec(-1.0..1.0f64, 1..9), b in proptest::collection::vec(-1.0..1.0f64, 20)) {
            let n = beside.len() + 1;
            let diagonal: Vec<f64> = (0..n).map(|i| 2.1 + 0.3 * i as f64).collect();
            let dense = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => diagonal[i],
                1 => beside[i.min(j)],
                _ => 0.0,
            });
            let factor = Factor::new(&diagonal, &beside).unwrap();
            let inverse = dense.clone().try_inverse().unwrap();
            prop_assert!((factor.log_det() - dense.determinant().ln()).abs() < 1e-10);
            for (i, variance) in factor.inverse_diagonal().into_iter().enumerate() {
                prop_assert!((variance - inverse[(i, i)]).abs() < 1e-12);
            }
            let mut rows = b[..2 * n].to_vec();
            factor.solve(&mut rows, 2);
            for k in 0..2 {
                let x = &inverse * DVector::from_fn(n, |i, _| b[2 * i + k]);
                for i in 0..n {
                    prop_assert!((rows[2 * i + k] - x[i]).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn refuses_the_indefinite() {
        assert!(Factor::new(&[1.0, 1.0], &[2.0]).is_none());
        assert!(Factor::new(&[f64::NAN], &[]).is_none());
    }
}
