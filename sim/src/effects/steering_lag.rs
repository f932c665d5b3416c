//! A slower steering motor.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The steering follows with a longer time constant.
    SteeringLag, "steering_lag",
    "The front wheels follow the steering wheel more slowly than nominally.",
    Actuation, Timing, fits ["car"],
    source "steering that is driven by wire lags by 0.1 to 0.5 s, mostly by 0.2 s",
    drawn [lag_s: Size { way: Up, least: 0.003, greatest: 0.5 }],
    {
        /// Time constant on top of the nominal one.
        lag_s: f64 = 0.0, "s", 0.0..=1.0;
    }
}

impl Effect for SteeringLag {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.steering_lag_s += self.lag_s;
    }
}
