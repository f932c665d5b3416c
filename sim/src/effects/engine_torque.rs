//! An engine that gives less torque than its data sheet says.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The engine's torque, before its own friction, is a fraction of the nominal one at every opening of the throttle.
    EngineTorque, "engine_torque",
    "The engine gives less torque than nominally, whatever the throttle's opening.",
    Actuation, StaticMotion, fits ["car"],
    source "air is 3 % thinner for every 300 m of height; an engine that lives on a turbocharger's boost lacks up to half without it",
    drawn [ratio: Size { way: Down, least: 0.004, greatest: 0.6 }],
    {
        /// Factor on the torque.
        ratio: f64 = 1.0, "1", 0.3..=1.5;
    }
}

impl Effect for EngineTorque {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.engine_ratio *= self.ratio;
    }
}
