//! A base that slows down in curves.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// While the robot turns, it goes forward more slowly than it is told: by a share that grows with the square of its turning
    /// rate.
    TurnSlowing, "turn_slowing",
    "In a turn the robot goes forward more slowly than told, by a share that grows with the square of the turning rate.",
    Actuation, StaticMotion, fits ["create"],
    source "motion capture of MRCLAM data set 6 (Leung et al. 2011): all five Creates lose 2.5 s^2 of their speed; their turns are whole",
    drawn [loss_s2: Size { way: Up, least: 0.1, greatest: 4.0 }],
    {
        /// Share of the forward speed that is lost at 1 rad/s; four times as much at twice the rate, and never more than all.
        loss_s2: f64 = 0.0, "s^2", 0.0..=20.0;
    }
}

impl Effect for TurnSlowing {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.wheels.turn_loss_s2 += self.loss_s2;
    }
}
