//! How much the action model may bend.
//!
//! A smoothing spline's prior (Wahba 1990): the curve `A` of the scaled command has
//! `exp(-stiffness / 2 * integral of A''^2 from -1 to 1)`, straight lines are free, and the stiffness is the one
//! under which the data are most likely. That weighs what the degree of a polynomial can only switch on
//! and off, and lets the curve leave the range of commands given in a straight line.

use asami_math::decomposition::{cholesky, cholesky_solve, dot};
use asami_math::elementary::{exp, ln};
use asami_math::optimise::golden_section;

/// Least and greatest logarithm of the stiffness.
const LOG_STIFFNESS: (f64, f64) = (-5.0, 25.0);

/// `integral of A''^2 from -1 to 1` as a quadratic form of the coefficients of powers.
pub(super) fn bending(terms: usize) -> Vec<Vec<f64>> {
    let entry = |i: usize, j: usize| {
        if i < 2 || j < 2 || (i + j) % 2 == 1 {
            return 0.0;
        }
        2.0 * (i * (i - 1) * j * (j - 1)) as f64 / (i + j - 3) as f64
    };
    (0..terms).map(|i| (0..terms).map(|j| entry(i, j)).collect()).collect()
}

/// `stiffness * bending * action`.
pub(super) fn force(bending: &[Vec<f64>], stiffness: f64, action: &[f64]) -> Vec<f64> {
    bending.iter().map(|row| stiffness * dot(row, action)).collect()
}

/// What the data say of the models near a state, by a quadratic approximation, and where the action model's
/// coefficients stand in it.
pub(super) struct Evidence<'a> {
    /// Information of the data on all coefficients.
    pub(super) information: &'a [Vec<f64>],
    /// Gradient of minus the log-likelihood.
    pub(super) gradient: &'a [f64],
    pub(super) bending: &'a [Vec<f64>],
    pub(super) action: &'a [f64],
    /// Place of the first action coefficient.
    pub(super) first: usize,
}

impl Evidence<'_> {
    /// The information with the prior's added.
    pub(super) fn stiffened(&self, stiffness: f64) -> Vec<Vec<f64>> {
        let mut sum = self.information.to_vec();
        for (row, bending) in sum[self.first..].iter_mut().zip(self.bending) {
            for (x, b) in row[self.first..].iter_mut().zip(bending) {
                *x += stiffness * b;
            }
        }
        sum
    }

    /// The gradient with the prior's added.
    pub(super) fn slope(&self, stiffness: f64) -> Vec<f64> {
        let mut slope = self.gradient.to_vec();
        for (x, f) in slope[self.first..].iter_mut().zip(force(self.bending, stiffness, self.action)) {
            *x += f;
        }
        slope
    }

    /// What integrating out the bends adds to the log-density at its maximum: the logarithm of the width
    /// that the data leave them, relative to the width that the prior gives them.
    pub(super) fn volume(&self, stiffness: f64) -> f64 {
        let bends = self.first + 2..self.first + self.action.len();
        let block = |m: &[Vec<f64>]| -> Vec<Vec<f64>> {
            m[bends.clone()].iter().map(|row| row[bends.clone()].to_vec()).collect()
        };
        let log_det = |m: Vec<Vec<f64>>| {
            cholesky(&m).map_or(f64::NAN, |l| l.iter().enumerate().fold(0.0, |sum, (i, row)| sum + ln(row[i])))
        };
        if bends.is_empty() {
            return 0.0;
        }
        let prior: Vec<Vec<f64>> =
            self.bending[2..].iter().map(|row| row[2..].iter().map(|b| stiffness * b).collect()).collect();
        log_det(prior) - log_det(block(&self.stiffened(stiffness)))
    }

    /// Log-density of the data under a stiffness, all coefficients integrated out, up to a constant;
    /// minus infinity where the data leave a coefficient open.
    fn at(&self, stiffness: f64) -> f64 {
        let Some(l) = cholesky(&self.stiffened(stiffness)) else { return f64::NEG_INFINITY };
        let step: Vec<f64> = cholesky_solve(&l, &self.slope(stiffness)).iter().map(|x| -x).collect();
        let curved: Vec<f64> = self.information.iter().map(|row| dot(row, &step)).collect();
        let action: Vec<f64> = self.action.iter().zip(&step[self.first..]).map(|(a, s)| a + s).collect();
        let rank = self.action.len().saturating_sub(2) as f64;
        let log_det = l.iter().enumerate().fold(0.0, |sum, (i, row)| sum + ln(row[i]));
        -(dot(self.gradient, &step) + 0.5 * dot(&step, &curved))
            - 0.5 * dot(&action, &force(self.bending, stiffness, &action))
            + 0.5 * rank * ln(stiffness)
            - log_det
    }

    /// The most likely stiffness.
    pub(super) fn best_stiffness(&self) -> f64 {
        let minus = |x: f64| -self.at(exp(x));
        let (least, greatest) = LOG_STIFFNESS;
        let steps = (greatest - least) as u32;
        let coarse = (0..=steps).map(|i| least + f64::from(i)).fold((greatest, f64::INFINITY), |best, x| {
            let value = minus(x);
            if value < best.1 { (x, value) } else { best }
        });
        exp(golden_section(minus, coarse.0 - 1.0, coarse.0 + 1.0, 0.02).x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_math::polynomial::Polynomial;

    #[test]
    fn bending_is_the_integral() {
        let a = [0.3, -1.0, 0.7, 0.4, -0.2];
        let curve = Polynomial::plain(vec![2.0 * a[2], 6.0 * a[3], 12.0 * a[4]]);
        let n = 2000;
        let sum: f64 = (0..n).map(|i| curve.at(-1.0 + (2.0 * f64::from(i) + 1.0) / f64::from(n)).powi(2)).sum();
        assert!((dot(&a, &force(&bending(5), 1.0, &a)) - sum * 2.0 / f64::from(n)).abs() < 1e-5);
    }

    /// Data whose coefficients beyond the straight line have a known spread are given that spread back.
    #[test]
    fn stiffness_is_that_of_the_curves_drawn() {
        let bending = bending(6);
        let information: Vec<Vec<f64>> =
            (0..6).map(|i| (0..6).map(|j| if i == j { 1e6 } else { 0.0 }).collect()).collect();
        for stiffness in [0.5, 20.0] {
            // The curve of typical bend: every mode of the quadratic form one standard deviation away.
            let block: Vec<Vec<f64>> = bending[2..].iter().map(|row| row[2..].to_vec()).collect();
            let l = cholesky(&block).unwrap();
            let mut action = vec![0.1, 1.0, 0.0, 0.0, 0.0, 0.0];
            // L^T a = 1 / sqrt(stiffness) in each entry, so that the bend is 4 / stiffness.
            for i in (0..4).rev() {
                let known: f64 = (i + 1..4).map(|k| l[k][i] * action[k + 2]).sum();
                action[i + 2] = (1.0 / f64::sqrt(stiffness) - known) / l[i][i];
            }
            let evidence = Evidence {
                information: &information,
                gradient: &[0.0; 6],
                bending: &bending,
                action: &action,
                first: 0,
            };
            let found = evidence.best_stiffness();
            assert!((found / stiffness - 1.0).abs() < 0.1, "{found} for {stiffness}");
        }
    }
}
