//! Lasers that sit off the axis, by turns on either side.

use asami_dataset::{Log, Models, Rng};

use crate::car_lines::CarLines;
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Offsets, Sensor};

learner! {
    /// As `car_lines`, but lasers sit off the axis of the unit, by turns to the left and to the right in order of vertical angle, all as far.
    /// How far is learned, out of lags within windows of range.
    CarAlternating, "car_alternating",
    "As car_lines, but with lasers off the axis by turns to the left and right, as far as the lags over range tell.",
    source "this project", needs Firings,
    {
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Of a longer drive so many turns are used for the angles, spread over it; 0: all.
        most_turns: u32 = 100, "1", 0.0..=1000000.0;
    }
}

impl CarAlternating {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        let lines = CarLines { scan_interval_s: self.scan_interval_s, ..CarLines::default() }.car();
        let most_turns = self.most_turns as usize;
        Car { sensor: Sensor { offsets: Offsets::Alternating, most_turns, ..lines.sensor.clone() }, ..lines }
    }
}

impl Learner for CarAlternating {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
