//! The discrete actions of chapter 4: the list that a table of velocities has an entry for.

use std::f64::consts::FRAC_1_SQRT_2;

use asami_dataset::Action;

asami_dataset::parameters! {
    /// What the normalised attempted velocities of the actions are multiples of.
    pub struct Suite {
        /// Attempted rightward velocity at 1.
        max_right_m_per_s: f64 = 0.35, "m/s", 0.01..=2.0;
        /// Attempted forward velocity at 1.
        max_forward_m_per_s: f64 = 0.4, "m/s", 0.01..=2.0;
        /// Attempted turning rate at 1.
        max_turn_rad_per_s: f64 = 3.0, "rad/s", 0.01..=10.0;
    }
}

/// Omega, the turning rates as fractions of the greatest one, in the order of `k_omega`.
const TURNS: [f64; 5] = [-1.0 / 2.0, -1.0 / 6.0, 0.0, 1.0 / 6.0, 1.0 / 2.0];

/// `(cos psi, sin psi)` for psi = `k_psi` pi/4: right, then counter-clockwise.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// Normalised attempted velocities of the 40 actions in the order of their ids `8 k_omega + k_psi`:
/// right, forward, counter-clockwise.
pub fn normalised() -> impl Iterator<Item = [f64; 3]> {
    TURNS.into_iter().flat_map(|omega| {
        DIRECTIONS.into_iter().map(move |[cos_psi, sin_psi]| {
            // a_theta = omega, a_x = cos(psi) sqrt(1 - a_theta^2), a_y = sin(psi) sqrt(1 - a_theta^2)
            // (Stronger 2008, equations 4.29 to 4.31)
            let across = (1.0 - omega * omega).sqrt();
            [cos_psi * across, sin_psi * across, omega]
        })
    })
}

impl Suite {
    /// The 40 actions, in the order of their ids.
    #[must_use]
    pub fn actions(&self) -> Vec<Action> {
        (0..).zip(normalised()).map(|(id, [right, forward, turn])| self.action(id, right, forward, turn)).collect()
    }

    /// The 21 forward and backward actions of section 4.4.3, normalised -1 to 1 in steps of 0.1; the
    /// id 10 stands still.
    #[must_use]
    pub fn strides(&self) -> Vec<Action> {
        (0..=20).map(|id| self.action(id, 0.0, (f64::from(id) - 10.0) / 10.0, 0.0)).collect()
    }

    fn action(&self, id: u16, right: f64, forward: f64, turn: f64) -> Action {
        Action::Legs {
            id: Some(id),
            ax_m_per_s: right * self.max_right_m_per_s,
            ay_m_per_s: forward * self.max_forward_m_per_s,
            atheta_rad_per_s: turn * self.max_turn_rad_per_s,
        }
    }
}
