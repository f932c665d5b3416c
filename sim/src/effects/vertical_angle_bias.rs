//! Lasers that point higher or lower than their maker measured.

use asami_dataset::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::effect::{Effect, Stage, effect};
use crate::knobs::LaserKnobs;

effect! {
    /// The lasers' vertical angles are not those in the table: all by as much, and each by some of its own.
    VerticalAngleBias, "vertical_angle_bias",
    "The lasers point higher or lower than the scanner's table says.",
    Sensing, Sensor, fits ["car"],
    source "tables of HDL-64E units and calibrations on site differ by 0.2 degrees in vertical angles",
    drawn [bias_rad: Size { way: Up, least: 0.00003, greatest: 0.01 }, spread_rad: Same],
    {
        /// All point higher by this.
        bias_rad: f64 = 0.0, "rad", -0.02..=0.02;
        /// Standard deviation of what each points higher by itself.
        spread_rad: f64 = 0.0, "rad", 0.0..=0.02;
    }
}

impl Effect for VerticalAngleBias {
    fn stage(&self, mut rng: Rng) -> Option<Stage> {
        let Self { bias_rad, spread_rad } = *self;
        Some(Stage::Lasers(Box::new(move |lasers: &mut [LaserKnobs]| {
            for laser in lasers {
                let own: f64 = StandardNormal.sample(&mut rng);
                laser.vertical_rad += bias_rad + spread_rad * own;
            }
        })))
    }
}
