//! All that helped: lasers off the axis, scans matched point to line, and accelerations registered with the pedals.

use asami_dataset::{Log, Models, Rng};

use crate::car_sides::CarSides;
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Fit, Registered};

learner! {
    /// As `car_sides`, but for the action model: pedals are averaged over the very time of the acceleration, a delay of the actuators is found,
    /// and no term is likely to make more than what tyres hold, so that a pedal hardly touched gets no wild coefficient. Standard errors
    /// are the regressions', the delay taken as known.
    CarBest, "car_best",
    "As car_sides, but with accelerations registered with the pedals, a delay found, and coefficients within the tyres' grip.",
    source "this project", needs Firings,
    {
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Of a longer drive so many turns are used for the angles, spread over it; 0: all.
        most_turns: u32 = 100, "1", 0.0..=1000000.0;
        /// Delays up to this are tried.
        most_delay_s: f64 = 0.5, "s", 0.0..=2.0;
        /// Share of 9.81 m/s^2 that a term may make at full pedals and the greatest speed, one standard deviation; 0: any.
        grip: f64 = 1.0, "1", 0.0..=100.0;
    }
}

impl CarBest {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        let &Self { scan_interval_s, most_turns, most_delay_s, grip } = self;
        let fit = Fit::Registered(Registered { most_delay_s, grip });
        Car { fit, ..CarSides { scan_interval_s, most_turns }.car() }
    }
}

impl Learner for CarBest {
    fn learn(&self, log: &Log, _given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log)
    }
}
