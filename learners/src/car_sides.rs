//! Lasers that sit off the axis, on sides that the data tell.

use asami_dataset::{Log, Models, Rng};

use crate::car_lines::CarLines;
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Offsets, Sensor};

learner! {
    /// As `car_alternating`, but nobody says which lasers sit on which side: the lags over range do, and a pattern that repeats is
    /// taken for the likelier where it fits about as well.
    CarSides, "car_sides",
    "As car_alternating, but the sides on which the lasers sit are found as well.",
    source "this project", needs Firings,
    {
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Of a longer drive so many turns are used for the angles, spread over it; 0: all.
        most_turns: u32 = 100, "1", 0.0..=1000000.0;
    }
}

impl CarSides {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        let lines = CarLines { scan_interval_s: self.scan_interval_s, ..CarLines::default() }.car();
        let most_turns = self.most_turns as usize;
        Car { sensor: Sensor { offsets: Offsets::Sides, most_turns, ..lines.sensor.clone() }, ..lines }
    }
}

impl Learner for CarSides {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
