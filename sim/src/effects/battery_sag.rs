//! A battery that empties while the log is taken.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// Torque and greatest speed of all motors fall evenly with time, down to a floor.
    BatterySag, "battery_sag",
    "The supply falls with time, and with it all motors' torque and greatest speed.",
    Actuation, Drift, fits ["aibo", "plain"],
    source "a two-cell pack falls from 8.2 V to 6.7 V before its protection cuts out, 18 %, and further under load",
    drawn [lost_per_s: Size { way: Up, least: 0.0003, greatest: 0.004 }],
    {
        /// Share of the supply that is lost each second.
        lost_per_s: f64 = 0.0, "/s", 0.0..=0.01;
    }
}

/// What is left at least: from here on the regulator holds.
const FLOOR: f64 = 0.35;

impl Effect for BatterySag {
    fn tune(&self, t_s: f64, knobs: &mut Knobs) {
        let left = (1.0 - self.lost_per_s * t_s).max(FLOOR);
        knobs.motors.speed_ratio *= left;
        for torque_ratio in &mut knobs.motors.torque_ratio {
            *torque_ratio *= left;
        }
    }
}
