//! Tyres or a road that take more to roll.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The wheels take a larger share of their load to be rolled.
    RollingResistance, "rolling_resistance",
    "The wheels roll harder than nominally.",
    Dynamics, StaticMotion, fits ["car"],
    source "0.015 for car tyres on concrete, 0.08 on medium hard ground, 0.3 on sand (Gillespie 1992, chapter 4); soft tyres double it",
    drawn [coefficient: Size { way: Up, least: 0.0003, greatest: 0.05 }],
    {
        /// Share of the load on top of the nominal one.
        coefficient: f64 = 0.0, "1", 0.0..=0.1;
    }
}

impl Effect for RollingResistance {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.rolling_resistance += self.coefficient;
    }
}
