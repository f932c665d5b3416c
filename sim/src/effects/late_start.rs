//! A base that starts later than it stops.

use asami_dataset::{Action, Rng};

use crate::effect::{Effect, Stage, effect};

effect! {
    /// Wheels that stand take longer to turn than wheels that turn take to stand: whatever is told first after the robot was told to stand
    /// comes later by a while, but by no more than it was told to stand for. A robot that is told to stand often gets less far.
    LateStart, "late_start",
    "Told to go after it was told to stand, the robot stands for a while longer.",
    Actuation, Timing, fits ["create"],
    source "motion capture of MRCLAM data set 6 (Leung et al. 2011): Creates start 0.29 to 0.31 s after they are told, and stop after 0.15 to \
            0.20 s; told to stand for half a second they stand for 0.1 s longer",
    drawn [start_s: Size { way: Up, least: 0.02, greatest: 0.4 }],
    {
        /// By so much later it starts.
        start_s: f64 = 0.0, "s", 0.0..=1.0;
    }
}

impl Effect for LateStart {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        let start_s = self.start_s;
        let (mut stands_from_s, mut until_s): (Option<f64>, f64) = (None, f64::NEG_INFINITY);
        let stage = move |t_s: f64, action: Action| {
            let Action::Wheels { id, v_m_per_s, omega_rad_per_s } = action else { return action };
            if v_m_per_s == 0.0 && omega_rad_per_s == 0.0 {
                stands_from_s.get_or_insert(t_s);
                return action;
            }
            if let Some(from_s) = stands_from_s.take() {
                until_s = t_s + start_s.min(t_s - from_s);
            }
            // Half a microsecond: times are multiples of the tick, computed by one rounding each.
            if t_s + 5e-7 < until_s {
                return Action::Wheels { id, v_m_per_s: 0.0, omega_rad_per_s: 0.0 };
            }
            action
        };
        (start_s > 0.0).then(|| Stage::Command(Box::new(stage)))
    }
}
