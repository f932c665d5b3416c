//! The best answers together.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Acceleration, Em, Expectation, MotionNoise, Outliers};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// With standard errors from the information that the filter's innovations carry.
    EmBest, "em_best",
    "EM with an iterated smoother, exact moments, learned noise of motion, false sightings and acceleration.",
    source "the answers of em_iterated, em_exact, em_noise, em_robust and em_squarem", needs Both,
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

impl EmBest {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            expectation: Expectation::Averaged,
            exact: true,
            motion: MotionNoise::Learned { pooled_steps: self.pooled_steps },
            outliers: Outliers::Mixture,
            acceleration: Acceleration::Newton,
            second_try: true,
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmBest {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
