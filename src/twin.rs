//! A scenario's simulated world as the nominal one of a diagnosis.

use asami_dataset::Seed;
use asami_gap::{CannotPlay, Nominal};
use asami_sim::effects::Effects;
use asami_sim::world::{Drive, World};

use crate::scenario::Simulation;

impl Nominal for Simulation {
    fn robot(&self) -> &'static str {
        self.robot.name()
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

    fn drive(&self, seed: Seed) -> Box<dyn Drive> {
        self.policy(seed)
    }
}
