//! One leg that is shorter than the others.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The foot of one leg sits higher up its shank; the gait computes with the nominal length.
    ShortLeg, "short_leg",
    "One leg is shorter than nominally.",
    Dynamics, StaticMotion, fits ["aibo"],
    source "a paw's rubber is some 5 mm thick, and wears or comes off",
    drawn [missing_m: Size { way: Up, least: 0.001, greatest: 0.012 }, leg: Choice(&[0.0, 1.0, 2.0, 3.0])],
    {
        /// What it lacks.
        missing_m: f64 = 0.0, "m", 0.0..=0.02;
        /// Which: 0 fore left, 1 fore right, 2 hind left, 3 hind right.
        leg: u8 = 0, "1", 0.0..=3.0;
    }
}

impl Effect for ShortLeg {
    /// Which leg does not matter where none is short.
    fn is_null(&self) -> bool {
        self.missing_m == 0.0
    }

    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        if let Some(short_m) = knobs.body.short_m.get_mut(usize::from(self.leg)) {
            *short_m += self.missing_m;
        }
    }
}
