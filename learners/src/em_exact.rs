//! EM with exact moments in the M-step.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Em, Expectation};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// The expectation of the displacement takes in the uncertain heading, those of distance and bearing the uncertain
    /// pose: nothing is drawn, the likelihood does not flicker, and learning stops when it no longer grows.
    EmExact, "em_exact",
    "EM with an iterated smoother, and exact moments instead of a sample in the M-step.",
    source "Shumway and Stoffer 1982; moments of a rotated Gaussian", needs Both,
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

impl EmExact {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            expectation: Expectation::Averaged,
            exact: true,
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmExact {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
