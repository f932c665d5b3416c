//! One leg whose motors give less torque than the others'.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The three motors of one leg give a fraction of their nominal torque, for an error and at most.
    WeakLeg, "weak_leg",
    "The motors of one leg give a fraction of their nominal torque.",
    Actuation, StaticMotion, fits ["aibo"],
    source "a stripped gear or a servo that shuts down hot gives half its torque or less",
    drawn [ratio: Size { way: Down, least: 0.05, greatest: 0.6 }, leg: Choice(&[0.0, 1.0, 2.0, 3.0])],
    {
        /// Factor on the nominal torque.
        ratio: f64 = 1.0, "1", 0.2..=1.5;
        /// Which: 0 fore left, 1 fore right, 2 hind left, 3 hind right.
        leg: u8 = 0, "1", 0.0..=3.0;
    }
}

impl Effect for WeakLeg {
    /// Which leg does not matter where none is weak.
    fn is_null(&self) -> bool {
        self.ratio == 1.0
    }

    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        if let Some(torque_ratio) = knobs.motors.torque_ratio.get_mut(usize::from(self.leg)) {
            *torque_ratio *= self.ratio;
        }
    }
}
