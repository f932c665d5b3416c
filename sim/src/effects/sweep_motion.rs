//! Motion within a turn of the head that the recorder has taken out, wholly or in part.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// What was seen during a turn of the head is given as from nearer to where the scanner was when the turn began.
    SweepMotion, "sweep_motion",
    "Sweeps come with the scanner's motion during a turn taken out, or half taken out.",
    Sensing, Timing, fits ["car"],
    source "drivers that compensate motion take all of it out; speed times 0.1 s is smeared otherwise, half a metre at 5 m/s",
    drawn [compensated: Size { way: Up, least: 0.02, greatest: 1.0 }],
    {
        /// Share of the motion that is taken out.
        compensated: f64 = 0.0, "1", 0.0..=1.0;
    }
}

impl Effect for SweepMotion {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        let left = 1.0 - knobs.velodyne.compensated;
        knobs.velodyne.compensated += left * self.compensated;
    }
}
