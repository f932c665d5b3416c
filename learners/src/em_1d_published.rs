//! EM along a line as published (section 4.4.3 of Stronger 2008): the very code of the plane, over places instead
//! of poses and sizes alone.

use crate::em::{Em, em_learner};

em_learner! {
    /// One landmark ahead, whose distance is minus the robot's place; vx and vtheta are zero. As in chapter 3 lengths are
    /// in units of the learner's own, the same for both models.
    Em1dPublished, "em_1d_published",
    "Learns a forward velocity for each action, f and the height's noise by EM in one dimension, as published.",
    source "Stronger 2008, section 4.4.3", tolerance 0.0, {}
    along_line, |_| Em::default()
}
