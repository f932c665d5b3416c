//! A steering gear of another ratio.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The front wheels turn by a fixed multiple of what the steering wheel asks for.
    SteeringRatio, "steering_ratio",
    "The front wheels turn by more, or less, than the steering wheel asks for.",
    Actuation, StaticMotion, fits ["car"],
    source "gears of one model differ by a tenth or two between its versions, and compliance takes some per cent off the angle",
    drawn [ratio: Size { way: Either, least: 0.004, greatest: 0.2 }],
    {
        /// Factor on the front wheels' angle.
        ratio: f64 = 1.0, "1", 0.5..=1.5;
    }
}

impl Effect for SteeringRatio {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.steering_ratio *= self.ratio;
    }
}
