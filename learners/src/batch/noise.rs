//! The variances of the residuals by restricted maximum likelihood: poses and parameters integrated out.
//!
//! Motion and sightings alike are rows of one linear model with a variance for each kind of row. The step is
//! Newton's with the average of observed and expected information (Johnson and Thompson 1995, "Restricted
//! maximum likelihood estimation of variance components ... using sparse matrix techniques and average
//! information").

use asami_math::bordered::Bordered;
use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::exp;

use super::joint::{KINDS, Sums};

/// A step of the logarithms of the variances.
pub(super) struct NoiseStep {
    pub(super) log_variances: [f64; KINDS],
    /// How much the logarithm of the likelihood would rise by it, if it were quadratic.
    pub(super) gain: f64,
}

/// Greatest change of a logarithm in one step, by kind.
const REACH: [f64; KINDS] = [1.0; KINDS];

/// What the rows tell of the logarithms of their variances.
#[derive(Clone, Debug, Default)]
pub(super) struct Information(Vec<Vec<f64>>);

/// The step from where `sums` were taken and `system` was factorised. `information` is mixed with that of the steps before: the
/// average of observed and expected information jumps about where residuals are few.
pub(super) fn step(sums: &Sums, system: &Bordered, information: &mut Information) -> NoiseStep {
    // Score of ln sigma_i^2: (r^T r / sigma^2 + tr(A C A^T) / sigma^2 - n) / 2.
    let score: [f64; KINDS] = std::array::from_fn(|i| 0.5 * (sums.ahead[i] + sums.leverage[i] - sums.count[i]));
    // Average information: w_i^T (I - A C A^T) w_j / 2, w_i the whitened residuals of kind i.
    let now: Vec<Vec<f64>> = (0..KINDS)
        .map(|i| {
            let own = |j: usize| if i == j { sums.squares[i] } else { 0.0 };
            (0..KINDS).map(|j| 0.5 * (own(j) - 0.5 * (system.gram(i, j) + system.gram(j, i)))).collect()
        })
        .collect();
    if information.0.is_empty() {
        information.0 = now;
    } else {
        for (before, now) in information.0.iter_mut().flatten().zip(now.into_iter().flatten()) {
            *before = 0.5 * (*before + now);
        }
    }
    let information = &information.0;
    // Never less than a part of what the rows could tell by themselves: far from the maximum the average is poor.
    let held = |damping: f64| -> Vec<Vec<f64>> {
        let mut held = information.clone();
        for (i, row) in held.iter_mut().enumerate() {
            row[i] += damping * 0.5 * sums.count[i] + 1e-6;
        }
        held
    };
    let solved = [0.0, 0.01, 0.1, 1.0].into_iter().find_map(|damping| {
        let step = cholesky_solve(&cholesky(&held(damping))?, &score);
        step.iter().all(|x| x.abs() <= 3.0).then_some(step)
    });
    let step = solved.unwrap_or_else(|| (0..KINDS).map(|i| 2.0 * score[i] / (sums.count[i] + 1.0)).collect());
    let log_variances = std::array::from_fn(|i| step[i].clamp(-REACH[i], REACH[i]));
    let gain = (0..KINDS).fold(0.0, |sum, i| sum + 0.5 * score[i] * log_variances[i]);
    NoiseStep { log_variances, gain }
}

/// Variances after a step, not below what rounding leaves of the rows.
pub(super) fn stepped(variances: &[f64; KINDS], step: &NoiseStep) -> [f64; KINDS] {
    std::array::from_fn(|i| (variances[i] * exp(step.log_variances[i])).max(LEAST_VARIANCE[i]))
}

/// (1e-4 px or m)^2, (1e-4 rad)^2, and of motion (0.05 mm)^2 and (0.05 mrad)^2 a step.
const LEAST_VARIANCE: [f64; KINDS] = [1e-8, 1e-8, 2.5e-9, 2.5e-9, 2.5e-9];
