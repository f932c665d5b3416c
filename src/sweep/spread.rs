//! Statistics of one quantity over a row's trials.

use asami_dataset::Seed;
use asami_math::statistics;

use crate::scenario::{Era, Row, Start};

/// Resamplings of a bootstrap interval.
const RESAMPLES: usize = 2000;

/// One quantity over a row's converged trials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean, as the dissertation prints it.
    pub mean: f64,
    /// Standard deviation with n - 1, as the dissertation prints it; `None` for one trial.
    pub sd: Option<f64>,
    /// Median.
    pub median: f64,
    /// Mean of the middle half.
    pub interquartile_mean: f64,
    /// 95 % bootstrap interval of the mean.
    pub interval: Option<[f64; 2]>,
}

impl Spread {
    /// Of `values`; `stream` names the bootstrap's own random numbers. `None` without values.
    #[must_use]
    pub fn of(values: &[f64], stream: &str) -> Option<Self> {
        let mut rng = Seed(0).stream(stream);
        Some(Self {
            mean: statistics::mean(values)?,
            sd: statistics::standard_deviation(values),
            median: statistics::median(values)?,
            interquartile_mean: statistics::interquartile_mean(values)?,
            interval: statistics::bootstrap_interval(values, 0.95, RESAMPLES, &mut rng),
        })
    }
}

/// The name of a row's random numbers for the bootstrap of a quantity.
#[must_use]
pub fn stream(row: &Row, quantity: &str) -> String {
    let start = row.start.map_or("", Start::name);
    let era = if row.era == Era::After { "/after" } else { "" };
    format!("bootstrap/{}/{start}/{}{era}/{quantity}", row.label, row.duration_s)
}
