//! The tables of sections 4.4.1 and 4.4.2.

use crate::scenario::Start;
use crate::sweep::table::{Plan, column};

/// In the order of the report.
pub const TABLES: [Plan; 6] = [
    Plan {
        name: "table_4",
        title: "Chapter 4 in short",
        caption: "Every learner from the published start (no motion, a poor linear f): errors of the velocities, of f and \
                  of the learned noise, and passes over the data; median over the trials that converged, in brackets mean \
                  \u{b1} standard deviation. `unlearned` is the start as it is, `floor` the best cubic f, `bound` the least that an \
                  unbiased learner with these data can err (Cram\u{e9}r and Rao).",
        columns: &[
            column("vx_rmse_mm_per_s", "v_x (mm/s)", 1),
            column("vy_rmse_mm_per_s", "v_y (mm/s)", 1),
            column("vtheta_rmse_rad_per_s", "v_theta (rad/s)", 3),
            column("sensor_rmse_px", "f (px)", 2),
            column("sensor_rmse_mm", "f (mm)", 1),
            column("sigma1_off_percent", "sigma_1 off (%)", 1),
            column("sigma2_off_percent", "sigma_2 off (%)", 1),
            column("iterations", "iterations", 0),
        ],
        start: Some(Start::Published),
    },
    Plan {
        name: "table_4_velocities",
        title: "Velocities",
        caption: "Root mean square errors of the learned velocities over the actions: median over the trials that \
                  converged, in brackets mean \u{b1} standard deviation. `unlearned` is a starting model as it is, \
                  `bound` the least that an unbiased learner with these data can err (Cram\u{e9}r and Rao). Good: near \
                  the bound, and at or under the dissertation's.",
        columns: &[
            column("vx_rmse_mm_per_s", "v_x (mm/s)", 2),
            column("vx_percent", "% of range", 2),
            column("vx_to_bound", "x bound", 2),
            column("vy_rmse_mm_per_s", "v_y (mm/s)", 2),
            column("vy_percent", "% of range", 2),
            column("vy_to_bound", "x bound", 2),
            column("vtheta_rmse_rad_per_s", "v_theta (rad/s)", 4),
            column("vtheta_percent", "% of range", 2),
            column("vtheta_to_bound", "x bound", 2),
        ],
        start: None,
    },
    Plan {
        name: "table_4_sensor",
        title: "Sensor function",
        caption: "Root mean square of the learned f less the mean sizes at the surveyed distances, which count alike. \
                  `floor` is the best cubic. The dissertation shows its f in figures only.",
        columns: &[
            column("sensor_rmse_px", "f (px)", 3),
            column("sensor_rmse_mm", "f (mm)", 2),
            column("sensor_percent", "% of range", 2),
        ],
        start: None,
    },
    Plan {
        name: "table_4_noise",
        title: "Noise",
        caption: "Learned standard deviations of sizes and bearings, the true ones (variances at the surveyed \
                  distances, weighted by how often each distance occurred), and by how many percent the learned ones \
                  are off, either way.",
        columns: &[
            column("sigma1_px", "sigma_1 (px)", 3),
            column("sigma1_true_px", "true", 3),
            column("sigma1_mm", "sigma_1 (mm)", 2),
            column("sigma1_true_mm", "true", 2),
            column("sigma1_off_percent", "off (%)", 1),
            column("sigma2_rad", "sigma_2 (rad)", 4),
            column("sigma2_true_rad", "true", 4),
            column("sigma2_off_percent", "off (%)", 1),
        ],
        start: None,
    },
    Plan {
        name: "table_4_convergence",
        title: "Convergence",
        caption: "Passes over the data until the method's own rule stopped it, and log-likelihoods in nats per \
                  sighting, which hang on the units (px or m, and rad). Times are in `timings.csv`.",
        columns: &[
            column("iterations", "iterations", 0),
            column("observations", "sightings", 0),
            column("log_likelihood_start_per_observation", "log-likelihood at the start", 3),
            column("log_likelihood_best_per_observation", "best", 3),
        ],
        start: None,
    },
    Plan {
        name: "table_4_consistency",
        title: "Consistency",
        caption: "Whether learned models know their own errors. Coverage: share of the learned velocities whose 95 % \
                  intervals, from the learner's standard errors, hold the truth; good: 0.90 to 0.97. NIS: mean \
                  normalised innovation squared of a filter with the learned models, by its degrees of freedom; good: \
                  near 1, above it the models are too sure of themselves, below it not sure enough. Motion noise is as \
                  given, or learned where the method learns it.",
        columns: &[
            column("coverage", "coverage", 3),
            column("nis", "NIS", 3),
            column("motion_right_sd_mm", "right (mm a step)", 2),
            column("motion_forward_sd_mm", "forward (mm a step)", 2),
            column("motion_turn_sd_rad", "turn (rad a step)", 4),
        ],
        start: None,
    },
];
