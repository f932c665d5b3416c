//! From a scenario's simulation to worlds and logs.

use asami_dataset::{Dataset, Provenance, Seed};
use asami_sim::drives::pace::Pace;
use asami_sim::robots::aibo::{AiboWorld, BuildError, Start};
use asami_sim::scenes::field::Field;
use asami_sim::world::{self, World};
use rand::RngExt;

use crate::scenario::{Robot, Scenario, Simulation};

impl Simulation {
    /// The world of a case. The seed draws where the robot stands and where in its stride it is, and
    /// every noise.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn world(&self, seed: Seed) -> Result<Box<dyn World>, BuildError> {
        let mut rng = seed.stream("start");
        let ahead_m = self.start.y_spread_m * (2.0 * rng.random::<f64>() - 1.0);
        let start = Start {
            x_m: self.start.x_m,
            y_m: self.start.y_m + ahead_m,
            theta_rad: self.start.theta_rad,
            gait_phase: rng.random::<f64>(),
        };
        self.world_from(start, seed)
    }

    /// The world with the robot facing the field's first beacon (the origin, where there is none) from
    /// `distance_m`, and nothing else on the field; the seed draws where in its stride it is.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn before_beacon(&self, distance_m: f64, seed: Seed) -> Result<Box<dyn World>, BuildError> {
        let [x_m, y_m] = self.field.beacons.first().map_or([0.0; 2], |beacon| [beacon.body.x_m, beacon.body.y_m]);
        let gait_phase = seed.stream("start").random::<f64>();
        let beacons = self.field.beacons.iter().take(1).cloned().collect();
        let alone = Self { field: Field { beacons, clutter: Vec::new() }, ..self.clone() };
        alone.world_from(Start { x_m, y_m: y_m - distance_m, theta_rad: 0.0, gait_phase }, seed)
    }

    fn world_from(&self, start: Start, seed: Seed) -> Result<Box<dyn World>, BuildError> {
        match self.robot {
            Robot::Aibo => Ok(Box::new(self.aibo_at(start, seed)?)),
        }
    }

    /// The scenario's Aibo, put where the caller wants it.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn aibo_at(&self, start: Start, seed: Seed) -> Result<AiboWorld, BuildError> {
        AiboWorld::new(&self.aibo, &self.field, &self.camera, &self.effects, start, seed)
    }

    /// The log of a case, and where the robot was.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn dataset(&self, seed: Seed) -> Result<Dataset, BuildError> {
        let mut drive = Pace::new(self.drive.clone(), seed.stream("drive"));
        Ok(world::run(&mut *self.world(seed)?, &mut drive, self.duration_s))
    }
}

impl Scenario {
    /// Where a log of this scenario comes from.
    #[must_use]
    pub fn provenance(&self, seed: Seed) -> Provenance {
        Provenance {
            scenario: self.name.clone(),
            scenario_hash: self.hash(),
            seed: seed.0,
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}
