//! A base that is quicker where it is told a slight turn.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

/// Sharper turns are none of these, in rad/s.
const SLIGHT_RAD_PER_S: f64 = 0.1;

/// Whether a turning rate is that of a slight turn, and of a turn at all.
#[must_use]
pub fn is_slight(omega_rad_per_s: f64) -> bool {
    // Rounding aside.
    omega_rad_per_s != 0.0 && omega_rad_per_s.abs() - SLIGHT_RAD_PER_S < 1e-9
}

effect! {
    /// Wheels that know whole steps of speed take the nearest to go straight on. Told the slightest turn, one of the two takes the step above
    /// that, and the robot goes forward by half a step more: in the mean of slight turns to both sides it is quicker than it is told, and than
    /// it is where it is told none.
    SlightTurns, "slight_turns",
    "Told a slight turn, up to 0.1 rad/s, the robot goes forward faster than told by a share.",
    Actuation, StaticMotion, fits ["create"],
    source "motion capture of MRCLAM data set 6 (Leung et al. 2011): told 67 mm/s all five Creates go 67.6 straight on and 71.9, half a step \
            of 8.45 mm/s more, with any turn of up to 0.1 rad/s",
    drawn [gain_share: Size { way: Up, least: 0.01, greatest: 0.15 }],
    {
        /// By so much of what is told it is faster.
        gain_share: f64 = 0.0, "1", -0.5..=0.5;
    }
}

impl Effect for SlightTurns {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.wheels.slight_gain += self.gain_share;
    }
}
