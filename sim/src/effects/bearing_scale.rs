//! Angles of a scanner that are spread.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// A scanner that tells its bearings by the time since its mirror looked ahead, and whose mirror turns faster or more slowly than it
    /// takes it to.
    BearingScale, "bearing_scale",
    "A scanner's bearings are a multiple of what they should be: its mirror turns at another rate than it counts by.",
    Sensing, Sensor, fits ["create"],
    source "by motion capture of \"Lost in the Woods\" (Barfoot) bearings are spread by 0.2 %; a scanner set to 10 turns a second is 3.5 % off in the KITTI recordings",
    drawn [ratio: Size { way: Either, least: 0.0005, greatest: 0.05 }],
    {
        /// Factor on bearings.
        ratio: f64 = 1.0, "1", 0.8..=1.2;
    }
}

impl Effect for BearingScale {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.bearing_ratio *= self.ratio;
    }
}
