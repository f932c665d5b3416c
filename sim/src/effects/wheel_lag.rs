//! Wheels that answer commands slowly.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The wheels' speed follows the command more slowly.
    WheelLag, "wheel_lag",
    "The wheels' speed follows the command with a longer time constant.",
    Actuation, Timing, fits ["create"],
    source "speed loops of small drives settle in 0.1 to 0.5 s",
    drawn [lag_s: Size { way: Up, least: 0.02, greatest: 0.5 }],
    {
        /// Time constant on top of the drive's own.
        lag_s: f64 = 0.0, "s", 0.0..=2.0;
    }
}

impl Effect for WheelLag {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.wheels.lag_s += self.lag_s;
    }
}
