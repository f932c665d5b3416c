//! Statistics over a row's trials, and paired comparisons of rows.

use asami_math::statistics;

use super::Chapter3;
use crate::scorer::line::Scores;
use crate::sweep::spread::{Spread, stream};
use crate::sweep::{Record, Results};
use crate::trial::{self, Ending};

type Trial = trial::Trial<Scores>;

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Which of the scenario's rows.
    pub row: usize,
    /// Sensor model's error in metres.
    pub sensor_rmse_m: Option<Spread>,
    /// Action model's error in m/s.
    pub action_rmse_m_per_s: Option<Spread>,
    /// `| |k|/|b| - 1 |` (section 3.3.2).
    pub scale_difference: Option<Spread>,
    /// Degree of the sensor model.
    pub sensor_degree: Option<Spread>,
    /// How many trials converged.
    pub converged: usize,
    /// Of how many.
    pub trials: usize,
}

/// One row against another, over the logs on which both converged.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The row.
    pub row: usize,
    /// The row that it is held against.
    pub against: usize,
    /// What is compared.
    pub quantity: &'static str,
    /// On how many logs.
    pub pairs: usize,
    /// Median of the differences, row less `against`, in metres or m/s.
    pub median_difference: f64,
    /// Two-sided p of Wilcoxon's signed-rank test.
    pub p: f64,
}

/// The summary of every row, in order. Overlapping windows are left out: they would count data twice.
#[must_use]
pub fn summaries(results: &Results<Chapter3>) -> Vec<Summary> {
    (0..results.scenario.rows.len()).map(|row| summary(results, row)).collect()
}

fn summary(results: &Results<Chapter3>, row: usize) -> Summary {
    let trials: Vec<&Trial> = results.counted().filter_map(|record| record.trials.get(row)).collect();
    let converged: Vec<&Trial> = trials.iter().copied().filter(|trial| trial.ending == Ending::Converged).collect();
    let of = |name: &str, value: fn(&Trial) -> Option<f64>| {
        let values: Vec<f64> = converged.iter().filter_map(|trial| value(trial)).collect();
        Spread::of(&values, &stream(&results.scenario.rows[row], name))
    };
    Summary {
        row,
        sensor_rmse_m: of("sensor", |trial| trial.scores.sensor_rmse_m),
        action_rmse_m_per_s: of("action", |trial| trial.scores.action_rmse_m_per_s),
        scale_difference: of("scale", |trial| trial.scores.scale_ratio().map(|ratio| (ratio - 1.0).abs())),
        sensor_degree: of("degree", |trial| trial.sensor_degree.map(|degree| degree as f64)),
        converged: converged.len(),
        trials: trials.len(),
    }
}

/// Every row that needs no starting model against every row of Algorithm 1 as published, of the same
/// duration.
#[must_use]
pub fn comparisons(results: &Results<Chapter3>) -> Vec<Comparison> {
    let rows = &results.scenario.rows;
    let mut found = Vec::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| row.start.is_none()) {
        for (j, other) in rows.iter().enumerate() {
            if other.label != "algorithm1" || other.duration_s != row.duration_s {
                continue;
            }
            let sensor = compare(results, i, j, "sensor_rmse", |scores| scores.sensor_rmse_m);
            let action = compare(results, i, j, "action_rmse", |scores| scores.action_rmse_m_per_s);
            // A learner of one model alone has been told the other, or does less.
            if let (Some(sensor), Some(action)) = (sensor, action) {
                found.extend([sensor, action]);
            }
        }
    }
    found
}

fn compare(
    results: &Results<Chapter3>,
    row: usize,
    against: usize,
    quantity: &'static str,
    value: fn(&Scores) -> Option<f64>,
) -> Option<Comparison> {
    let of = |record: &Record<Chapter3>, row: usize| {
        let trial = record.trials.get(row).filter(|trial| trial.ending == Ending::Converged)?;
        value(&trial.scores)
    };
    let differences: Vec<f64> =
        results.counted().filter_map(|record| Some(of(record, row)? - of(record, against)?)).collect();
    Some(Comparison {
        row,
        against,
        quantity,
        pairs: differences.len(),
        median_difference: statistics::median(&differences)?,
        p: statistics::wilcoxon_signed_rank(&differences)?,
    })
}
