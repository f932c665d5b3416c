//! Servos that turn more slowly than their data sheet says.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The joints' greatest speed is a fraction of the nominal one.
    ServoSpeedLimit, "servo_speed_limit",
    "Servos or wheels reach only a fraction of their nominal speed; of the plain robot, attempted velocities only a fraction of the greatest.",
    Actuation, StaticMotion, fits ["aibo", "plain", "create"],
    source "hobby servos at 6.7 V instead of 7.4 V turn 9 % more slowly; worn or cold gears cost up to a third",
    drawn [ratio: Size { way: Down, least: 0.02, greatest: 0.35 }],
    {
        /// Factor on the nominal greatest speed.
        ratio: f64 = 1.0, "1", 0.3..=1.0;
    }
}

impl Effect for ServoSpeedLimit {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.motors.speed_ratio *= self.ratio;
    }
}
