//! EM in which actions borrow strength from each other.

use crate::em::{Em, Structure, em_learner};

em_learner! {
    /// Rarely executed actions are drawn to what the others make likely, by as much as their own sightings leave open.
    EmShared, "em_shared",
    "The best EM, with velocities that lie about a smooth function of the attempted ones.",
    source "Efron and Morris 1975", tolerance 0.05,
    {
        /// Each action's noise of motion is drawn to that of all as if it had been executed for so many steps more.
        pooled_steps: f64 = 1000.0, "1", 0.0..=1e12;
    }
    in_plane, |&Self { pooled_steps, .. }| Em { structure: Structure::Smooth, ..Em::best(pooled_steps) }
}
