//! A throttle that opens and closes late.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The dead time of the throttle is longer.
    ThrottleDelay, "throttle_delay",
    "The throttle follows its pedal later than nominally.",
    Actuation, Timing, fits ["car"],
    source "dead times of throttles and brakes that are driven by wire: 0.05 to 0.5 s",
    drawn [delay_s: Size { way: Up, least: 0.005, greatest: 0.5 }],
    {
        /// Dead time on top of the nominal one.
        delay_s: f64 = 0.0, "s", 0.0..=1.0;
    }
}

impl Effect for ThrottleDelay {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.throttle_delay_s += self.delay_s;
    }
}
