//! Softer or harder tyres.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The tread's stiffness is a multiple of the nominal one: softer tyres slip more, along and across.
    TyreSlip, "tyre_slip",
    "The tyres slip more, or less, under the same force than nominally.",
    Dynamics, StaticMotion, fits ["car"],
    source "cornering stiffness of car tyres differs by a factor of two with make, pressure, load and wear (Gillespie 1992, chapter 10)",
    drawn [across_ratio: Size { way: Down, least: 0.05, greatest: 0.8 }, along_ratio: Same],
    {
        /// Factor on the slip stiffness.
        along_ratio: f64 = 1.0, "1", 0.1..=2.0;
        /// Factor on the cornering stiffness.
        across_ratio: f64 = 1.0, "1", 0.1..=2.0;
    }
}

impl Effect for TyreSlip {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        let ratios = [self.along_ratio, self.across_ratio];
        for (stiffness, ratio) in knobs.vehicle.tread_ratio.iter_mut().zip(ratios) {
            *stiffness *= ratio;
        }
    }
}
