//! EM as published, but with another smoother.

use crate::em::{Em, Expectation, em_learner};

em_learner! {
    /// One filter and a smoother, instead of two filters of which one starts at nothing.
    EmRts, "em_rts",
    "EM as published, but with an RTS smoother in the E-step.",
    source "Rauch, Tung and Striebel 1965", tolerance 0.0, {}
    in_plane, |_| Em { expectation: Expectation::Rts, ..Em::default() }
}
