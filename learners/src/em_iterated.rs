//! EM as published, but with an iterated smoother.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Em, Expectation};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// Motion and observations are linearised where the robot is thought to have been in the light of all data; one
    /// new linearisation an iteration. At convergence that is the most probable trajectory (Gauss-Newton).
    EmIterated, "em_iterated",
    "EM as published, but with a smoother linearised about the last smoothed trajectory.",
    source "Bell 1994", needs Both,
    {
        /// Degree of f, a polynomial of the distance.
        degree: u32 = 3, "1", 1.0..=5.0;
        /// Stops after so many iterations without a new best likelihood.
        patience: u32 = 50, "1", 1.0..=100000.0;
        /// Stops after so many iterations at the latest.
        max_iterations: u32 = 5000, "1", 1.0..=1000000.0;
    }
}

impl EmIterated {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            expectation: Expectation::Iterated,
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmIterated {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
