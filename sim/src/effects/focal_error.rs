//! A camera whose focal length is not the one it is said to have.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The true focal length is a multiple of the nominal one, by which the vision computes.
    FocalError, "focal_error",
    "The camera's focal length is not the nominal one.",
    Sensing, Sensor, fits ["aibo", "plain", "create"],
    source "lenses of this class are good to 2 to 5 % unless they are calibrated one by one",
    drawn [ratio: Size { way: Either, least: 0.005, greatest: 0.12 }],
    {
        /// Factor on the nominal focal length.
        ratio: f64 = 1.0, "1", 0.7..=1.4;
    }
}

impl Effect for FocalError {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.focal_ratio *= self.ratio;
    }
}
