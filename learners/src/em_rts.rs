//! EM in the plane with the smoother of Rauch, Tung and Striebel (1965) for the published pair of filters.

use asami_dataset::{Log, Models, Rng};

use crate::em::{Em, Expectation};
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// Forward and backward extended Kalman filters combined, velocities as mean displacements, the sensor from one
    /// sample of the pose a frame; noise of the motion as given.
    EmRts, "em_rts",
    "EM as published, but with an RTS smoother in the E-step.",
    source "Stronger 2008, chapter 4 (eqs 4.8 to 4.28)", needs Both,
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
            exact: false,
            gate: true,
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            tolerance: 0.0,
            max_iterations: self.max_iterations,
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
