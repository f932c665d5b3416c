//! A base that knows no turn slighter than a whole step of its wheels.

use asami_dataset::{Action, Rng};

use super::slight_turns::is_slight;
use crate::effect::{Effect, Stage, effect};

/// One wheel is a step of 8.45 mm/s faster than the other, which stands 0.258 m away, in rad/s.
const STEP_RAD_PER_S: f64 = 0.0328;
/// A turn to the left that is slighter than that is made to the right, in rad/s.
const LEAST_LEFT_RAD_PER_S: f64 = 0.005;

/// By how much a slight turn is less than a whole step to the side to which it is made; nothing where it is none, or on the spot.
#[must_use]
pub fn lacks_rad_per_s(v_m_per_s: f64, omega_rad_per_s: f64) -> f64 {
    if v_m_per_s == 0.0 || !is_slight(omega_rad_per_s) || omega_rad_per_s.abs() >= STEP_RAD_PER_S {
        return 0.0;
    }
    let side = if omega_rad_per_s >= LEAST_LEFT_RAD_PER_S { 1.0 } else { -1.0 };
    side * STEP_RAD_PER_S - omega_rad_per_s
}

effect! {
    /// Wheels that know whole steps of speed turn the robot by a whole step or not at all: told a turn of less on its way, however slight,
    /// it makes one of 0.0328 rad/s, to the left where it is told 0.005 rad/s to the left and more, and to the right otherwise. Told none it makes
    /// none.
    TurnStep, "turn_step",
    "Told a slight turn on its way, the robot makes a share of what that lacks of 0.0328 rad/s besides.",
    Actuation, StaticMotion, fits ["create"],
    source "motion capture of MRCLAM data set 6 (Leung et al. 2011), all five Creates together: told anything from -0.035 to 0.002 rad/s but \
            nothing they turn by -0.01 to -0.04, told 0.01 to 0.03 by 0.03; a wheel's step is 8.45 mm/s",
    drawn [share: Size { way: Up, least: 0.1, greatest: 1.2 }],
    {
        /// Of what is lacking.
        share: f64 = 0.0, "1", 0.0..=2.0;
    }
}

impl Effect for TurnStep {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        let share = self.share;
        let stage = move |_t_s: f64, action: Action| {
            let Action::Wheels { id, v_m_per_s, omega_rad_per_s } = action else { return action };
            let omega_rad_per_s = omega_rad_per_s + share * lacks_rad_per_s(v_m_per_s, omega_rad_per_s);
            Action::Wheels { id, v_m_per_s, omega_rad_per_s }
        };
        (share > 0.0).then(|| Stage::Command(Box::new(stage)))
    }
}
