//! To and fro before a beacon (Stronger 2008, section 3.3).

use asami_dataset::{Action, Rng, Size};
use rand::RngExt;

use crate::world::{Drive, Seen};

asami_dataset::parameters! {
    /// The policy of chapter 3: walk towards the beacon at random speeds until it looks large, then
    /// back until it looks small.
    pub struct Pacing {
        /// Greatest commanded speed either way, where commands are not drawn from a list.
        max_speed_m_per_s: f64 = 0.3, "m/s", 0.01..=1.0;
        /// How long each command is held.
        hold_s: f64 = 3.0, "s", 0.1..=60.0;
        /// Of so many commands in a row, walking one way, each comes from another of as many equal parts of the range,
        /// in random order: every command is as likely as any other, and few make an even mix. 1 draws each by itself.
        strata: u32 = 1, "1", 1.0..=100.0;
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
    among: Option<Vec<Action>>,
    forward: bool,
    /// The parts of the range that this round has left, walking back and forward.
    left: [Vec<u32>; 2],
    command: Action,
    since_s: Option<f64>,
    read: usize,
    seen_s: f64,
}

impl Pace {
    /// Starts forward; `rng` draws the commands.
    #[must_use]
    pub fn new(pacing: Pacing, rng: Rng) -> Self {
        let left = [Vec::new(), Vec::new()];
        Self {
            pacing,
            rng,
            among: None,
            forward: true,
            left,
            command: stride(0.0),
            since_s: None,
            read: 0,
            seen_s: 0.0,
        }
    }

    /// The same phases, but commands drawn from `actions`, for example
    /// [`strides`](super::suite::Suite::strides) (section 4.4.3): those that go forward or stand while the
    /// robot walks towards the beacon, those that go back or stand on its way back.
    #[must_use]
    pub fn among(actions: Vec<Action>, pacing: Pacing, rng: Rng) -> Self {
        Self { among: Some(actions), ..Self::new(pacing, rng) }
    }

    /// How far along this phase's range the next command lies, in `[0, 1)`.
    fn share(&mut self) -> f64 {
        let strata = self.pacing.strata;
        if strata <= 1 {
            return self.rng.random::<f64>();
        }
        let left = &mut self.left[usize::from(self.forward)];
        if left.is_empty() {
            left.extend(0..strata);
        }
        let part = left.swap_remove((self.rng.random::<f64>() * left.len() as f64) as usize);
        (f64::from(part) + self.rng.random::<f64>()) / f64::from(strata)
    }

    /// Draws a command for this phase.
    fn draw(&mut self) -> Action {
        let share = self.share();
        let Some(actions) = &self.among else {
            let speed_m_per_s = share * self.pacing.max_speed_m_per_s;
            return stride(if self.forward { speed_m_per_s } else { -speed_m_per_s });
        };
        let fits = |action: &&Action| {
            let ahead_m_per_s = action.forward_m_per_s().unwrap_or(0.0);
            ahead_m_per_s == 0.0 || (ahead_m_per_s > 0.0) == self.forward
        };
        let fitting: Vec<&Action> = actions.iter().filter(fits).collect();
        fitting.get((share * fitting.len() as f64) as usize).map_or(stride(0.0), |action| **action)
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
            self.command = self.draw();
            self.since_s = Some(t_s);
        }
        self.command
    }
}

/// Straight ahead, or back.
fn stride(ay_m_per_s: f64) -> Action {
    Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 }
}
