//! EM in the plane as published (chapter 4 of Stronger 2008).

use asami_dataset::{Log, Models, Rng};

use crate::em::Em;
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// Forward and backward extended Kalman filters combined, velocities as mean displacements, the sensor from one
    /// sample of the pose a frame; noise of the motion as given.
    EmPublished, "em_published",
    "Learns a velocity for each action, f and the sensor's noise by EM, exactly as published.",
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

impl EmPublished {
    /// The answers to EM's questions.
    #[must_use]
    pub fn em(&self) -> Em {
        Em {
            coefficients: self.degree as usize + 1,
            patience: self.patience,
            max_iterations: self.max_iterations,
            ..Em::default()
        }
    }
}

impl Learner for EmPublished {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.em().in_plane(log, given, rng)
    }
}
