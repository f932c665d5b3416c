//! A floor more slippery or more grippy than the nominal one.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The friction between feet or tyres and ground is a multiple of the nominal one.
    GroundFriction, "ground_friction",
    "Feet or tyres grip the ground less, or more, than nominally.",
    Dynamics, StaticMotion, fits ["aibo", "create", "car"],
    source "rubber on carpet to plastic on lino: coefficients of about 1.0 down to 0.15",
    drawn [ratio: Size { way: Down, least: 0.1, greatest: 0.8 }],
    {
        /// Factor on the nominal friction coefficient.
        ratio: f64 = 1.0, "1", 0.1..=1.5;
    }
}

impl Effect for GroundFriction {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.ground.friction *= self.ratio;
    }
}
