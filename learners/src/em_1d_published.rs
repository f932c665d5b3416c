//! EM along a line as published (section 4.4.3 of Stronger 2008): the very code of the plane, over places instead
//! of poses and sizes alone.

use asami_dataset::{Log, Models, Rng};

use crate::em_published::EmPublished;
use crate::learner::{CannotLearn, Learned, Learner, learner};

learner! {
    /// One landmark ahead, whose distance is minus the robot's place; vx and vtheta are zero. As in chapter 3 lengths are
    /// in units of the learner's own, the same for both models.
    Em1dPublished, "em_1d_published",
    "Learns a forward velocity for each action, f and the height's noise by EM in one dimension, as published.",
    source "Stronger 2008, section 4.4.3", needs Both,
    {
        /// Degree of f, a polynomial of the distance.
        degree: u32 = 3, "1", 1.0..=5.0;
        /// Stops after so many iterations without a new best likelihood.
        patience: u32 = 50, "1", 1.0..=100000.0;
        /// Stops after so many iterations at the latest.
        max_iterations: u32 = 5000, "1", 1.0..=1000000.0;
    }
}

impl Learner for Em1dPublished {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let Self { degree, patience, max_iterations } = *self;
        EmPublished { degree, patience, max_iterations }.em().along_line(log, given, rng)
    }
}
