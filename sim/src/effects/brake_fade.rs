//! Brakes that grow weaker as they are used.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// The brakes' torque falls with the heat that braking has put into them, and comes back as they cool.
    BrakeFade, "brake_fade",
    "The brakes grow weaker with the work that they have done.",
    Actuation, Drift, fits ["car"],
    source "UN Regulation 13-H lets hot brakes lose 40 % of what cold ones give; the heat that it takes is chosen to suit the speeds of a town",
    drawn [fade_per_mj: Size { way: Up, least: 0.03, greatest: 10.0 }],
    {
        /// What each MJ of heat adds to the divisor of the torque.
        fade_per_mj: f64 = 0.0, "1/MJ", 0.0..=20.0;
    }
}

impl Effect for BrakeFade {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.vehicle.brake_fade_per_mj += self.fade_per_mj;
    }
}
