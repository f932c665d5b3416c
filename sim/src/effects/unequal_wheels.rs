//! Wheels of unequal size: the robot turns where it should go straight.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The right wheel is larger than the left by this share of their mean.
    UnequalWheels, "unequal_wheels",
    "The two driven wheels differ in size: straight on becomes an arc.",
    Dynamics, StaticMotion, fits ["create"],
    source "Borenstein and Feng 1996 (UMBmark): E_d, \"unequal wheel diameters\", of 0.1 to 1 %; worn or soft tyres more",
    drawn [ratio: Size { way: Either, least: 0.001, greatest: 0.03 }],
    {
        /// Diameter of the right wheel over that of the left.
        ratio: f64 = 1.0, "1", 0.9..=1.1;
    }
}

impl Effect for UnequalWheels {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        // Their mean stays what it is.
        let apart = (self.ratio - 1.0) / (self.ratio + 1.0);
        let [left, right] = &mut knobs.wheels.radius_ratio;
        *left *= 1.0 - apart;
        *right *= 1.0 + apart;
    }
}
