//! What sections 4.4.1 and 4.4.2 print: D. Stronger, *Autonomous Sensor and Action Model Learning for
//! Mobile Robots*, University of Texas at Austin, 2008.

use crate::scenario::{Origin, Robot, Scenario, Start};
use crate::sweep::table::Published;

const EM: Published = Published {
    learner: "em_published",
    start: Some(Start::Published),
    era: None,
    truth: None,
    values: &[],
    place: "",
};

/// The simulation.
const SIMULATED: &[Published] = &[Published {
    values: &[
        ("vx_rmse_mm_per_s", 23.06),
        ("vy_rmse_mm_per_s", 18.34),
        ("vtheta_rmse_rad_per_s", 0.086),
        ("vx_percent", 3.2),
        ("vy_percent", 2.2),
        ("vtheta_percent", 2.7),
        ("sigma1_px", 0.980),
        ("sigma1_true_px", 1.0),
        ("sigma1_off_percent", 2.0),
        ("sigma2_rad", 0.474),
        ("sigma2_true_rad", 0.5),
        ("sigma2_off_percent", 5.3),
        ("iterations", 959.0),
        ("observations", 8659.0),
        ("log_likelihood_start_per_observation", -50881.0 / 8659.0),
    ],
    place: "section 4.4.2",
    ..EM
}];

/// The robot.
const WALKED: &[Published] = &[
    Published {
        values: &[
            ("vtheta_rmse_rad_per_s", 0.135),
            ("vtheta_percent", 3.2),
            ("sigma1_px", 1.69),
            ("sigma1_true_px", 1.59),
            ("sigma1_off_percent", 6.3),
            ("sigma2_rad", 0.0116),
            ("sigma2_true_rad", 0.0267),
            ("sigma2_off_percent", 100.0 * (1.0 - 0.0116 / 0.0267)),
            ("iterations", 152.0),
            ("observations", 5639.0),
            ("log_likelihood_start_per_observation", -23000.0 / 5639.0),
        ],
        place: "section 4.4.1",
        ..EM
    },
    Published {
        learner: "unlearned",
        start: Some(Start::Attempted),
        values: &[("vtheta_rmse_rad_per_s", 0.331), ("vtheta_percent", 7.9)],
        place: "section 4.4.1",
        ..EM
    },
];

/// What stands beside a scenario's results; nothing beside those of other robots than the dissertation's.
#[must_use]
pub fn of(scenario: &Scenario) -> &'static [Published] {
    match &scenario.origin {
        Origin::Simulated(simulation) => match simulation.robot {
            Robot::Plain => SIMULATED,
            Robot::Aibo => WALKED,
            Robot::Create | Robot::Car => &[],
        },
        Origin::Recorded(_) => &[],
    }
}
