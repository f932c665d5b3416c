//! Lasers that do not stand where they are thought to meet.

use asami_dataset::Rng;

use crate::effect::{Effect, Stage, effect};
use crate::knobs::LaserKnobs;

effect! {
    /// Lasers stand off the spin axis, to the left and to the right by turns, and the upper half of them stands higher.
    LaserOriginOffsets, "laser_origin_offsets",
    "The lasers stand beside the spin axis by turns, and their upper bank above the lower one.",
    Sensing, Sensor, fits ["car"],
    source "factory tables of HDL-64E units: 26 mm to either side by turns, the banks 80 to 100 mm apart in height",
    drawn [aside_m: Size { way: Up, least: 0.001, greatest: 0.05 }, apart_m: Choice(&[0.0, 0.09])],
    {
        /// From the axis to either side of where a laser looks: even ones, counted upwards from 0, to the left.
        aside_m: f64 = 0.0, "m", -0.1..=0.1;
        /// From the lower half of the lasers to the upper one.
        apart_m: f64 = 0.0, "m", -0.3..=0.3;
    }
}

impl Effect for LaserOriginOffsets {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        let Self { aside_m, apart_m } = *self;
        Some(Stage::Lasers(Box::new(move |lasers: &mut [LaserKnobs]| {
            let half = lasers.len() / 2;
            for (i, laser) in lasers.iter_mut().enumerate() {
                laser.left_m += if i.is_multiple_of(2) { aside_m } else { -aside_m };
                laser.up_m += if i < half { -0.5 * apart_m } else { 0.5 * apart_m };
            }
        })))
    }
}
