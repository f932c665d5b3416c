//! The car's models as published: angles by correlation, odometry by scan matching, the action model by regression.

use asami_dataset::{Log, Models, Rng};

use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Cut, Matching, Sensor};

learner! {
    /// Stronger 2008, Algorithm 3.
    ///
    /// What the dissertation leaves open, and is done here: lags at which fewer than a tenth of the most firings overlap are passed
    /// over, and of equal peaks the smallest lag is taken; a step of the firings is the encoder's mean advance; a scan is the full turn
    /// that begins at a multiple of the interval, all its returns kept; Algorithm 2 has converged when the points would move by less
    /// than 0.1 mm; the outer loop, when no motion changes by more than 1 mm, a turn counting at 10 m; the action model predicts
    /// from the first measured speed on, open-loop. Standard errors of the angles are those of sums of lags rounded to steps, with that of
    /// an angle median; those of the coefficients, the regressions'.
    CarPublished, "car_published",
    "Learns a scanner's angles by correlation, the car's motion by scan matching and its action model by regression, as published.",
    source "Stronger 2008, chapter 5, Algorithm 3", needs Firings,
    {
        /// Lags are tried up to this angle to both sides; the dissertation's quick run took 23 degrees.
        most_lag_deg: f64 = 180.0, "deg", 1.0..=180.0;
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Points more than this below the sensor are dropped.
        ground_below_m: f64 = 1.0, "m", -5.0..=10.0;
        /// Points farther from their nearest than this do not count.
        gate_m: f64 = 7.0, "m", 0.1..=100.0;
        /// Slower motions do not tell which way is forward.
        slow_m_per_s: f64 = 2.0, "m/s", 0.0..=50.0;
        /// Scans are matched anew with the action model so many times at most.
        max_iterations: u32 = 10, "1", 1.0..=100.0;
    }
}

impl CarPublished {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        Car {
            sensor: Sensor { most_lag_rad: self.most_lag_deg.to_radians(), ..Sensor::published() },
            interval_s: self.scan_interval_s,
            cut: Cut { lowest_m: -self.ground_below_m, ..Car::published().cut },
            matching: Matching { gate_m: self.gate_m, ..Matching::published() },
            slow_m_per_s: self.slow_m_per_s,
            max_iterations: self.max_iterations,
            ..Car::published()
        }
    }
}

impl Learner for CarPublished {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
