//! Ranges that are too long or too short.

use asami_dataset::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::effect::{Effect, Stage, effect};
use crate::knobs::LaserKnobs;

effect! {
    /// Every range is off by a constant: one of all lasers, and one of each.
    RangeBias, "range_bias",
    "Ranges are too long by a constant, each laser's by one of its own.",
    Sensing, Sensor, fits ["car"],
    source "range offsets of the beams of HDL-64E units spread by 70 to 90 mm before they are calibrated, by 10 to 20 mm after",
    drawn [bias_m: Size { way: Up, least: 0.0003, greatest: 0.15 }, spread_m: Same],
    {
        /// All measure this much too much.
        bias_m: f64 = 0.0, "m", -0.5..=0.5;
        /// Standard deviation of what each measures too much by itself.
        spread_m: f64 = 0.0, "m", 0.0..=0.5;
    }
}

impl Effect for RangeBias {
    fn stage(&self, mut rng: Rng) -> Option<Stage> {
        let Self { bias_m, spread_m } = *self;
        Some(Stage::Lasers(Box::new(move |lasers: &mut [LaserKnobs]| {
            for laser in lasers {
                let own: f64 = StandardNormal.sample(&mut rng);
                laser.range_m += bias_m + spread_m * own;
            }
        })))
    }
}
