//! Ranges noisier than nominal.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The noise of single ranges is a multiple of the nominal one.
    RangeNoise, "range_noise",
    "Single ranges are noisier, or quieter, than nominally.",
    Sensing, Noise, fits ["car"],
    source "the maker of the HDL-64E says less than 20 mm for one standard deviation; drives found 25 mm and more",
    drawn [ratio: Size { way: Up, least: 0.01, greatest: 4.0 }],
    {
        /// Factor on the standard deviation.
        ratio: f64 = 1.0, "1", 0.2..=8.0;
    }
}

impl Effect for RangeNoise {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.velodyne.noise_ratio *= self.ratio;
    }
}
