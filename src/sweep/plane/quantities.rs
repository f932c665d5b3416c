//! What is measured of a trial in the plane, each under the name of its column in `trials.csv`.

use super::Truth;
use crate::scorer::plane::Scores;
use crate::sweep::quantity::{Quantity, names};
use crate::trial;

type Trial = trial::Trial<Scores>;

/// What a trial has, held against the truth.
pub type Of = fn(&Trial, &Truth) -> Option<f64>;

/// All of them, in the order of their columns.
pub const QUANTITIES: [Quantity<Of>; 31] = [
    Quantity { name: "iterations", of: |trial, _| trial.iterations.map(f64::from) },
    Quantity { name: "vx_rmse_mm_per_s", of: |trial, _| Some(1e3 * trial.scores.velocity_rmse?[0]) },
    Quantity { name: "vy_rmse_mm_per_s", of: |trial, _| Some(1e3 * trial.scores.velocity_rmse?[1]) },
    Quantity { name: "vtheta_rmse_rad_per_s", of: |trial, _| Some(trial.scores.velocity_rmse?[2]) },
    Quantity { name: "sensor_rmse_px", of: |trial, truth| pixels(truth, trial.scores.sensor_rmse) },
    Quantity { name: "sensor_rmse_mm", of: |trial, truth| millimetres(truth, trial.scores.sensor_rmse) },
    Quantity { name: "sigma1_px", of: |trial, truth| pixels(truth, trial.scores.sigma1) },
    Quantity { name: "sigma1_mm", of: |trial, truth| millimetres(truth, trial.scores.sigma1) },
    Quantity { name: "sigma2_rad", of: |trial, _| trial.scores.sigma2_rad },
    Quantity { name: "sigma1_true_px", of: |_, truth| pixels(truth, truth.sigma1) },
    Quantity { name: "sigma1_true_mm", of: |_, truth| millimetres(truth, truth.sigma1) },
    Quantity { name: "sigma2_true_rad", of: |_, truth| truth.sigma2_rad },
    Quantity { name: "vx_percent", of: |trial, truth| percent(trial, truth, 0) },
    Quantity { name: "vy_percent", of: |trial, truth| percent(trial, truth, 1) },
    Quantity { name: "vtheta_percent", of: |trial, truth| percent(trial, truth, 2) },
    Quantity { name: "vx_to_bound", of: |trial, truth| to_bound(trial, truth, 0) },
    Quantity { name: "vy_to_bound", of: |trial, truth| to_bound(trial, truth, 1) },
    Quantity { name: "vtheta_to_bound", of: |trial, truth| to_bound(trial, truth, 2) },
    Quantity { name: "sensor_percent", of: |trial, truth| Some(100.0 * trial.scores.sensor_rmse? / truth.size_range?) },
    Quantity { name: "sigma1_off_percent", of: |trial, truth| off(trial.scores.sigma1, truth.sigma1) },
    Quantity { name: "sigma2_off_percent", of: |trial, truth| off(trial.scores.sigma2_rad, truth.sigma2_rad) },
    Quantity { name: "motion_right_sd_mm", of: |trial, _| Some(1e3 * trial.scores.motion_sd?[0]) },
    Quantity { name: "motion_forward_sd_mm", of: |trial, _| Some(1e3 * trial.scores.motion_sd?[1]) },
    Quantity { name: "motion_turn_sd_rad", of: |trial, _| Some(trial.scores.motion_sd?[2]) },
    Quantity { name: "coverage", of: |trial, _| coverage(&trial.scores) },
    Quantity { name: "nis", of: |trial, _| trial.scores.nis },
    Quantity { name: "observations", of: |trial, _| Some(trial.observations as f64).filter(|n| *n > 0.0) },
    Quantity { name: "log_likelihood_start", of: |trial, _| Some(trial.likelihood?.start) },
    Quantity { name: "log_likelihood_best", of: |trial, _| Some(trial.likelihood?.best) },
    Quantity {
        name: "log_likelihood_start_per_observation",
        of: |trial, _| Some(trial.likelihood?.start / trial.observations as f64),
    },
    Quantity {
        name: "log_likelihood_best_per_observation",
        of: |trial, _| Some(trial.likelihood?.best / trial.observations as f64),
    },
];

/// Their names.
pub const NAMES: [&str; QUANTITIES.len()] = names(&QUANTITIES);

fn pixels(truth: &Truth, size: Option<f64>) -> Option<f64> {
    size.filter(|_| !truth.in_metres)
}

fn millimetres(truth: &Truth, size: Option<f64>) -> Option<f64> {
    size.filter(|_| truth.in_metres).map(|metres| 1e3 * metres)
}

fn percent(trial: &Trial, truth: &Truth, i: usize) -> Option<f64> {
    Some(100.0 * trial.scores.velocity_rmse?[i] / truth.velocity_ranges?[i])
}

/// An error as a multiple of the least that an unbiased learner can have.
fn to_bound(trial: &Trial, truth: &Truth, i: usize) -> Option<f64> {
    Some(trial.scores.velocity_rmse?[i] / truth.bound?[i])
}

/// How far a learned standard deviation is off, either way.
fn off(learned: Option<f64>, truth: Option<f64>) -> Option<f64> {
    Some(100.0 * (learned? / truth? - 1.0).abs())
}

fn coverage(scores: &Scores) -> Option<f64> {
    let [inside, of] = scores.covered?;
    Some(f64::from(inside) / f64::from(of))
}
