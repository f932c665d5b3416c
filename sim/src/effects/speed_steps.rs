//! Wheels that know a few speeds only.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// Whoever holds the wheels' speeds knows multiples of a step only, and each wheel turns at the nearest. Over all speeds that is nothing
    /// in the mean; what it has of its own is that each speed is off by another share.
    SpeedSteps, "speed_steps",
    "Each wheel turns at the nearest multiple of a step of speed.",
    Actuation, Noise, fits ["create"],
    source "MRCLAM data set 6 (Leung et al. 2011): by motion capture all five Creates go straight on at multiples of 8.45 mm/s, whatever \
            they are told",
    drawn [step_m_per_s: Size { way: Up, least: 0.004, greatest: 0.04 }],
    {
        /// From one speed of a tyre to the next.
        step_m_per_s: f64 = 0.0, "m/s", 0.0..=0.2;
    }
}

impl Effect for SpeedSteps {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.wheels.step_m_per_s = self.step_m_per_s;
    }
}
