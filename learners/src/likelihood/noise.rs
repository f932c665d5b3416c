//! The noise of observations and of motion.

use asami_math::elementary::{exp, lgamma, ln};
use asami_math::kalman::scalar::State as Place;
use asami_math::optimise::golden_section;

use super::posterior::{Data, Motion, State};

/// Least variance of the motion's noise, in squared scaled places per second.
const LEAST_Q: f64 = 1e-9;

impl Data<'_> {
    /// Weight of a residual under Student's t (Lange, Little and Taylor 1989).
    pub(super) fn weight(&self, state: &State, residual: f64) -> f64 {
        (state.tail + 1.0) / (state.tail + (residual / state.sigma) * (residual / state.sigma))
    }

    /// Sets the noise of observations and motion to what makes the innovations of a Kalman filter,
    /// linearised at the smoothed places, most likely; `q / sigma^2` moves by a factor `e^reach` at most.
    pub(super) fn update_noise(&self, state: &mut State, least_sigma: f64, reach: f64) {
        let motion = self.motion(state);
        let weights: Vec<f64> = (0..self.len()).map(|i| self.weight(state, self.residual(state, i))).collect();
        let linear: Vec<(f64, f64)> = (0..self.len())
            .map(|i| {
                let slope = state.shape.slope_at(state.u[i]);
                (slope, self.residual(state, i) + slope * state.u[i])
            })
            .collect();
        let filtered = |log_ratio: f64| self.innovations(state, &motion, &weights, &linear, exp(log_ratio));
        let now = ln(state.q / (state.sigma * state.sigma));
        let best = golden_section(|x| filtered(x).0, now - reach, now + reach, 0.05);
        let variance = filtered(best.x).1;
        if best.value.is_finite() && variance.is_finite() {
            state.sigma = variance.sqrt().max(least_sigma);
            state.q = (exp(best.x) * variance).max(LEAST_Q);
        }
        let squares: Vec<f64> = (0..self.len()).map(|i| (self.residual(state, i) / state.sigma).powi(2)).collect();
        let of_tail = |tail: f64| {
            let sum = log_of_product(squares.iter().map(|square| 1.0 + square / tail));
            0.5 * (tail + 1.0) * sum - squares.len() as f64 * log_peak(tail)
        };
        state.tail = exp(golden_section(|x| of_tail(exp(x)), ln(2.5), ln(300.0), 0.05).x);
    }

    /// Standard deviation of the observations' noise.
    pub(super) fn noise_sd(&self, state: &State) -> f64 {
        let sum = (0..self.len()).fold(0.0, |sum, i| sum + self.residual(state, i).powi(2));
        (sum / self.len() as f64).sqrt()
    }

    /// Minus the profile log-likelihood of `q / sigma^2`, and the `sigma^2` that goes with it.
    fn innovations(
        &self,
        state: &State,
        motion: &Motion,
        weights: &[f64],
        linear: &[(f64, f64)],
        ratio: f64,
    ) -> (f64, f64) {
        let mut place = Place { mean: state.u[0], variance: 1e8 };
        let (mut nis, mut variances) = (0.0, Vec::with_capacity(self.len()));
        for i in 0..self.len() {
            if i > 0 {
                place = place.predict(motion.drift[i], ratio * self.dt_s[i]);
            }
            let Some((next, innovation)) = place.update(linear[i].0, linear[i].1, 1.0 / weights[i]) else {
                return (f64::INFINITY, f64::NAN);
            };
            place = next;
            // The first innovation only tells where the robot began.
            if i > 0 {
                nis += innovation.value * innovation.value / innovation.variance;
                variances.push(innovation.variance);
            }
        }
        let log_det = log_of_product(variances.into_iter());
        let n = (self.len() - 1) as f64;
        (0.5 * (n * ln(nis / n) + log_det), nis / n)
    }
}

/// Sum of logarithms of positive numbers, one logarithm for many of them.
pub(super) fn log_of_product(factors: impl Iterator<Item = f64>) -> f64 {
    let (sum, product) = factors.fold((0.0, 1.0), |(sum, product), factor| {
        let product = product * factor;
        if (1e-100..1e100).contains(&product) { (sum, product) } else { (sum + ln(product), 1.0) }
    });
    sum + ln(product)
}

/// Logarithm of the density of Student's t at zero.
pub(super) fn log_peak(tail: f64) -> f64 {
    lgamma(0.5 * (tail + 1.0)) - lgamma(0.5 * tail) - 0.5 * ln(tail * std::f64::consts::PI)
}
