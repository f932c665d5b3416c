//! Ranges that are all too long, or too short, by the same length.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// A range sensor's zero is off.
    RangeOffset, "range_offset",
    "Ranges are too long by a constant.",
    Sensing, Sensor, fits ["create"],
    source "a landmark's surface lies its radius before its axis, a sensor's own zero some centimetres from where it is mounted",
    drawn [offset_m: Size { way: Either, least: 0.01, greatest: 0.3 }],
    {
        /// What is added to each.
        offset_m: f64 = 0.0, "m", -1.0..=1.0;
    }
}

impl Effect for RangeOffset {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.range_offset_m += self.offset_m;
    }
}
