//! A load in the luggage space.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// A mass lies behind the rear axle that the nominal car does not have.
    CarPayload, "car_payload",
    "A load lies in the luggage space.",
    Dynamics, StaticMotion, fits ["car"],
    source "cars of this size may carry 400 to 500 kg",
    drawn [mass_kg: Size { way: Up, least: 7.0, greatest: 500.0 }],
    {
        /// What lies there.
        mass_kg: f64 = 0.0, "kg", 0.0..=600.0;
    }
}

impl Effect for CarPayload {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.luggage_kg += self.mass_kg;
    }
}
