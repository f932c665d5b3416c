//! What is measured of a trial of chapter 5, each under the name of its column in `trials.csv`.

use super::Truth;
use crate::scorer::car::Scores;
use crate::sweep::quantity::{Quantity, names};
use crate::trial;

type Trial = trial::Trial<Scores>;

/// What a trial has, held against the truth.
pub type Of = fn(&Trial, &Truth) -> Option<f64>;

/// All of them, in the order of their columns.
pub const QUANTITIES: [Quantity<Of>; 16] = [
    Quantity { name: "angle_rms_deg", of: |trial, _| Some(trial.scores.angles?.rms_rad.to_degrees()) },
    Quantity {
        name: "angle_rms_common_removed_deg",
        of: |trial, _| Some(trial.scores.angles?.rms_common_removed_rad.to_degrees()),
    },
    Quantity { name: "worst_pair_deg", of: |trial, _| Some(trial.scores.angles?.worst_pair_rad.to_degrees()) },
    Quantity { name: "odometry_v_rmse_m_per_s", of: |trial, _| Some(trial.scores.odometry_rmse?[0]) },
    Quantity { name: "odometry_omega_rmse_rad_per_s", of: |trial, _| Some(trial.scores.odometry_rmse?[1]) },
    Quantity { name: "acceleration_rmse_m_per_s2", of: |trial, _| Some(trial.scores.rolled_rmse?[0]) },
    Quantity { name: "speed_rmse_m_per_s", of: |trial, _| Some(trial.scores.rolled_rmse?[1]) },
    Quantity { name: "yaw_rate_rmse_rad_per_s", of: |trial, _| Some(trial.scores.rolled_rmse?[2]) },
    Quantity { name: "iterations", of: |trial, _| trial.iterations.map(f64::from) },
    Quantity {
        name: "angle_percent",
        of: |trial, truth| Some(100.0 * trial.scores.angles?.rms_rad / truth.angle_range_rad?),
    },
    Quantity { name: "angle_coverage", of: |trial, _| coverage(trial.scores.angles?.covered) },
    Quantity { name: "acceleration_percent", of: |trial, truth| percent(trial, truth, 0) },
    Quantity { name: "speed_percent", of: |trial, truth| percent(trial, truth, 1) },
    Quantity { name: "yaw_rate_percent", of: |trial, truth| percent(trial, truth, 2) },
    Quantity { name: "one_step_acceleration_rmse_m_per_s2", of: |trial, _| trial.scores.one_step_rmse },
    Quantity {
        name: "one_step_acceleration_percent",
        of: |trial, truth| Some(100.0 * trial.scores.one_step_rmse? / truth.ranges?[0]),
    },
];

/// Their names.
pub const NAMES: [&str; QUANTITIES.len()] = names(&QUANTITIES);

fn percent(trial: &Trial, truth: &Truth, i: usize) -> Option<f64> {
    Some(100.0 * trial.scores.rolled_rmse?[i] / truth.ranges?[i])
}

fn coverage([inside, of]: [u32; 2]) -> Option<f64> {
    (of > 0).then(|| f64::from(inside) / f64::from(of))
}
