//! EM with exact moments in the M-step.

use crate::em::{Em, em_learner};

em_learner! {
    /// The expectation of the displacement takes in the uncertain heading, those of distance and bearing the uncertain
    /// pose: nothing is drawn, the likelihood does not flicker, and learning stops when it no longer grows.
    EmExact, "em_exact",
    "EM with an iterated smoother, and exact moments instead of a sample in the M-step.",
    source "Shumway and Stoffer 1982; moments of a rotated Gaussian", tolerance 0.05, {}
    in_plane, |_| Em::exact()
}
