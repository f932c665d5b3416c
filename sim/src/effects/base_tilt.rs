//! A scanner that stands askew on the roof.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The base of the scanner leans from the upright that it is thought to have on the car.
    BaseTilt, "base_tilt",
    "The laser scanner's base leans.",
    Sensing, Sensor, fits ["car"],
    source "brackets bolted on by hand are off by 0.3 to 2 degrees; calibrations of such mounts find pitch and roll to 0.1",
    drawn [pitch_rad: Size { way: Either, least: 0.0003, greatest: 0.04 }, roll_rad: Same],
    {
        /// Its front is up by this.
        pitch_rad: f64 = 0.0, "rad", -0.1..=0.1;
        /// Its left side is up by this.
        roll_rad: f64 = 0.0, "rad", -0.1..=0.1;
    }
}

impl Effect for BaseTilt {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.velodyne.pitch_rad += self.pitch_rad;
        knobs.velodyne.roll_rad += self.roll_rad;
    }
}
