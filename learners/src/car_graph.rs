//! The lasers' angles by lags between the steps of the firings, over a graph of pairs.

use asami_dataset::{Log, Models, Rng};

use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Sensor};

learner! {
    /// As published, but for the angles: the logarithm of the range less its running mean is correlated, peaks are found between the steps
    /// of the firings, and all pairs of lasers up to `reach` apart are fitted at once with robust weights. Standard errors are the
    /// regression's.
    CarGraph, "car_graph",
    "As published, but with high-passed log ranges, lags between steps, and least squares over many pairs in place of the chain.",
    source "this project; Stronger 2008, section 5.1", needs Firings,
    {
        /// Lags are tried up to this angle to both sides.
        most_lag_deg: f64 = 23.0, "deg", 1.0..=180.0;
        /// The running mean reaches this far to both sides.
        high_pass_deg: f64 = 5.0, "deg", 0.5..=90.0;
        /// Nearer returns are left out: they are the car's own.
        near_m: f64 = 3.0, "m", 0.0..=20.0;
        /// Pairs up to so many lasers apart are correlated.
        reach: u32 = 6, "1", 1.0..=20.0;
        /// Residual of a pair that counts a quarter.
        scale_deg: f64 = 0.1, "deg", 0.001..=10.0;
        /// Of a longer drive so many turns are used, spread over it; 0: all.
        most_turns: u32 = 200, "1", 0.0..=1000000.0;
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
    }
}

impl CarGraph {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        let sensor = Sensor::graph(self.most_lag_deg, self.high_pass_deg, self.near_m).over(
            self.reach,
            self.scale_deg,
            self.most_turns,
        );
        Car { sensor, interval_s: self.scan_interval_s, ..Car::published() }
    }
}

impl Learner for CarGraph {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
