//! How much the log says about the velocities and `f`: the information of the filter's innovations, and the
//! standard errors that follow.
//!
//! The log-likelihood is a sum over innovations (eq. 4.13), each Gaussian given those before. If `J` is the derivative of an
//! innovation's mean by the parameters and `S` its variance, the information about them is the sum of
//! `J^T S^-1 J` (Fisher's, of a linear Gaussian model; Astrom 1980). Linearised about the smoothed trajectory this is the
//! Gauss-Newton Hessian with the trajectory eliminated. The noise's variances are taken as known: their errors are
//! independent of the others' to first order.

use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::kalman::Gaussian;
use nalgebra::SVector;

use super::filter::{Weight, noise, step};
use super::parameters::{Errors, Parameters};
use super::world::{Problem, World};
use crate::plane::Plane;

/// What is known of a parameter before, as a standard deviation in m/s, rad/s or px (m): next to nothing, but
/// enough to tell "unknown" by a number.
const UNKNOWN_SD: f64 = 100.0;

/// The information about velocities (`N` for each action, in order) and then the coefficients of `f`.
pub type Information = Vec<Vec<f64>>;

/// The information, linearised about `trajectory`. `None` if the filter breaks down.
pub fn information<const N: usize, const M: usize, W: World<N, M>>(
    problem: Problem<'_, W>,
    lambda: &Parameters<N>,
    trajectory: &[Gaussian<N>],
    weights: &[Weight],
) -> Option<Information> {
    let Problem { world, plane } = problem;
    let (velocities, n) = (N * plane.actions.len(), N * plane.actions.len() + lambda.f.n);
    let mut information = vec![vec![0.0; n]; n];
    // Derivatives of the state's mean by the parameters, one column each.
    let mut by = vec![SVector::<f64, N>::zeros(); n];
    let mut state = lambda.prior;
    let mut weights = weights.iter();
    let mut j = vec![0.0; n];
    for (t, state_t) in trajectory.iter().enumerate() {
        for seen in plane.seen(t) {
            let Some(weight) = weights.next().filter(|weight| **weight > 0.0) else { continue };
            let (_, h) = world.innovation(&state_t.mean, seen, &lambda.f);
            let r = noise::<N, M>(lambda, *weight, plane.seen(t).len());
            let u = lambda.f.scaled(world.look(&state_t.mean, seen).distance_m);
            for i in 0..M {
                let h_i = h.row(i).transpose();
                let p_h = state.covariance * h_i;
                let s = h_i.dot(&p_h) + r[i];
                if s <= 0.0 || !s.is_finite() {
                    return None;
                }
                for (j, by) in j.iter_mut().zip(&by) {
                    *j = h_i.dot(by);
                }
                if i == 0 {
                    let mut power = 1.0;
                    for j in &mut j[velocities..] {
                        *j += power;
                        power *= u;
                    }
                }
                for (row, a) in j.iter().enumerate() {
                    let scaled = a / s;
                    if scaled != 0.0 {
                        for (sum, b) in information[row][..=row].iter_mut().zip(&j) {
                            *sum += scaled * b;
                        }
                    }
                }
                let gain = p_h / s;
                for (by, j) in by.iter_mut().zip(&j) {
                    *by -= gain * *j;
                }
                state.covariance -= gain * p_h.transpose();
            }
        }
        let frame = &plane.frames[t];
        let (mu, q) = step(plane, lambda, t);
        let moved = world.forth(&state_t.mean, &mu, &q);
        for by in &mut by {
            *by = moved.f * *by;
        }
        let axes = world.axes(&state_t.mean);
        for (axis, turned) in axes.column_iter().enumerate() {
            by[N * frame.action + axis] += turned * frame.dt_s;
        }
        let covariance = moved.f * state.covariance * moved.f.transpose() + moved.q;
        state = Gaussian { mean: moved.to, covariance };
    }
    let whole = |i: usize, j: usize| if i >= j { information[i][j] } else { information[j][i] };
    Some((0..n).map(|i| (0..n).map(|j| whole(i, j)).collect()).collect())
}

/// Adds the agreement that the parameters do not move along `free`.
pub fn agree(information: &mut Information, free: &[f64]) {
    let square: f64 = free.iter().map(|x| x * x).sum();
    let most = information.iter().enumerate().fold(0.0, |most: f64, (i, row)| most.max(row[i]));
    let weight = 1e3 * most / square;
    if weight.is_finite() {
        for (row, a) in information.iter_mut().zip(free) {
            for (sum, b) in row.iter_mut().zip(free) {
                *sum += weight * a * b;
            }
        }
    }
}

/// Solves `information x = score`, with what little is known before.
pub fn solve(information: &Information, score: &[f64]) -> Option<Vec<f64>> {
    let l = cholesky(&with_prior(information))?;
    let x = cholesky_solve(&l, score);
    x.iter().all(|x| x.is_finite()).then_some(x)
}

fn with_prior(information: &Information) -> Information {
    let mut sum = information.clone();
    for (i, row) in sum.iter_mut().enumerate() {
        row[i] += 1.0 / (UNKNOWN_SD * UNKNOWN_SD);
    }
    sum
}

/// The covariance of the parameters: the inverse of the information and what little is known before.
pub fn covariance(information: &Information) -> Option<Vec<Vec<f64>>> {
    let n = information.len();
    let l = cholesky(&with_prior(information))?;
    let column = |i: usize| {
        let unit: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k == i))).collect();
        cholesky_solve(&l, &unit)
    };
    Some((0..n).map(column).collect())
}

/// What stands on a covariance's diagonal.
#[must_use]
pub fn variances(covariance: &[Vec<f64>]) -> Vec<f64> {
    covariance.iter().enumerate().map(|(i, row)| row[i]).collect()
}

/// Standard errors out of the variances of velocities and then the coefficients of `f`; none for actions that were never
/// executed, unless `all`.
#[must_use]
pub fn errors<const N: usize>(plane: &Plane, variances: &[f64], all: bool) -> Errors<N> {
    let sd = |i: usize| variances[i].max(0.0).sqrt();
    let velocity = |a: usize| {
        let known = all || plane.actions[a].held_s > 0.0;
        known.then(|| SVector::from_fn(|axis, _| sd(N * a + axis)))
    };
    let actions = plane.actions.len();
    Errors { velocity: (0..actions).map(velocity).collect(), f: (N * actions..variances.len()).map(sd).collect() }
}
