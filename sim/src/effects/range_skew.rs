//! Ranges that are too long on one side and too short on the other.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The axis of a camera along which depths are measured is not the one from which its bearings are counted.
    RangeSkew, "range_skew",
    "Ranges are too long on one side and too short on the other, by a share that grows with the sine of the bearing.",
    Sensing, Sensor, fits ["create"],
    source "a depth along an axis that is turned by a small angle; by motion capture of MRCLAM data set 6 (Leung et al. 2011) up to 0.04 rad",
    drawn [share: Size { way: Either, least: 0.004, greatest: 0.1 }],
    {
        /// What ranges are too long at right angles to the left, as a share of them.
        share: f64 = 0.0, "1", -0.3..=0.3;
    }
}

impl Effect for RangeSkew {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.range_skew += self.share;
    }
}
