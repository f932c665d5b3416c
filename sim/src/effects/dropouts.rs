//! Returns that get lost.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// More returns get lost than nominally, whatever they come from.
    Dropouts, "dropouts",
    "Beams come back less often than nominally.",
    Sensing, Noise, fits ["car"],
    source "wet or dark surfaces, dirt on the housing and sunlight take some per cent of the returns, fog half of them",
    drawn [share: Size { way: Up, least: 0.0003, greatest: 0.4 }],
    {
        /// Share of returns on top of what gets lost nominally.
        share: f64 = 0.0, "1", 0.0..=0.9;
    }
}

impl Effect for Dropouts {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.velodyne.dropouts += self.share;
    }
}
