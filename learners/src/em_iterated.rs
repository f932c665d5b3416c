//! EM as published, but with an iterated smoother.

use crate::em::{Em, Expectation, em_learner};

em_learner! {
    /// Motion and observations are linearised where the robot is thought to have been in the light of all data; one
    /// new linearisation an iteration. At convergence that is the most probable trajectory (Gauss-Newton).
    EmIterated, "em_iterated",
    "EM as published, but with a smoother linearised about the last smoothed trajectory.",
    source "Bell 1994", tolerance 0.0, {}
    in_plane, |_| Em { expectation: Expectation::Iterated, ..Em::default() }
}
