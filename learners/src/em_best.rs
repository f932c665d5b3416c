//! The best answers together.

use crate::em::{Em, em_learner};

em_learner! {
    /// With standard errors from the information that the filter's innovations carry.
    EmBest, "em_best",
    "EM with an iterated smoother, exact moments, learned noise of motion, one head, false sightings and acceleration.",
    source "the answers of em_exact, em_noise, em_head, em_robust and em_squarem", tolerance 0.05,
    {
        /// Each action's noise of motion is drawn to that of all as if it had been executed for so many steps more.
        pooled_steps: f64 = 1000.0, "1", 0.0..=1e12;
    }
    in_plane, |&Self { pooled_steps, .. }| Em::best(pooled_steps)
}
