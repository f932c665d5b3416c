//! EM in the plane as published (chapter 4 of Stronger 2008).

use crate::em::{Em, em_learner};

em_learner! {
    /// Forward and backward extended Kalman filters combined, velocities as mean displacements, the sensor from one
    /// sample of the pose a frame; noise of the motion as given.
    EmPublished, "em_published",
    "Learns a velocity for each action, f and the sensor's noise by EM, exactly as published.",
    source "Stronger 2008, chapter 4 (eqs 4.8 to 4.28)", tolerance 0.0, {}
    in_plane, |_| Em::default()
}
