//! Air, oil and bearings that hold the car back more the faster it goes.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// A resistance that grows with speed, on top of the nominal air's.
    Drag, "drag",
    "The car is held back by a force that grows with its speed.",
    Dynamics, StaticMotion, fits ["car"],
    source "coast-down fits of cars have linear terms of some N.s/m, cold oil and dragging brakes several times that; a head wind of 5 m/s adds as much again to the air at town speeds",
    drawn [linear_n_s_per_m: Size { way: Up, least: 1.0, greatest: 200.0 }],
    {
        /// Force for each m/s.
        linear_n_s_per_m: f64 = 0.0, "N.s/m", 0.0..=400.0;
        /// Force for each (m/s)^2.
        square_n_s2_per_m2: f64 = 0.0, "N.s^2/m^2", 0.0..=40.0;
    }
}

impl Effect for Drag {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.drag_n_s_per_m += self.linear_n_s_per_m;
        knobs.vehicle.drag_n_s2_per_m2 += self.square_n_s2_per_m2;
    }
}
