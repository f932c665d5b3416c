//! All actions, all over the field (Stronger 2008, section 4.4.1).

use asami_dataset::{Action, Rng, TruePose};
use asami_math::elementary::{exp, sin_cos};
use rand::RngExt;

use crate::world::{Drive, Seen};

asami_dataset::parameters! {
    /// The policy of chapter 4: every few seconds another action, chosen at random "with priorities being
    /// placed on staying on the field and on distributing the executed actions evenly".
    pub struct Exploring {
        /// How long each action is executed.
        hold_s: f64 = 5.0, "s", 0.1..=60.0;
        /// Extent of the field along world x, about the origin.
        field_x_m: f64 = 3.6, "m", 0.1..=100.0;
        /// Extent of the field along world y, about the origin.
        field_y_m: f64 = 5.4, "m", 0.1..=100.0;
        /// A path should stay this far inside the field's edge.
        margin_m: f64 = 0.3, "m", 0.0..=10.0;
        /// Each such length that an action's path would come nearer to the edge, or go beyond it, makes the
        /// action e times less likely.
        outside_m: f64 = 0.05, "m", 0.001..=10.0;
        /// Each such number of executions more than those of the rarest action makes an action e times less
        /// likely.
        surplus: f64 = 0.35, "1", 0.01..=100.0;
    }
}

/// [`Exploring`] under way. It predicts by the attempted velocities, from where the localisation module
/// says that the robot is; without one it only balances.
pub struct Explore {
    exploring: Exploring,
    actions: Vec<Action>,
    executed: Vec<u32>,
    rng: Rng,
    pose: Option<TruePose>,
    current: Option<(f64, Action)>,
}

/// Points at which a predicted path is compared with the field.
const POINTS: u32 = 20;

impl Explore {
    /// Chooses among `actions`; `rng` draws.
    #[must_use]
    pub fn new(exploring: Exploring, actions: Vec<Action>, rng: Rng) -> Self {
        Self { exploring, executed: vec![0; actions.len()], actions, rng, pose: None, current: None }
    }

    /// How far `action` would take the robot out of the field less its margin.
    fn outside_m(&self, from: &TruePose, action: &Action) -> f64 {
        let Action::Legs { ax_m_per_s, ay_m_per_s, atheta_rad_per_s, .. } = *action else { return 0.0 };
        let half_m = [self.exploring.field_x_m, self.exploring.field_y_m].map(|m| 0.5 * m - self.exploring.margin_m);
        let step_s = self.exploring.hold_s / f64::from(POINTS);
        let (mut at_m, mut worst_m) = ([from.x_m, from.y_m], 0.0);
        for point in 0..POINTS {
            let turned_s = (f64::from(point) + 0.5) * step_s;
            let (sin, cos) = sin_cos(from.theta_rad + atheta_rad_per_s * turned_s);
            at_m[0] += (ax_m_per_s * cos - ay_m_per_s * sin) * step_s;
            at_m[1] += (ax_m_per_s * sin + ay_m_per_s * cos) * step_s;
            for (coordinate_m, half_m) in at_m.iter().zip(half_m) {
                let beyond_m = coordinate_m.abs() - half_m;
                if beyond_m > worst_m {
                    worst_m = beyond_m;
                }
            }
        }
        worst_m
    }

    /// Draws an action, and counts it.
    fn choose(&mut self) -> Option<Action> {
        let fewest = *self.executed.iter().min()?;
        let costs = self.actions.iter().zip(&self.executed).map(|(action, executed)| {
            let outside_m = self.pose.as_ref().map_or(0.0, |pose| self.outside_m(pose, action));
            outside_m / self.exploring.outside_m + f64::from(executed - fewest) / self.exploring.surplus
        });
        let costs: Vec<f64> = costs.collect();
        // Less the least cost, so that the sum is never zero.
        let least = costs.iter().copied().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let weights: Vec<f64> = costs.iter().map(|cost| exp(least - cost)).collect();
        let mut left = self.rng.random::<f64>() * weights.iter().sum::<f64>();
        let drawn = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        // Rounding may leave a crumb after the last.
        let chosen = drawn.unwrap_or(weights.len() - 1);
        self.executed[chosen] += 1;
        Some(self.actions[chosen])
    }
}

impl Drive for Explore {
    fn localise(&mut self, pose: &TruePose) {
        self.pose = Some(*pose);
    }

    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        // The tick's time is a rounded multiple of the period: half a tick of slack.
        let held = self.current.filter(|(since_s, _)| t_s - since_s < self.exploring.hold_s - 1e-6);
        let (since_s, action) = held.unwrap_or_else(|| (t_s, self.choose().unwrap_or(STANDING)));
        self.current = Some((since_s, action));
        action
    }
}

/// Of a robot without actions.
const STANDING: Action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: 0.0, atheta_rad_per_s: 0.0 };
