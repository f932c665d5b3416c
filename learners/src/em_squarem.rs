//! EM in fewer iterations.

use crate::em::{Acceleration, Em, em_learner};

em_learner! {
    /// The same fixed point as without; what EM does in hundreds of small steps in one direction is done in one.
    EmSquarem, "em_squarem",
    "EM with exact moments, accelerated by squared extrapolation.",
    source "Varadhan and Roland 2008", tolerance 0.05, {}
    in_plane, |_| Em { acceleration: Acceleration::Squarem, ..Em::exact() }
}
