//! EM in fewer iterations.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Acceleration, Em, Expectation};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// The same fixed point as without; what EM does in hundreds of small steps in one direction is done in one.
    EmSquarem, "em_squarem",
    "EM with exact moments, accelerated by squared extrapolation.",
    source "Varadhan and Roland 2008", needs Both,
    {
        /// Degree of f, a polynomial of the distance.
        degree: u32 = 3, "1", 1.0..=5.0;
        /// Stops after so many iterations without a new best likelihood.
        patience: u32 = 50, "1", 1.0..=100000.0;
        /// Stops when three iterations in a row change the log-likelihood by less.
        tolerance: f64 = 0.05, "nat", 0.0..=1000.0;
        /// Stops after so many iterations at the latest.
        max_iterations: u32 = 5000, "1", 1.0..=1000000.0;
    }
}

impl EmSquarem {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            expectation: Expectation::Averaged,
            exact: true,
            acceleration: Acceleration::Squarem,
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmSquarem {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
