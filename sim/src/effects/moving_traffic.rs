//! Other cars on the road.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// Cars come the other way; the laser scanner sees them, and takes them for parts of the town.
    MovingTraffic, "moving_traffic",
    "Cars come the other way at 5 m/s.",
    Scene, Noise, fits ["car"],
    source "a residential street carries some 100 to 1000 cars an hour: 5 to 50 on each km at 20 km/h",
    drawn [per_km: Size { way: Up, least: 1.0, greatest: 40.0 }],
    {
        /// Cars on each km of the road, rounded up to whole cars.
        per_km: f64 = 0.0, "1", 0.0..=60.0;
    }
}

impl Effect for MovingTraffic {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        knobs.scene.traffic_per_km += self.per_km;
    }
}
