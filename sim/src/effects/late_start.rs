//! A base that gathers way more slowly than it loses it.

use asami_dataset::{Action, Rng};

use crate::effect::{Effect, Stage, effect};

effect! {
    /// Told to go after it was told to stand, a base gathers way: its speed rises from nothing to what it is told, evenly, and so comes later
    /// by half of what that takes, but by no more than it was told to stand for. It turns as it is told all the while, and stops at once. A
    /// robot that is told to stand often gets less far.
    LateStart, "late_start",
    "Told to go after it was told to stand, the robot gathers way: its speed comes late, its turning does not.",
    Actuation, Timing, fits ["create"],
    source "motion capture of MRCLAM data set 6 (Leung et al. 2011): after rests of 0.25 s and more speed comes 0.33 s after it is told (121 \
            starts), by stops it is gone 0.19 s after they are told (72); it falls within 0.2 s, and rises within 0.4 s; turning comes \
            0.23 s after it is told, after rests (42) as on the way (116)",
    drawn [start_s: Size { way: Up, least: 0.02, greatest: 0.4 }],
    {
        /// By so much later its speed comes.
        start_s: f64 = 0.0, "s", 0.0..=1.0;
    }
}

impl Effect for LateStart {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        let start_s = self.start_s;
        let (mut stands_from_s, mut began_s, mut takes_s): (Option<f64>, f64, f64) = (None, 0.0, 0.0);
        let stage = move |t_s: f64, action: Action| {
            let Action::Wheels { id, v_m_per_s, omega_rad_per_s } = action else { return action };
            if v_m_per_s == 0.0 && omega_rad_per_s == 0.0 {
                stands_from_s.get_or_insert(t_s);
                return action;
            }
            if let Some(from_s) = stands_from_s.take() {
                (began_s, takes_s) = (t_s, 2.0 * start_s.min(t_s - from_s));
            }
            let share = if t_s < began_s + takes_s { (t_s - began_s) / takes_s } else { 1.0 };
            Action::Wheels { id, v_m_per_s: share * v_m_per_s, omega_rad_per_s }
        };
        (start_s > 0.0).then(|| Stage::Command(Box::new(stage)))
    }
}
