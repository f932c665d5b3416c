//! Wheels that touch the floor elsewhere than where they are thought to.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The wheels touch the floor nearer together, or farther apart, than the robot's computer takes them to.
    WheelBase, "wheel_base",
    "The wheels touch the floor nearer together or farther apart than nominally: turns come out larger or smaller.",
    Dynamics, StaticMotion, fits ["create"],
    source "Borenstein and Feng 1996 (UMBmark): E_b, \"uncertainty about the effective wheelbase\", of 1 to 7 %: tyres touch in an area",
    drawn [ratio: Size { way: Either, least: 0.006, greatest: 0.15 }],
    {
        /// Effective distance between the wheels over the nominal one.
        ratio: f64 = 1.0, "1", 0.7..=1.3;
    }
}

impl Effect for WheelBase {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.wheels.base_ratio *= self.ratio;
    }
}
