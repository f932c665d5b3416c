//! How the log-likelihood depends on the noise: the filter's own derivatives by the logarithms of its variances.
//!
//! EM finds the noise of the motion slowly, since single steps are hardly seen. The forward filter is differentiated
//! instead (Gupta and Mehra 1974): with `e` and `S` an innovation and its variance,
//! `d log p = -1/2 (dS / S - dS e^2 / S^2) - e de / S`, and `1/2 dS dS / S^2 + de de / S` is the information.

use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::kalman::Gaussian;
use nalgebra::{SMatrix, SVector};

use super::filter::{Weight, noise, step};
use super::parameters::Parameters;
use super::world::{Problem, World};

/// Longest step of a logarithm.
const LONGEST: f64 = 1.0;

/// What depends on one variance.
#[derive(Clone, Copy)]
struct By<const N: usize> {
    mean: SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
}

/// First derivatives of the log-likelihood by the logarithms of variances, and the information about these: of the
/// motion, by one factor for all actions along each axis, then of size and bearing.
#[derive(Clone, Debug)]
pub struct Derivatives {
    /// First derivatives.
    pub score: Vec<f64>,
    /// Information.
    pub information: Vec<Vec<f64>>,
}

impl Derivatives {
    /// The Newton step, of logarithms, none of them longer than 1.
    #[must_use]
    pub fn newton(&self) -> Option<Vec<f64>> {
        let mut regular = self.information.clone();
        for (k, row) in regular.iter_mut().enumerate() {
            row[k] += 1e-3;
        }
        let steps = cholesky_solve(&cholesky(&regular)?, &self.score);
        let part = steps.iter().fold(1.0, |part: f64, step| part.min(LONGEST / step.abs()));
        steps.iter().all(|step| step.is_finite()).then(|| steps.iter().map(|step| part * step).collect())
    }
}

/// The derivatives, linearised about `trajectory`. `None` if the filter breaks down.
pub fn derivatives<const N: usize, const M: usize, W: World<N, M>>(
    problem: Problem<'_, W>,
    lambda: &Parameters<N>,
    trajectory: &[Gaussian<N>],
    weights: &[Weight],
) -> Option<Derivatives> {
    let Problem { world, plane } = problem;
    let mut state = lambda.prior;
    let mut by = vec![By { mean: SVector::<f64, N>::zeros(), covariance: SMatrix::<f64, N, N>::zeros() }; N + M];
    let (mut score, mut information) = (vec![0.0; N + M], vec![vec![0.0; N + M]; N + M]);
    let mut weights = weights.iter();
    for (t, about) in trajectory.iter().enumerate() {
        for seen in plane.seen(t) {
            let Some(weight) = weights.next().filter(|weight| **weight > 0.0) else { continue };
            let (e, h) = world.innovation_from(about, seen, &lambda.f);
            let r = noise::<N, M>(lambda, *weight, plane.seen(t).len());
            let before = world.difference(&state.mean, &about.mean);
            let mut moved = SVector::<f64, N>::zeros();
            for i in 0..M {
                let h_i = h.row(i).transpose();
                let p_h = state.covariance * h_i;
                let (s, e_i) = (h_i.dot(&p_h) + r[i], e[i] - h_i.dot(&(before + moved)));
                if s <= 0.0 || !s.is_finite() {
                    return None;
                }
                let gain = p_h / s;
                let mut changes = [[0.0; 2]; 8];
                for (k, by) in by.iter_mut().enumerate() {
                    let own = if k == N + i { r[i] } else { 0.0 };
                    let dp_h = by.covariance * h_i;
                    let (ds, de) = (h_i.dot(&dp_h) + own, -h_i.dot(&by.mean));
                    let d_gain = (dp_h - gain * ds) / s;
                    by.mean += d_gain * e_i + gain * de;
                    by.covariance -= d_gain * p_h.transpose() + gain * dp_h.transpose();
                    score[k] -= 0.5 * (ds / s - ds * e_i * e_i / (s * s)) + e_i * de / s;
                    changes[k] = [ds / s, de];
                }
                for (k, row) in information.iter_mut().enumerate() {
                    for (l, sum) in row.iter_mut().enumerate() {
                        *sum += 0.5 * changes[k][0] * changes[l][0] + changes[k][1] * changes[l][1] / s;
                    }
                }
                moved += gain * e_i;
                state.covariance -= gain * p_h.transpose();
            }
            state.mean += moved;
        }
        if t + 1 < trajectory.len() {
            let (mu, q) = step(plane, lambda, t);
            let motion = world.forth_from(about, &mu, &q);
            let axes = world.axes(&about.mean);
            for (k, by) in by.iter_mut().enumerate() {
                by.mean = motion.f * by.mean;
                by.covariance = motion.f * by.covariance * motion.f.transpose();
                if k < N {
                    let axis = axes.column(k);
                    by.covariance += axis * axis.transpose() * q[k];
                }
            }
            state.mean = motion.to + motion.f * world.difference(&state.mean, &about.mean);
            state.covariance = motion.f * state.covariance * motion.f.transpose() + motion.q;
        }
    }
    Some(Derivatives { score, information })
}
