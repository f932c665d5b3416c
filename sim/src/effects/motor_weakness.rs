//! Motors that all give less torque than nominally.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// All leg motors give a fraction of their nominal torque, for an error and at most.
    MotorWeakness, "motor_weakness",
    "All leg motors give a fraction of their nominal torque; the plain robot's fast commands fall behind.",
    Actuation, StaticMotion, fits ["aibo", "plain"],
    source "a supply of 6.7 to 8.2 V at 7.4 V nominal is -9 % to +11 %; joints droop by 2 degrees under load",
    drawn [ratio: Size { way: Down, least: 0.04, greatest: 0.5 }],
    {
        /// Factor on the nominal torque.
        ratio: f64 = 1.0, "1", 0.25..=1.5;
    }
}

impl Effect for MotorWeakness {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        for torque_ratio in &mut knobs.motors.torque_ratio {
            *torque_ratio *= self.ratio;
        }
    }
}
