//! Images that are older than their time stamps.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// An image shows the world a fixed time before its time stamp; joints are read at the time stamp.
    ImageDelay, "image_delay",
    "Images show the world a fixed time before their time stamps; joint angles are up to date.",
    Sensing, Timing, fits ["aibo", "plain", "create"],
    source "camera readout and transfer take 14 to 60 ms",
    drawn [delay_s: Size { way: Up, least: 0.004, greatest: 0.15 }],
    {
        /// From the exposure to the time stamp.
        delay_s: f64 = 0.0, "s", 0.0..=0.3;
    }
}

impl Effect for ImageDelay {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.delay_s += self.delay_s;
    }
}
