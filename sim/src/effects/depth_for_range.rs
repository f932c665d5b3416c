//! A camera that reports depths for ranges.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// What is said to be a landmark's range is, in part or all, its depth along the sensor's axis.
    DepthForRange, "depth_for_range",
    "What is taken for a landmark's range is its depth along the sensor's axis.",
    Sensing, Sensor, fits ["create"],
    source "an upright mark of known height is as tall in a pinhole's image as its depth has it, whatever its bearing; f h / z (Hartley and Zisserman 2004, section 6.1)",
    drawn [share: Size { way: Up, least: 0.1, greatest: 1.0 }],
    {
        /// How much of the way from range to depth.
        share: f64 = 0.0, "1", 0.0..=1.5;
    }
}

impl Effect for DepthForRange {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.depth_share += self.share;
    }
}
