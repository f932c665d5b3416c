//! The forward sweep: an extended Kalman filter, or one that is linearised about a given trajectory.

use asami_math::elementary::ln;
use asami_math::kalman::Gaussian;
use nalgebra::{SMatrix, SVector};

use super::head::Common;
use super::parameters::Parameters;
use super::world::{Moved, Problem, World};
use crate::plane::Plane;

/// What the forward sweep leaves behind; its room is used again.
#[derive(Clone, Debug)]
pub struct Forward<const N: usize> {
    /// `alpha_t`: the state given the observations up to frame `t`, that of `t` included.
    pub alpha: Vec<Gaussian<N>>,
    /// The motion from frame `t` to the next, linearised.
    pub moved: Vec<Moved<N>>,
    /// Covariance of the state before the observations of frame `t`.
    pub predicted: Vec<Gaussian<N>>,
    /// Log-likelihood (eq. 4.13), nats.
    pub log_likelihood: f64,
}

/// What motion and observations are linearised about.
#[derive(Clone, Copy, Debug)]
pub enum About<'a, const N: usize> {
    /// The filter's own means, as in an extended Kalman filter.
    Own,
    /// The means of given states.
    Means(&'a [Gaussian<N>]),
    /// Given states as they are: linear functions that fit best on average over them.
    States(&'a [Gaussian<N>]),
}

impl<const N: usize> About<'_, N> {
    /// The mean to linearise about in frame `t`.
    #[must_use]
    pub fn mean(&self, t: usize, own: &SVector<f64, N>) -> SVector<f64, N> {
        match self {
            About::Own => *own,
            About::Means(states) | About::States(states) => states[t].mean,
        }
    }
}

/// How far a sighting is trusted: its noise is divided by this; 0 leaves it out.
pub type Weight = f64;

/// The outlier gate of section 4.4.1: a sighting is discarded whose bearing innovation is beyond
/// `0.6 k` radians, `k` the frames since the last with a sighting.
pub const GATE_RAD: f64 = 0.6;

impl<const N: usize> Forward<N> {
    /// Room for a log.
    #[must_use]
    pub fn new(frames: usize) -> Self {
        let zero = Gaussian { mean: SVector::zeros(), covariance: SMatrix::zeros() };
        let still = Moved { to: SVector::zeros(), f: SMatrix::identity(), q: SMatrix::zeros() };
        Self {
            alpha: vec![zero; frames],
            moved: vec![still; frames],
            predicted: vec![zero; frames],
            log_likelihood: 0.0,
        }
    }

    /// Runs over the first `frames` of the log. With `gate`, sightings beyond it get weight 0. `None` if the filter
    /// breaks down.
    pub fn run<const M: usize, W: World<N, M>>(
        &mut self,
        problem: Problem<'_, W>,
        lambda: &Parameters<N>,
        about: About<'_, N>,
        weights: &mut [Weight],
        gate: bool,
    ) -> Option<()> {
        let Problem { world, plane } = problem;
        let mut state = lambda.prior;
        let mut first = 0;
        self.log_likelihood = 0.0;
        for t in 0..self.alpha.len() {
            self.predicted[t] = state;
            let seen = plane.seen(t);
            let own = &mut weights[first..first + seen.len()];
            first += seen.len();
            let several = M > 1 && lambda.common_share > 0.0 && seen.len() > 1;
            let mut common = several.then(|| Common::new(lambda.common_share * lambda.bearing_var));
            for (seen, weight) in seen.iter().zip(own) {
                let at = about.mean(t, &state.mean);
                let (e, h) = match about {
                    About::States(states) => world.innovation_from(&states[t], seen, &lambda.f),
                    _ => world.innovation(&at, seen, &lambda.f),
                };
                if gate
                    && M > 1
                    && (e[M - 1] - (h * world.difference(&state.mean, &at))[M - 1]).abs()
                        > GATE_RAD * f64::from(plane.frames[t].since_seen)
                {
                    *weight = 0.0;
                }
                if *weight > 0.0 {
                    let e = e - h * world.difference(&state.mean, &at);
                    let log_density = match &mut common {
                        None => update(&mut state, &e, &h, &noise(lambda, *weight, 1))?,
                        Some(common) => {
                            let mut own: SVector<f64, M> = noise(lambda, *weight, 1);
                            own[M - 1] *= 1.0 - lambda.common_share;
                            common.update(&mut state, &e, &h, &own)?
                        }
                    };
                    self.log_likelihood += lambda.mixed(log_density);
                }
            }
            self.alpha[t] = state;
            if t + 1 < self.alpha.len() {
                let at = about.mean(t, &state.mean);
                let (mu, q) = step(plane, lambda, t);
                let moved = match about {
                    About::States(states) => world.forth_from(&states[t], &mu, &q),
                    _ => world.forth(&at, &mu, &q),
                };
                let off = world.difference(&state.mean, &at);
                state.mean = moved.to + moved.f * off;
                state.covariance = moved.f * state.covariance * moved.f.transpose() + moved.q;
                if matches!(about, About::Own) {
                    world.bound(&mut state);
                }
                self.moved[t] = moved;
            }
            if !state.mean.iter().all(|x| x.is_finite()) {
                return None;
            }
        }
        self.log_likelihood.is_finite().then_some(())
    }
}

/// `mu = A(c) dt` and the noise's variances of the step from frame `t` to the next.
pub fn step<const N: usize>(plane: &Plane, lambda: &Parameters<N>, t: usize) -> (SVector<f64, N>, SVector<f64, N>) {
    let frame = &plane.frames[t];
    let (v, q) = (&lambda.velocity[frame.action], &lambda.motion_var[frame.action]);
    (v * frame.dt_s, q * (frame.dt_s / plane.step_s))
}

/// The noise of one of so many sightings `together` in a frame: of the size and, where it is observed, of the bearing;
/// as if bearings had nothing in common, but such that together they tell as much as they do.
pub fn noise<const N: usize, const M: usize>(
    lambda: &Parameters<N>,
    weight: Weight,
    together: usize,
) -> SVector<f64, M> {
    let more = 1.0 + together.saturating_sub(1) as f64 * lambda.common_share;
    SVector::from_fn(|i, _| if i == 0 { lambda.size_var } else { lambda.bearing_var * more } / weight)
}

/// The state given one sighting with innovation `e`, and the sighting's log-density: eqs 2.17 to 2.19 of
/// Stronger 2008, for the parts one after the other, which is the same where their noise is independent. `None`
/// where an innovation has no positive variance.
#[inline]
pub fn update<const N: usize, const M: usize>(
    state: &mut Gaussian<N>,
    e: &SVector<f64, M>,
    h: &SMatrix<f64, M, N>,
    r: &SVector<f64, M>,
) -> Option<f64> {
    let before = state.mean;
    let (mut nis, mut determinant) = (0.0, 1.0);
    for i in 0..M {
        let h_i = h.row(i).transpose();
        let p_h = state.covariance * h_i;
        let s = h_i.dot(&p_h) + r[i];
        if s <= 0.0 || !s.is_finite() {
            return None;
        }
        let e_i = e[i] - h_i.dot(&(state.mean - before));
        let gain = p_h / s;
        state.mean += gain * e_i;
        state.covariance -= gain * p_h.transpose();
        nis += e_i * e_i / s;
        determinant *= s;
    }
    Some(-0.5 * (nis + ln(determinant) + M as f64 * ln(std::f64::consts::TAU)))
}
