//! Angles of a scanner that bend from side to side.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The disc by which a scanner's mirror tells where it looks is not centred on the mirror's axis: angles err with a period of one
    /// turn.
    EncoderEccentricity, "encoder_eccentricity",
    "The disc of a scanner's angle encoder is off its axis: bearings read too much to both sides, or too little, by 1 less the cosine.",
    Sensing, Sensor, fits ["create"],
    source "a disc of 15 mm radius that is centred to 0.15 mm errs by 0.01 rad, as by motion capture bearings of \"Lost in the Woods\" (Barfoot) do",
    drawn [share: Size { way: Either, least: 0.001, greatest: 0.05 }],
    {
        /// How far the disc is off its axis to the left, as a share of its radius: what bearings at right angles read too much, against
        /// those ahead.
        share: f64 = 0.0, "1", -0.2..=0.2;
    }
}

impl Effect for EncoderEccentricity {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.eye.eccentricity += self.share;
    }
}
