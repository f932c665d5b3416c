//! Bright things that bloom, or rims that are lost.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// Coloured bands cover half as many pixels more at each rim, whatever their distance.
    HeightBias, "height_bias",
    "Blooming makes coloured things taller and wider in the image, or dim light smaller, by so many pixels.",
    Sensing, Sensor, fits ["aibo", "plain"],
    source "blurred and blooming rims shift a colour threshold by up to a pixel each",
    drawn [bias_px: Size { way: Either, least: 0.07, greatest: 3.0 }],
    {
        /// How much taller.
        bias_px: f64 = 0.0, "px", -4.0..=6.0;
    }
}

impl Effect for HeightBias {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.bloom_px += self.bias_px;
    }
}
