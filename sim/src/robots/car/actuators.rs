//! Motors that move throttle, brake pedal and steering wheel to where they are told, late and smoothly.

use std::collections::VecDeque;

use asami_math::elementary::exp;

/// A dead time, then a first-order lag, with an optional limit on speed.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// What it was told, on its way.
    waiting: VecDeque<f64>,
    /// Share of the difference that is made up in a step.
    share: f64,
    most_per_step: f64,
    value: f64,
}

impl Actuator {
    /// At rest at 0. Dead times are whole steps.
    #[must_use]
    pub fn new(delay_s: f64, lag_s: f64, most_per_s: f64, time_step_s: f64) -> Self {
        let waiting = std::iter::repeat_n(0.0, (delay_s / time_step_s).round() as usize).collect();
        Self { waiting, share: 1.0 - exp(-time_step_s / lag_s), most_per_step: most_per_s * time_step_s, value: 0.0 }
    }

    /// Where it is one step after it is told to be at `wanted`.
    pub fn step(&mut self, wanted: f64) -> f64 {
        self.waiting.push_back(wanted);
        let due = self.waiting.pop_front().unwrap_or(wanted);
        self.value += (self.share * (due - self.value)).clamp(-self.most_per_step, self.most_per_step);
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After the dead time a step leaves `exp(-t / lag)` of itself.
    #[test]
    fn follows_a_step_as_a_lag_does() {
        let mut actuator = Actuator::new(0.05, 0.1, f64::INFINITY, 0.0025);
        let values: Vec<f64> = (0..200).map(|_| actuator.step(1.0)).collect();
        assert!(values[..20].iter().all(|value| *value == 0.0));
        for (i, value) in values.iter().enumerate().skip(20) {
            let since_s = (i - 19) as f64 * 0.0025;
            assert!((1.0 - value - exp(-since_s / 0.1)).abs() < 1e-12);
        }
    }

    #[test]
    fn is_no_faster_than_its_limit() {
        let mut actuator = Actuator::new(0.0, 0.01, 2.0, 0.0025);
        let values: Vec<f64> = (0..400).map(|_| actuator.step(1.0)).collect();
        assert!(values.windows(2).all(|pair| pair[1] - pair[0] <= 2.0 * 0.0025 + 1e-12));
        assert!((values[399] - 1.0).abs() < 1e-6);
    }
}
