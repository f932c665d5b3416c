//! Motors that turn a command into less, or more, than was asked for, from some time on.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The gait attempts a fixed multiple of the command.
    CommandScale, "command_scale",
    "The robot attempts a fixed multiple of the commanded velocities.",
    Actuation, StaticMotion, fits ["aibo", "plain", "create"],
    source "Stronger 2008, section 4.4.3: attempted velocities x 3/4 after 8 of 16 minutes",
    drawn [y_ratio: Size { way: Either, least: 0.01, greatest: 0.25 }, x_ratio: Same, theta_ratio: Same],
    {
        /// Factor on the rightward velocity.
        x_ratio: f64 = 1.0, "1", 0.5..=1.5;
        /// Factor on the forward velocity.
        y_ratio: f64 = 1.0, "1", 0.5..=1.5;
        /// Factor on the turning rate.
        theta_ratio: f64 = 1.0, "1", 0.5..=1.5;
        /// When it begins.
        from_s: f64 = 0.0, "s", 0.0..=1e6;
    }
}

impl Effect for CommandScale {
    /// When it begins does not matter where nothing does.
    fn is_null(&self) -> bool {
        [self.x_ratio, self.y_ratio, self.theta_ratio] == [1.0; 3]
    }

    fn tune(&self, t_s: f64, knobs: &mut Knobs) {
        if t_s < self.from_s {
            return;
        }
        for (scale, ratio) in knobs.command.scale.iter_mut().zip([self.x_ratio, self.y_ratio, self.theta_ratio]) {
            *scale *= ratio;
        }
    }
}
