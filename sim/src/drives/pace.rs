//! To and fro before a beacon (Stronger 2008, section 3.3).

use asami_dataset::{Action, Rng, Size};
use rand::RngExt;

use crate::world::{Drive, Seen};

asami_dataset::parameters! {
    /// The policy of chapter 3: walk towards the beacon at random speeds until it looks large, then
    /// back until it looks small.
    pub struct Pacing {
        /// Greatest commanded speed either way.
        max_speed_m_per_s: f64 = 0.3, "m/s", 0.01..=1.0;
        /// How long each command is held.
        hold_s: f64 = 3.0, "s", 0.1..=60.0;
        /// Height at which the robot turns round to walk back.
        near_height_px: f64 = 33.0, "px", 1.0..=160.0;
        /// Height at which it turns round to walk forward.
        far_height_px: f64 = 11.5, "px", 1.0..=160.0;
        /// The beacon unseen for this long while walking forward: turn round too, rather than pass it.
        lost_s: f64 = 3.0, "s", 0.1..=60.0;
    }
}

/// [`Pacing`] under way.
pub struct Pace {
    pacing: Pacing,
    rng: Rng,
    forward: bool,
    command_m_per_s: f64,
    since_s: Option<f64>,
    read: usize,
    seen_s: f64,
}

impl Pace {
    /// Starts forward; `rng` draws the commands.
    #[must_use]
    pub fn new(pacing: Pacing, rng: Rng) -> Self {
        Self { pacing, rng, forward: true, command_m_per_s: 0.0, since_s: None, read: 0, seen_s: 0.0 }
    }

    /// Reads the sightings since the last call; whether the robot must turn round.
    fn turns_round(&mut self, t_s: f64, seen: &Seen) -> bool {
        let mut turn = false;
        for sighting in &seen.sightings[self.read..] {
            self.seen_s = sighting.t_s;
            if let Size::HeightPx(height_px) = sighting.size {
                turn = if self.forward {
                    height_px > self.pacing.near_height_px
                } else {
                    height_px < self.pacing.far_height_px
                };
            }
        }
        self.read = seen.sightings.len();
        turn || (self.forward && t_s - self.seen_s > self.pacing.lost_s)
    }
}

impl Drive for Pace {
    fn act(&mut self, t_s: f64, seen: &Seen) -> Action {
        let turn = self.turns_round(t_s, seen);
        if turn {
            self.forward = !self.forward;
        }
        // The tick's time is a rounded multiple of the period: half a tick of slack.
        if turn || self.since_s.is_none_or(|since_s| t_s - since_s >= self.pacing.hold_s - 1e-6) {
            let speed_m_per_s = self.rng.random::<f64>() * self.pacing.max_speed_m_per_s;
            self.command_m_per_s = if self.forward { speed_m_per_s } else { -speed_m_per_s };
            self.since_s = Some(t_s);
        }
        Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: self.command_m_per_s, atheta_rad_per_s: 0.0 }
    }
}
