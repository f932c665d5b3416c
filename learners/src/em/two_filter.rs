//! The published E-step (section 4.2 of Stronger 2008): a forward and a backward filter, combined.
//!
//! Where the dissertation is silent:
//!
//! - "Starting from a mean and covariance matrix of 0 and infinity": infinity is a standard deviation of 10 m and
//!   any heading (a much greater one leaves no digits to the rest; a heading that may be any has a variance of
//!   pi^2 / 3, also after long without a sighting). As long as the backward filter is not determined,
//!   its mean is arbitrary: it starts at the forward filter's, and updates are linearised about the forward
//!   filter's; from then on about its own. Linearised about its own mean from the start, the filter is soon sure
//!   of a place that is metres off, and the learning stalls or diverges.
//! - "Approximating D as linear, we get that the expected value is `D(mu_xi)`": the linear approximation is the one
//!   about `mu_zeta` that the update itself makes. D proper at `mu_xi` is the same in the limit, but where the two
//!   filters disagree by a metre or a radian it invents steps of decimetres, and EM does not recover.
//! - The first frame's observations count as made after the prior.

use asami_math::kalman::Gaussian;
use nalgebra::{SMatrix, SVector};

use super::filter::{Forward, Weight, noise, step, update};
use super::parameters::Parameters;
use super::sums::Sums;
use super::world::{Problem, World};

/// The variance that stands for infinity.
const VAGUE_VAR: f64 = 1e2;

/// The backward filter is determined once all its variances, in m^2 and rad^2, are below this.
const KNOWN_VAR: f64 = 0.1;

/// `mu_gamma`, `Sigma_gamma` of the product of two Gaussians: eqs 4.9 and 4.10 in the form
/// `mu_a + A (A + B)^-1 (mu_b - mu_a)`, `A - A (A + B)^-1 A`.
pub fn combined<const N: usize, const M: usize, W: World<N, M>>(
    world: &W,
    a: &Gaussian<N>,
    b: &Gaussian<N>,
) -> Gaussian<N> {
    let gain = a.covariance * world.inverse(&(a.covariance + b.covariance));
    Gaussian {
        mean: a.mean + gain * world.difference(&b.mean, &a.mean),
        covariance: symmetric(a.covariance - gain * a.covariance),
    }
}

fn symmetric<const N: usize>(a: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (a + a.transpose()) * 0.5
}

/// `E D` under `xi_t`: the pair `zeta` of independent states (eq. 4.12) given that their displacement is
/// `mu + noise` of variances `q`, linearised about `mu_zeta`. With the gain `K = Sigma H^T S^-1` and
/// `S = H Sigma H^T + Sigma_m`, the displacement of the updated mean, `D + H K (mu - D)`, is
/// `mu - Sigma_m S^-1 (mu - D)`.
pub fn displaced<const N: usize, const M: usize, W: World<N, M>>(
    world: &W,
    alpha: &Gaussian<N>,
    delta: &Gaussian<N>,
    mu: &SVector<f64, N>,
    q: &SVector<f64, N>,
) -> SVector<f64, N> {
    let (d, by_now, by_next) = world.displacement(&alpha.mean, &delta.mean);
    let s = by_now * alpha.covariance * by_now.transpose()
        + by_next * delta.covariance * by_next.transpose()
        + SMatrix::from_diagonal(q);
    mu - q.component_mul(&(world.inverse(&s) * world.difference(mu, &d)))
}

/// The backward sweep: gives every `gamma_t` and `xi_t` to `sums`, last frame first. `None` if the filter
/// breaks down.
pub fn backward<const N: usize, const M: usize, W: World<N, M>>(
    problem: Problem<'_, W>,
    lambda: &Parameters<N>,
    forward: &Forward<N>,
    weights: &[Weight],
    sums: &mut Sums<'_, N>,
) -> Option<()> {
    let Problem { world, plane } = problem;
    let mean = forward.alpha.last()?.mean;
    let mut beta = Gaussian { mean, covariance: SMatrix::identity() * VAGUE_VAR };
    let mut vague = true;
    let mut end = weights.len();
    for t in (0..forward.alpha.len()).rev() {
        let alpha = &forward.alpha[t];
        if t + 1 < forward.alpha.len() {
            // beta is delta of the next frame here.
            let (mu, q) = step(plane, lambda, t);
            let d = displaced(world, alpha, &beta, &mu, &q);
            sums.displacement(plane, t, &d, &SVector::zeros());
            let moved = world.back(&beta.mean, &mu, &q);
            beta.mean = moved.to;
            beta.covariance = moved.f * beta.covariance * moved.f.transpose() + moved.q;
            world.bound(&mut beta);
        }
        let seen = plane.seen(t);
        let own = end - seen.len()..end;
        end = own.start;
        if !seen.is_empty() || t == 0 {
            let gamma = combined(world, alpha, &beta);
            sums.frame(world, t, &gamma, seen, own.clone(), &weights[own.clone()])?;
        }
        vague = vague && beta.covariance.diagonal().max() > KNOWN_VAR;
        for (seen, weight) in seen.iter().zip(&weights[own]) {
            if *weight > 0.0 {
                let at = if vague { &alpha.mean } else { &beta.mean };
                let (e, h) = world.innovation(at, seen, &lambda.f);
                let e = e - h * world.difference(&beta.mean, at);
                update(&mut beta, &e, &h, &noise(lambda, *weight, plane.seen(t).len()))?;
            }
        }
    }
    Some(())
}
