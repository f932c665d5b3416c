//! The tables of chapter 5.

use crate::sweep::table::{Plan, column};

/// In the order of the report.
pub const TABLES: [Plan; 3] = [
    Plan {
        name: "table_5_1",
        title: "Table 5.1, and the lasers' angles",
        caption: "Root mean square errors of the learned action model, rolled out open-loop over the whole drive from its \
                  first speed, against the reference, and of the lasers' angles as they are: median over the trials that \
                  converged, in brackets mean \u{b1} standard deviation. `from_truth` is the same action model fitted to \
                  the reference's own motions. Good: at or under the dissertation's.",
        columns: &[
            column("acceleration_rmse_m_per_s2", "acceleration (m/s^2)", 3),
            column("acceleration_percent", "% of range", 2),
            column("speed_rmse_m_per_s", "speed (m/s)", 3),
            column("speed_percent", "% of range", 2),
            column("yaw_rate_rmse_rad_per_s", "yaw rate (rad/s)", 4),
            column("yaw_rate_percent", "% of range", 2),
            column("angle_rms_deg", "angles (deg)", 3),
            column("angle_percent", "% of range", 2),
        ],
        start: None,
    },
    Plan {
        name: "table_5_angles",
        title: "Angles of the lasers",
        caption: "Root mean square over the lasers of learned less true angles, as they are and less what all have in common; \
                  the greatest error of the angle between two adjacent lasers; and the share of angles whose 95 % intervals, \
                  from the learner's standard errors, hold the truth (good: 0.90 to 0.97).",
        columns: &[
            column("angle_rms_deg", "RMS (deg)", 3),
            column("angle_rms_common_removed_deg", "common removed (deg)", 3),
            column("worst_pair_deg", "worst pair (deg)", 3),
            column("angle_coverage", "coverage", 3),
        ],
        start: None,
    },
    Plan {
        name: "table_5_odometry",
        title: "Odometry, and one step ahead",
        caption: "Root mean square errors of the motions that the learner saw from scan to scan, against the exact track; and \
                  of the acceleration by the action model at the reference's own speed, one step ahead, which is no \
                  roll-out. Iterations are the method's own; times are in `timings.csv`.",
        columns: &[
            column("odometry_v_rmse_m_per_s", "speed (m/s)", 4),
            column("odometry_omega_rmse_rad_per_s", "yaw rate (rad/s)", 5),
            column("one_step_acceleration_rmse_m_per_s2", "acceleration, one step (m/s^2)", 3),
            column("one_step_acceleration_percent", "% of range", 2),
            column("iterations", "iterations", 0),
        ],
        start: None,
    },
];
