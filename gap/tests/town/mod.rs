//! Chapter 5's town as a nominal world.

use asami_dataset::{Dataset, Seed};
use asami_gap::{CannotPlay, Nominal};
use asami_sim::effects::Effects;
use asami_sim::ride::{Angles, Ride};
use asami_sim::robots::car::CarConfig;
use asami_sim::scenes::town::TownConfig;
use asami_sim::world::{Drive, World};

/// See the module.
pub struct Town {
    /// The town and the car.
    pub ride: Ride,
    effects: Effects,
}

impl Default for Town {
    fn default() -> Self {
        let town = TownConfig { detail: 0.05, ..TownConfig::default() };
        Self { ride: Ride { town, unit: Angles::Redrawn, ..Ride::default() }, effects: Effects::default() }
    }
}

impl Nominal for Town {
    fn robot(&self) -> &'static str {
        "car"
    }

    fn landmarks(&self) -> usize {
        0
    }

    fn effects(&self) -> &Effects {
        &self.effects
    }

    fn duration_s(&self) -> f64 {
        40.0
    }

    fn world(&self, effects: &Effects, seed: Seed) -> Result<Box<dyn World>, CannotPlay> {
        let car = self.ride.on(&self.ride.town(seed), effects, seed);
        Ok(Box::new(car.map_err(|error| CannotPlay(error.to_string()))?))
    }

    fn drive(&self, seed: Seed) -> Box<dyn Drive> {
        Box::new(self.ride.driver(&self.ride.town(seed), seed))
    }

    fn car(&self) -> Option<&CarConfig> {
        Some(&self.ride.car)
    }

    fn dataset(&self, effects: &Effects, seed: Seed, until_s: f64) -> Result<Dataset, CannotPlay> {
        self.ride.dataset(effects, until_s, seed).map_err(|error| CannotPlay(error.to_string()))
    }
}
