//! Accelerations registered with the pedals.

use asami_dataset::{Log, Models, Rng};

use crate::car_lines::CarLines;
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Fit, Registered};

learner! {
    /// As `car_lines`, but for the action model: pedals are averaged over the very time of the acceleration, a delay of the actuators is found,
    /// and no term is likely to make more than what tyres hold, so that a pedal hardly touched gets no wild coefficient. Standard errors
    /// are the regressions', the delay taken as known.
    CarRegistered, "car_registered",
    "As car_lines, but with accelerations registered with the pedals, a delay found, and coefficients within the tyres' grip.",
    source "this project", needs Firings,
    {
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Delays up to this are tried.
        most_delay_s: f64 = 0.5, "s", 0.0..=2.0;
        /// Share of 9.81 m/s^2 that a term may make at full pedals and the greatest speed, one standard deviation; 0: any.
        grip: f64 = 1.0, "1", 0.0..=100.0;
    }
}

impl CarRegistered {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        let &Self { scan_interval_s, most_delay_s, grip } = self;
        let fit = Fit::Registered(Registered { most_delay_s, grip });
        Car { fit, ..CarLines { scan_interval_s, ..CarLines::default() }.car() }
    }
}

impl Learner for CarRegistered {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
