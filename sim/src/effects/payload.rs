//! A load on the robot's back.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// A load rides on the torso, ahead of its centre or behind it.
    Payload, "payload",
    "The robot carries a load on its back, ahead of its centre or behind.",
    Dynamics, StaticMotion, fits ["aibo", "create"],
    source "a radio or a second battery weighs 50 to 200 g, an Aibo 1.66 kg",
    drawn [mass_kg: Size { way: Up, least: 0.018, greatest: 0.5 }, ahead_m: Choice(&[0.05, -0.05])],
    {
        /// Its mass.
        mass_kg: f64 = 0.0, "kg", 0.0..=0.6;
        /// How far ahead of the body's centre it sits.
        ahead_m: f64 = 0.0, "m", -0.08..=0.08;
    }
}

impl Effect for Payload {
    /// Where it sits does not matter where there is none.
    fn is_null(&self) -> bool {
        self.mass_kg == 0.0
    }

    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        let body = &mut knobs.body;
        body.payload_kg += self.mass_kg;
        if !self.is_null() {
            body.payload_ahead_m = self.ahead_m;
        }
    }
}
