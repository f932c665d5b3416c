//! A lens that is no pinhole.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// Barrel (negative) or pincushion (positive) distortion, which the vision does not know of.
    LensDistortion, "lens_distortion",
    "The lens bends what is off its axis inwards (barrel) or outwards.",
    Sensing, Sensor, fits ["aibo", "plain", "create"],
    source "first radial coefficients of small lenses with 60 degrees of view are -0.4 to 0.1",
    drawn [radial: Size { way: Either, least: 0.02, greatest: 0.4 }],
    {
        /// First radial coefficient: a tangent r off the axis is imaged at r (1 + radial r^2).
        radial: f64 = 0.0, "1", -0.5..=0.5;
    }
}

impl Effect for LensDistortion {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.distortion += self.radial;
    }
}
