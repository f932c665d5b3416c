//! A pan encoder whose zero is off.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The head's pan reads a constant too much.
    PanOffset, "pan_offset",
    "The encoder of the head's pan, or a fixed sensor's bearing, reads a constant too much.",
    Sensing, Sensor, fits ["aibo", "plain", "create"],
    source "a servo's horn sits on a spline of 25 teeth, trimmed by hand to a few degrees",
    drawn [offset_rad: Size { way: Either, least: 0.013, greatest: 0.25 }],
    {
        /// Reading less truth, counter-clockwise.
        offset_rad: f64 = 0.0, "rad", -0.5..=0.5;
    }
}

impl Effect for PanOffset {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.pan_offset_rad += self.offset_rad;
    }
}
