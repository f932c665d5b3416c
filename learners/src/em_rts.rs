//! EM as published, but with another smoother.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Em, Expectation};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// One filter and a smoother, instead of two filters of which one starts at nothing.
    EmRts, "em_rts",
    "EM as published, but with an RTS smoother in the E-step.",
    source "Rauch, Tung and Striebel 1965", needs Both,
    {
        /// Degree of f, a polynomial of the distance.
        degree: u32 = 3, "1", 1.0..=5.0;
        /// Stops after so many iterations without a new best likelihood.
        patience: u32 = 50, "1", 1.0..=100000.0;
        /// Stops after so many iterations at the latest.
        max_iterations: u32 = 5000, "1", 1.0..=1000000.0;
    }
}

impl EmRts {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            expectation: Expectation::Rts,
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmRts {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
