//! A scenario's simulated world as the nominal one of a diagnosis.

use asami_dataset::{Dataset, Seed};
use asami_gap::{CannotPlay, Nominal};
use asami_sim::effects::Effects;
use asami_sim::robots::car::CarConfig;
use asami_sim::world::{Drive, World};

use crate::scenario::{Policy, Simulation};

impl Nominal for Simulation {
    fn robot(&self) -> &'static str {
        self.robot.name()
    }

    fn landmarks(&self) -> usize {
        self.field.beacons.len()
    }

    fn effects(&self) -> &Effects {
        &self.effects
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn world(&self, effects: &Effects, seed: Seed) -> Result<Box<dyn World>, CannotPlay> {
        let simulation = Self { effects: effects.clone(), ..self.clone() };
        Simulation::world(&simulation, seed).map_err(|error| CannotPlay(error.to_string()))
    }

    fn car(&self) -> Option<&CarConfig> {
        if let Policy::Route(ride) = &self.drive { Some(&ride.car) } else { None }
    }

    fn dataset(&self, effects: &Effects, seed: Seed, until_s: f64) -> Result<Dataset, CannotPlay> {
        let simulation = Self { effects: effects.clone(), duration_s: until_s, ..self.clone() };
        Simulation::dataset(&simulation, seed).map_err(|error| CannotPlay(error.to_string()))
    }

    fn drive(&self, seed: Seed) -> Box<dyn Drive> {
        self.policy(seed)
    }
}
