//! What another robot was told, once more.

use asami_dataset::{Action, Command, TruePose};

use super::roam::Roaming;
use crate::world::{Drive, Seen};

/// A wheeled robot's recorded commands, each for as long as it was in force. At the arena's edge they wait until the robot has
/// turned back: a robot that answers to them otherwise than the recording's is not led where that went.
pub struct Replay {
    commands: Vec<Command>,
    roaming: Roaming,
    pose: Option<TruePose>,
    /// How far the recording's clock is behind this one.
    behind_s: f64,
    /// When the last command was asked for.
    asked_s: f64,
}

impl Replay {
    /// `commands` in order of time; of `roaming` counts how far the arena reaches, and how fast the robot turns back.
    #[must_use]
    pub fn new(commands: Vec<Command>, roaming: Roaming) -> Self {
        let behind_s = -commands.first().map_or(0.0, |first| first.t_s);
        Self { commands, roaming, pose: None, behind_s, asked_s: 0.0 }
    }
}

impl Drive for Replay {
    fn localise(&mut self, pose: &TruePose) {
        self.pose = Some(*pose);
    }

    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let passed_s = t_s - self.asked_s;
        self.asked_s = t_s;
        if let Some(back) = self.pose.as_ref().and_then(|pose| self.roaming.back(pose)) {
            self.behind_s += passed_s;
            return back;
        }
        // Half a tick of slack: times are rounded multiples of the period.
        let due = self.commands.partition_point(|command| command.t_s + self.behind_s <= t_s + 1e-6);
        due.checked_sub(1).map_or(STANDING, |at| self.commands[at].action)
    }
}

/// Before the first command.
const STANDING: Action = Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s: 0.0 };

#[cfg(test)]
mod tests {
    use super::*;

    fn told(t_s: f64, v_m_per_s: f64) -> Command {
        Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s: 0.0 } }
    }

    fn at(x_m: f64) -> TruePose {
        TruePose { t_s: 0.0, x_m, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None }
    }

    /// From 100 s on in the recording, from 0 s on here; what is not told outside the arena is told after it.
    #[test]
    fn commands_come_as_they_came_and_wait_outside_the_arena() {
        let mut replay = Replay::new(vec![told(100.0, 0.1), told(101.0, 0.2), told(102.0, 0.3)], Roaming::default());
        let speeds: Vec<f64> = (0..12)
            .map(|i| {
                replay.localise(&at(if (3..7).contains(&i) { 9.0 } else { 0.0 }));
                let Action::Wheels { v_m_per_s, .. } = replay.act(0.5 * f64::from(i), &Seen::default()) else {
                    panic!("it is on wheels")
                };
                v_m_per_s
            })
            .collect();
        // It is turned away from the middle by a right angle, and turns on the spot.
        assert_eq!(speeds, [0.1, 0.1, 0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.3, 0.3, 0.3, 0.3]);
    }
}
