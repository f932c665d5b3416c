//! A camera that is mounted nose up or nose down.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The camera looks up, or down, from where the head's joints say it does.
    CameraPitch, "camera_pitch",
    "The camera is mounted nose up (positive) or nose down.",
    Sensing, Sensor, fits ["aibo"],
    source "mounts are good to a degree or two; a head that was dropped is off by ten",
    drawn [pitch_rad: Size { way: Either, least: 0.03, greatest: 0.3 }],
    {
        /// The line of sight above the nominal one.
        pitch_rad: f64 = 0.0, "rad", -0.4..=0.4;
    }
}

impl Effect for CameraPitch {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.pitch_rad += self.pitch_rad;
    }
}
