//! A throttle pedal with play.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The first part of the throttle pedal's way does nothing; the rest of it opens the throttle fully.
    ThrottleDeadband, "throttle_deadband",
    "The throttle does not open before its pedal has gone some of its way.",
    Actuation, StaticMotion, fits ["car"],
    source "free play of cables and the idle zone of electronic pedals: a few per cent of the way, more where cables are worn",
    drawn [play: Size { way: Up, least: 0.0005, greatest: 0.1 }],
    {
        /// Share of the pedal's way that does nothing.
        play: f64 = 0.0, "1", 0.0..=0.3;
    }
}

impl Effect for ThrottleDeadband {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        let play = &mut knobs.vehicle.throttle_play;
        *play += self.play * (1.0 - *play);
    }
}
