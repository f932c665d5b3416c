//! Any speed and turning rate, all over an arena.

use asami_dataset::{Action, Rng, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, sin_cos};
use rand::RngExt;

use crate::world::{Drive, Seen};

asami_dataset::parameters! {
    /// A wheeled robot's policy: now and then another speed and turning rate; at the arena's edge it turns back.
    pub struct Roaming {
        /// Least time for which a command is held.
        least_hold_s: f64 = 0.5, "s", 0.1..=60.0;
        /// Greatest.
        most_hold_s: f64 = 6.0, "s", 0.1..=600.0;
        /// Greatest forward speed; slower ones are as likely.
        most_m_per_s: f64 = 0.4, "m/s", 0.01..=5.0;
        /// Greatest turning rate to either side; 0: the robot is on a rail, and goes forward and backward.
        most_rad_per_s: f64 = 0.6, "rad/s", 0.0..=10.0;
        /// Share of the commands that go straight on.
        straight: f64 = 0.3, "1", 0.0..=1.0;
        /// Greatest turning rate while it drives, as a share of that on the spot.
        in_arcs: f64 = 1.0, "1", 0.0..=1.0;
        /// Share of the commands that turn on the spot.
        on_the_spot: f64 = 0.2, "1", 0.0..=1.0;
        /// Share of the commands to stand still.
        rests: f64 = 0.0, "1", 0.0..=1.0;
        /// Extent of the arena along world x, about the origin.
        arena_x_m: f64 = 8.0, "m", 0.5..=1000.0;
        /// Extent of the arena along world y, about the origin.
        arena_y_m: f64 = 8.0, "m", 0.5..=1000.0;
    }
}

/// [`Roaming`] under way.
pub struct Roam {
    roaming: Roaming,
    rng: Rng,
    pose: Option<TruePose>,
    current: Option<(f64, Action)>,
}

impl Roaming {
    /// What it takes to come back from outside the arena: a turn towards the middle, or on a rail the way towards it; `None`
    /// inside.
    pub(super) fn back(&self, pose: &TruePose) -> Option<Action> {
        if pose.x_m.abs() <= 0.5 * self.arena_x_m && pose.y_m.abs() <= 0.5 * self.arena_y_m {
            return None;
        }
        let off_rad = wrap_rad(atan2(pose.x_m, -pose.y_m) - pose.theta_rad);
        if self.on_a_rail() {
            let ahead = off_rad.abs() < std::f64::consts::FRAC_PI_2;
            return Some(wheels(if ahead { self.most_m_per_s } else { -self.most_m_per_s }, 0.0));
        }
        let side = if off_rad < 0.0 { -1.0 } else { 1.0 };
        let turns = off_rad.abs() > TOWARDS_RAD;
        Some(if turns { wheels(0.0, side * self.most_rad_per_s) } else { wheels(self.most_m_per_s, 0.0) })
    }

    fn on_a_rail(&self) -> bool {
        self.most_rad_per_s == 0.0
    }
}

/// A robot heads for the middle where it is headed off it by less than this.
const TOWARDS_RAD: f64 = 0.3;

impl Roam {
    /// `rng` draws.
    #[must_use]
    pub fn new(roaming: Roaming, rng: Rng) -> Self {
        Self { roaming, rng, pose: None, current: None }
    }

    /// Draws a command and how long it is held.
    fn draw(&mut self) -> (f64, Action) {
        let Roaming { least_hold_s, most_hold_s, most_m_per_s, most_rad_per_s, .. } = self.roaming;
        let Roaming { straight, in_arcs, on_the_spot, rests, .. } = self.roaming;
        let [hold, kind, speed, turn] = std::array::from_fn(|_| self.rng.random::<f64>());
        let (v, omega) = (most_m_per_s * speed, most_rad_per_s * (2.0 * turn - 1.0));
        let action = match kind {
            kind if kind > 1.0 - rests => wheels(0.0, 0.0),
            _ if self.roaming.on_a_rail() => wheels(most_m_per_s * (2.0 * speed - 1.0), 0.0),
            kind if kind < straight => wheels(v, 0.0),
            kind if kind < straight + on_the_spot => wheels(0.0, omega),
            _ => wheels(v, in_arcs * omega),
        };
        (least_hold_s + (most_hold_s - least_hold_s).max(0.0) * hold, action)
    }

    /// Whether a command would soon lead out of the arena.
    fn leads_out(&self, action: &Action) -> bool {
        let (Some(pose), Action::Wheels { v_m_per_s, .. }) = (self.pose, action) else { return false };
        let (sin, cos) = sin_cos(pose.theta_rad);
        // A second on.
        let (x_m, y_m) = (pose.x_m - v_m_per_s * sin, pose.y_m + v_m_per_s * cos);
        x_m.abs() > 0.5 * self.roaming.arena_x_m || y_m.abs() > 0.5 * self.roaming.arena_y_m
    }
}

impl Drive for Roam {
    fn localise(&mut self, pose: &TruePose) {
        self.pose = Some(*pose);
    }

    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        if let Some(back) = self.pose.as_ref().and_then(|pose| self.roaming.back(pose)) {
            self.current = None;
            return back;
        }
        // Half a tick of slack: times are rounded multiples of the period.
        let held = self.current.filter(|(until_s, action)| t_s < until_s - 1e-6 && !self.leads_out(action));
        let (until_s, action) = held.unwrap_or_else(|| {
            let (hold_s, action) = self.draw();
            (t_s + hold_s, action)
        });
        self.current = Some((until_s, action));
        action
    }
}

fn wheels(v_m_per_s: f64, omega_rad_per_s: f64) -> Action {
    Action::Wheels { id: None, v_m_per_s, omega_rad_per_s }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;

    /// As many commands as asked for are to stand still, on a rail as well.
    #[test]
    fn a_robot_that_is_to_rest_does() {
        for most_rad_per_s in [0.0, 0.6] {
            let mut roam =
                Roam::new(Roaming { rests: 0.2, most_rad_per_s, ..Roaming::default() }, Seed(3).stream("roam"));
            let stands = (0..2000).filter(|_| roam.draw().1 == wheels(0.0, 0.0)).count();
            // Four standard deviations of a count of 2000 with a chance of a fifth.
            assert!(stands.abs_diff(400) < 72, "{stands}");
        }
    }

    /// Arcs are as wide as asked for, turns on the spot as quick as any.
    #[test]
    fn what_drives_turns_less_quickly_than_what_stands() {
        let roaming = Roaming { in_arcs: 0.5, ..Roaming::default() };
        let asked = [roaming.in_arcs * roaming.most_rad_per_s, roaming.most_rad_per_s];
        let mut roam = Roam::new(roaming, Seed(1).stream("roam"));
        let mut most = [0.0_f64; 2];
        for _ in 0..2000 {
            let (_, Action::Wheels { v_m_per_s, omega_rad_per_s, .. }) = roam.draw() else { panic!("it has wheels") };
            let stands = usize::from(v_m_per_s == 0.0);
            most[stands] = most[stands].max(omega_rad_per_s.abs());
        }
        for (most, asked) in most.into_iter().zip(asked) {
            assert!(most <= asked && most > 0.98 * asked, "{most} of {asked}");
        }
    }
}
