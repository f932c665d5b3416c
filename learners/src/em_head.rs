//! EM that knows that one head measures all bearings of a frame.

use crate::em::{Em, MotionNoise, em_learner};

em_learner! {
    /// Errors of the head's angle are in all bearings of a frame alike; taken for errors of each, two bearings that agree
    /// make the sensor seem better than it is. The noise of motion is learned too: given too large, it leaves the bearings
    /// nothing to explain.
    EmHead, "em_head",
    "EM with exact moments and learned noise of motion, in which bearings of one frame share a part of their errors.",
    source "Laird and Ware 1982 (random effects)", tolerance 0.05,
    {
        /// Each action's noise of motion is drawn to that of all as if it had been executed for so many steps more.
        pooled_steps: f64 = 1000.0, "1", 0.0..=1e12;
    }
    in_plane, |&Self { pooled_steps, .. }| {
        Em { motion: MotionNoise::Learned { pooled_steps }, one_head: true, ..Em::exact() }
    }
}
