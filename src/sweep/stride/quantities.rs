//! What is measured of a trial along the line, each under the name of its column in `trials.csv`.

use super::Truth;
use crate::scorer::stride::Scores;

/// A number that models have against one era's truth, or not.
#[derive(Clone, Copy)]
pub struct Quantity {
    /// Its column.
    pub name: &'static str,
    /// Its value, if it has one.
    pub of: fn(&Scores, &Truth) -> Option<f64>,
}

/// All of them, in the order of their columns.
pub const QUANTITIES: [Quantity; 5] = [
    Quantity { name: "action_rmse_mm_per_s", of: |scores, _| Some(1e3 * scores.action_rmse_m_per_s?) },
    Quantity { name: "sensor_rmse_px", of: |scores, _| scores.sensor_rmse_px },
    Quantity { name: "scale_ratio", of: |scores, _| scores.scale_ratio() },
    Quantity {
        name: "action_percent",
        of: |scores, truth| Some(100.0 * scores.action_rmse_m_per_s? / truth.speed_range_m_per_s?),
    },
    Quantity {
        name: "sensor_percent",
        of: |scores, truth| Some(100.0 * scores.sensor_rmse_px? / truth.height_range_px?),
    },
];

/// Their names.
pub const NAMES: [&str; QUANTITIES.len()] = {
    let mut names = [""; QUANTITIES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = QUANTITIES[i].name;
        i += 1;
    }
    names
};
