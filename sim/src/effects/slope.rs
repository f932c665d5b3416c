//! A floor that is not level.

use std::f64::consts::FRAC_PI_2;

use asami_math::elementary::{sin, sin_cos};

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The floor is an inclined plane.
    Slope, "slope",
    "The floor rises in one direction.",
    Dynamics, StaticMotion, fits ["aibo", "plain", "create"],
    source "floors of dwellings are off by up to 1 degree, ramps and carpets over cables by 2 to 6",
    drawn [pitch_rad: Size { way: Either, least: 0.005, greatest: 0.1 }, uphill_rad: Choice(&[0.0, FRAC_PI_2])],
    {
        /// Its angle against the level.
        pitch_rad: f64 = 0.0, "rad", -0.15..=0.15;
        /// Where it rises: counter-clockwise from world +y.
        uphill_rad: f64 = 0.0, "rad", -3.15..=3.15;
    }
}

impl Effect for Slope {
    /// Its direction does not matter to a level floor.
    fn is_null(&self) -> bool {
        self.pitch_rad == 0.0
    }

    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        let (to_left, ahead) = sin_cos(self.uphill_rad);
        let steep = sin(self.pitch_rad);
        knobs.ground.slope[0] -= steep * to_left;
        knobs.ground.slope[1] += steep * ahead;
    }
}
