//! A head that turns faster or slower than it is set to.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The head turns at a multiple of its nominal rate; its encoder tells the truth.
    SpinRateError, "spin_rate_error",
    "The scanner's head turns faster, or more slowly, than it is set to.",
    Sensing, Sensor, fits ["car"],
    source "a scanner set to 10 turns a second takes 0.1036 s for one in the KITTI recordings: 3.5 % off",
    drawn [ratio: Size { way: Either, least: 0.0003, greatest: 0.05 }],
    {
        /// Factor on the rate.
        ratio: f64 = 1.0, "1", 0.8..=1.2;
    }
}

impl Effect for SpinRateError {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.velodyne.turn_ratio *= self.ratio;
    }
}
