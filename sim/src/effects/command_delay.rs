//! A command that takes effect late.

use std::collections::VecDeque;

use asami_dataset::{Action, Rng};

use crate::effect::{Effect, Stage, effect};

effect! {
    /// Every command reaches the gait a fixed time after it was logged.
    CommandDelay, "command_delay",
    "Commands reach the gait generator a fixed time after they were given.",
    Actuation, Timing, fits ["aibo", "plain", "create", "car"],
    source "hobby-servo and radio chains lag by 80 to 160 ms, good drives by under 25 ms",
    drawn [delay_s: Size { way: Up, least: 0.012, greatest: 0.2 }],
    {
        /// From the logged time to the time it acts.
        delay_s: f64 = 0.0, "s", 0.0..=0.5;
    }
}

impl Effect for CommandDelay {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        let delay_s = self.delay_s;
        let mut waiting: VecDeque<(f64, Action)> = VecDeque::new();
        let mut in_force: Option<Action> = None;
        Some(Stage::Command(Box::new(move |t_s, action| {
            waiting.push_back((t_s, action));
            // Half a microsecond: times are multiples of the tick, computed by one rounding each.
            while waiting.front().is_some_and(|(given_s, _)| given_s + delay_s <= t_s + 5e-7) {
                in_force = waiting.pop_front().map(|(_, action)| action);
            }
            in_force.unwrap_or(STANDING)
        })))
    }
}

/// Before the first delayed command arrives; to a car it says as little as silence, so that its brake holds.
const STANDING: Action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: 0.0, atheta_rad_per_s: 0.0 };
