//! An image that is noisier than nominally.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The noise of the pixels is a multiple of the nominal one; where there are no pixels, that of heights and
    /// bearings is.
    VisionNoise, "vision_noise",
    "Dim light: the image is noisier, or what is measured in it where there is no image.",
    Sensing, Noise, fits ["aibo", "plain", "create"],
    source "a fourth of the light takes four times the gain, and twice to four times the noise",
    drawn [ratio: Size { way: Up, least: 0.025, greatest: 0.5 }],
    {
        /// Factor on the standard deviation.
        ratio: f64 = 1.0, "1", 0.2..=4.0;
    }
}

impl Effect for VisionNoise {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.noise_ratio *= self.ratio;
    }
}
