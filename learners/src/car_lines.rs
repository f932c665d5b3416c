//! Scans matched point to line, the car's motion during the turn taken out.

use asami_dataset::{Log, Models, Rng};

use crate::car_graph::CarGraph;
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Cut, Matching, Start};

learner! {
    /// As `car_graph`, but for the matching: each point is set back to where it would have been seen at the scan's middle, the ground
    /// is left out where the car pitches, too, points are drawn to lines through the other scan's points with robust weights, the gate
    /// shrinks, and matching begins at the motion before.
    CarLines, "car_lines",
    "As car_graph, but with scans freed of the car's motion and matched point to line from the motion before.",
    source "this project; Chen and Medioni 1991", needs Firings,
    {
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Points more than this below the sensor are dropped.
        ground_below_m: f64 = 1.0, "m", -5.0..=10.0;
        /// Points of surfaces less steep than this, as a tangent, are dropped: where the car pitches, the ground comes up; 0: none are.
        least_slope: f64 = 1.0, "1", 0.0..=10.0;
        /// One point is kept of each square with this side; 0: all are.
        square_m: f64 = 0.1, "m", 0.0..=5.0;
        /// Residual of a point that counts half.
        scale_m: f64 = 0.1, "m", 0.001..=10.0;
        /// The gate at first.
        gate_m: f64 = 7.0, "m", 0.1..=100.0;
    }
}

impl CarLines {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        Car {
            interval_s: self.scan_interval_s,
            cut: Cut { lowest_m: -self.ground_below_m, least_slope: self.least_slope, square_m: self.square_m },
            matching: Matching { gate_m: self.gate_m, ..Matching::lines(self.scale_m) },
            start: Start::PairBefore,
            ..CarGraph::default().car()
        }
    }
}

impl Learner for CarLines {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
