//! The nominal world, as something that can be played.

use asami_dataset::{Dataset, Seed};
use asami_sim::effects::Effects;
use asami_sim::robots::car::CarConfig;
use asami_sim::world::{Drive, World, run};

/// A world cannot be played.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the nominal world cannot be played: {0}")]
pub struct CannotPlay(pub String);

/// A nominal world: what the simulator has in it, to be played with and without further effects.
pub trait Nominal: Sync {
    /// The robot's name in data sets.
    fn robot(&self) -> &'static str;

    /// How many landmarks there are.
    fn landmarks(&self) -> usize;

    /// Effects that are nominally on.
    fn effects(&self) -> &Effects;

    /// Length of its logs in seconds.
    fn duration_s(&self) -> f64;

    /// The world of a seed with these effects in place of its own.
    ///
    /// # Errors
    /// If it cannot be built.
    fn world(&self, effects: &Effects, seed: Seed) -> Result<Box<dyn World>, CannotPlay>;

    /// The car, where the robot is one.
    fn car(&self) -> Option<&CarConfig> {
        None
    }

    /// A log of a seed's world with these effects in place of its own.
    ///
    /// # Errors
    /// If it cannot be simulated.
    fn dataset(&self, effects: &Effects, seed: Seed, until_s: f64) -> Result<Dataset, CannotPlay> {
        Ok(run(&mut *self.world(effects, seed)?, &mut *self.drive(seed), until_s))
    }

    /// Commands of the kind that its logs have. It sees the logged past and, where it keeps the robot on
    /// the field, the true pose.
    fn drive(&self, seed: Seed) -> Box<dyn Drive>;
}
