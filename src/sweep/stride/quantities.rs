//! What is measured of a trial along the line, each under the name of its column in `trials.csv`.

use super::{ByEra, Truth};
use crate::scorer::stride::Scores;
use crate::sweep::quantity::{Quantity, names};
use crate::trial;

type Trial = trial::Trial<ByEra<Scores>>;

/// What a trial has, held against the truth of one era.
pub type Of = fn(&Trial, &Scores, &Truth) -> Option<f64>;

/// All of them; the first three are the last of the agreed columns.
pub const QUANTITIES: [Quantity<Of>; 10] = [
    Quantity { name: "action_rmse_mm_per_s", of: |_, scores, _| Some(1e3 * scores.action_rmse_m_per_s?) },
    Quantity { name: "sensor_rmse_px", of: |_, scores, _| scores.sensor_rmse_px },
    Quantity { name: "scale_ratio", of: |_, scores, _| scores.scale_ratio() },
    Quantity { name: "scale_off", of: |_, scores, _| Some((scores.scale_ratio()? - 1.0).abs()) },
    Quantity {
        name: "action_percent",
        of: |_, scores, truth| Some(100.0 * scores.action_rmse_m_per_s? / truth.speed_range_m_per_s?),
    },
    Quantity {
        name: "sensor_percent",
        of: |_, scores, truth| Some(100.0 * scores.sensor_rmse_px? / truth.height_range_px?),
    },
    Quantity { name: "iterations", of: |trial, _, _| trial.iterations.map(f64::from) },
    Quantity { name: "observations", of: |trial, _, _| Some(trial.observations as f64).filter(|n| *n > 0.0) },
    Quantity { name: "log_likelihood_start", of: |trial, _, _| Some(trial.likelihood?.start) },
    Quantity { name: "log_likelihood_best", of: |trial, _, _| Some(trial.likelihood?.best) },
];

/// Their names.
pub const NAMES: [&str; QUANTITIES.len()] = names(&QUANTITIES);
