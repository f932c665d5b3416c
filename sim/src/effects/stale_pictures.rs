//! A camera that takes pictures by a clock of its own.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// Pictures are taken at a steady rate, and a slower loop picks the newest of them up: what it reports is as old as that is, and
    /// the age runs from nothing to the period and back to nothing, again and again. In the mean that is an image delay; what it has of its
    /// own is that bearings scatter while the robot turns.
    StalePictures, "stale_pictures",
    "A camera takes pictures by a clock of its own; what is reported is of the newest, which may be as old as they are apart.",
    Sensing, Noise, fits ["create"],
    source "MRCLAM data set 6 (Leung et al. 2011): bearings beside motion capture show pictures of all five Creates 0.1000 s apart",
    drawn [period_s: Size { way: Up, least: 0.02, greatest: 0.25 }],
    {
        /// From a picture to the next; the first is taken as the log begins.
        period_s: f64 = 0.0, "s", 0.0..=1.0;
    }
}

impl Effect for StalePictures {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.picture_period_s = self.period_s;
    }
}
