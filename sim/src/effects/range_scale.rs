//! Ranges that are all too long, or too short, by the same share.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// A range sensor's scale is off.
    RangeScale, "range_scale",
    "Ranges are a fixed multiple of what they should be.",
    Sensing, Sensor, fits ["create"],
    source "a camera that takes apparent sizes for ranges is off by what its focal length is off: 1 to 5 %",
    drawn [ratio: Size { way: Either, least: 0.003, greatest: 0.1 }],
    {
        /// Factor on ranges.
        ratio: f64 = 1.0, "1", 0.7..=1.3;
    }
}

impl Effect for RangeScale {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.range_ratio *= self.ratio;
    }
}
