//! Motors that bring what they move to where they are told, late and smoothly.

use std::collections::VecDeque;

use asami_math::elementary::exp;

/// Most dead time on top of its own that an actuator may be given.
const MOST_EXTRA_S: f64 = 2.0;

/// A dead time, then a first-order lag, with an optional limit on speed.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// What it was told, the newest last, as far back as the longest dead time.
    told: VecDeque<f64>,
    delay_steps: usize,
    lag_s: f64,
    /// Share of the difference that is made up in a step.
    share: f64,
    /// Time constant on top of its own that `share` holds for.
    extra_lag_s: f64,
    most_per_step: f64,
    value: f64,
    time_step_s: f64,
}

impl Actuator {
    /// At rest at 0. Dead times are whole steps.
    #[must_use]
    pub fn new(delay_s: f64, lag_s: f64, most_per_s: f64, time_step_s: f64) -> Self {
        let steps = |delay_s: f64| (delay_s / time_step_s).round() as usize;
        Self {
            told: std::iter::repeat_n(0.0, steps(delay_s) + steps(MOST_EXTRA_S)).collect(),
            delay_steps: steps(delay_s),
            lag_s,
            share: 1.0 - exp(-time_step_s / lag_s),
            extra_lag_s: 0.0,
            most_per_step: most_per_s * time_step_s,
            value: 0.0,
            time_step_s,
        }
    }

    /// Where it is one step after it is told to be at `wanted`, with `late` on top of its own dead time and lag.
    pub fn step(&mut self, wanted: f64, late: Late) -> f64 {
        if late.lag_s != self.extra_lag_s {
            self.extra_lag_s = late.lag_s;
            self.share = 1.0 - exp(-self.time_step_s / (self.lag_s + late.lag_s));
        }
        self.told.push_back(wanted);
        self.told.pop_front();
        let back = self.delay_steps + (late.delay_s / self.time_step_s).round() as usize;
        let due = self.told.iter().rev().nth(back).or(self.told.front()).copied().unwrap_or(wanted);
        self.value += (self.share * (due - self.value)).clamp(-self.most_per_step, self.most_per_step);
        self.value
    }
}

/// How much later than its own make an actuator acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Late {
    /// More dead time.
    pub delay_s: f64,
    /// More of a time constant.
    pub lag_s: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After the dead time a step leaves `exp(-t / lag)` of itself.
    #[test]
    fn follows_a_step_as_a_lag_does() {
        let mut actuator = Actuator::new(0.05, 0.1, f64::INFINITY, 0.0025);
        let values: Vec<f64> = (0..200).map(|_| actuator.step(1.0, Late::default())).collect();
        assert!(values[..20].iter().all(|value| *value == 0.0));
        for (i, value) in values.iter().enumerate().skip(20) {
            let since_s = (i - 19) as f64 * 0.0025;
            assert!((1.0 - value - exp(-since_s / 0.1)).abs() < 1e-12);
        }
    }

    #[test]
    fn is_no_faster_than_its_limit() {
        let mut actuator = Actuator::new(0.0, 0.01, 2.0, 0.0025);
        let values: Vec<f64> = (0..400).map(|_| actuator.step(1.0, Late::default())).collect();
        assert!(values.windows(2).all(|pair| pair[1] - pair[0] <= 2.0 * 0.0025 + 1e-12));
        assert!((values[399] - 1.0).abs() < 1e-6);
    }

    /// What comes on top is as if it had been its own.
    #[test]
    fn lateness_adds_up() {
        let mut own = Actuator::new(0.15, 0.3, 2.0, 0.0025);
        let mut late = Actuator::new(0.05, 0.1, 2.0, 0.0025);
        for i in 0..800 {
            let wanted = if i % 300 < 100 { 1.0 } else { -0.4 };
            let extra = Late { delay_s: 0.1, lag_s: 0.2 };
            assert!((own.step(wanted, Late::default()) - late.step(wanted, extra)).abs() < 1e-12, "{i}");
        }
    }
}
