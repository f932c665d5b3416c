//! Wheels out of line with the steering wheel.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The front wheels stand at an angle while the steering wheel is straight.
    SteeringOffset, "steering_offset",
    "The front wheels point aside while the steering wheel is straight.",
    Actuation, StaticMotion, fits ["car"],
    source "toe and centring are set to some tenths of a degree; a steering wheel that stands 10 degrees off at a gear of 16 to 1 is 0.011 rad",
    drawn [offset_rad: Size { way: Either, least: 0.0002, greatest: 0.008 }],
    {
        /// Angle of the front wheels, to the left.
        offset_rad: f64 = 0.0, "rad", -0.1..=0.1;
    }
}

impl Effect for SteeringOffset {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.steering_offset_rad += self.offset_rad;
    }
}
