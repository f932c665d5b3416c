//! EM that learns the noise of the motion too.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Em, Expectation, MotionNoise};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// A noise of motion that is given too large leaves the bearings too little to explain.
    EmNoise, "em_noise",
    "EM with exact moments that also learns each action's noise of motion, along the robot's axes.",
    source "Stronger 2008, section 4.4.1 (left to future work)", needs Both,
    {
        /// Degree of f, a polynomial of the distance.
        degree: u32 = 3, "1", 1.0..=5.0;
        /// Each action's noise of motion is drawn to that of all as if it had been executed for so many steps more.
        pooled_steps: f64 = 1000.0, "1", 0.0..=1e12;
        /// Stops after so many iterations without a new best likelihood.
        patience: u32 = 50, "1", 1.0..=100000.0;
        /// Stops when three iterations in a row change the log-likelihood by less.
        tolerance: f64 = 0.05, "nat", 0.0..=1000.0;
        /// Stops after so many iterations at the latest.
        max_iterations: u32 = 5000, "1", 1.0..=1000000.0;
    }
}

impl EmNoise {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            expectation: Expectation::Averaged,
            exact: true,
            motion: MotionNoise::Learned { pooled_steps: self.pooled_steps },
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmNoise {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
