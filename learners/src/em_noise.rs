//! EM that learns the noise of the motion too.

use crate::em::{Em, MotionNoise, em_learner};

em_learner! {
    /// A noise of motion that is given too large leaves the bearings too little to explain.
    EmNoise, "em_noise",
    "EM with exact moments that also learns each action's noise of motion, along the robot's axes.",
    source "Stronger 2008, section 4.4.1 (left to future work)", tolerance 0.05,
    {
        /// Each action's noise of motion is drawn to that of all as if it had been executed for so many steps more.
        pooled_steps: f64 = 1000.0, "1", 0.0..=1e12;
    }
    in_plane, |&Self { pooled_steps, .. }| Em { motion: MotionNoise::Learned { pooled_steps }, ..Em::exact() }
}
