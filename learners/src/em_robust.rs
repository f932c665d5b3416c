//! EM that knows of false sightings.

use crate::em::{Em, Outliers, em_learner};

em_learner! {
    /// Instead of a gate on the first iteration: a false sighting has any size and any bearing, and the share of them is
    /// learned.
    EmRobust, "em_robust",
    "EM with exact moments, in which each sighting is true or false with a probability of its own.",
    source "Dempster, Laird and Rubin 1977, section 4.3", tolerance 0.05, {}
    in_plane, |_| Em { outliers: Outliers::Mixture, ..Em::exact() }
}
