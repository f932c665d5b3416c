//! What section 5.4 prints: D. Stronger, *Autonomous Sensor and Action Model Learning for Mobile Robots*, University of
//! Texas at Austin, 2008.

use crate::scenario::{Origin, Scenario};
use crate::sweep::table::Published;

const LINE: Published =
    Published { learner: "car_published", start: None, era: None, truth: None, values: &[], place: "section 5.4" };

/// The errors of the angles and Table 5.1.
const PRINTED: &[Published] = &[
    Published {
        values: &[
            ("angle_rms_deg", 0.544),
            ("angle_percent", 3.0),
            ("acceleration_rmse_m_per_s2", 0.392),
            ("acceleration_percent", 6.77),
            ("speed_rmse_m_per_s", 1.04),
            ("speed_percent", 16.5),
            ("yaw_rate_rmse_rad_per_s", 0.0129),
            ("yaw_rate_percent", 6.39),
            ("iterations", 4.0),
        ],
        ..LINE
    },
    Published {
        learner: "from_truth",
        values: &[
            ("acceleration_rmse_m_per_s2", 0.254),
            ("speed_rmse_m_per_s", 0.64),
            ("yaw_rate_rmse_rad_per_s", 0.013),
        ],
        ..LINE
    },
];

/// What stands beside a scenario's results; nothing beside those of a recording.
#[must_use]
pub fn of(scenario: &Scenario) -> &'static [Published] {
    match &scenario.origin {
        Origin::Simulated(_) => PRINTED,
        Origin::Recorded(_) => &[],
    }
}
