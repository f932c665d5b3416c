//! From a scenario's simulation to worlds and logs.

use asami_dataset::{Command, Dataset, Provenance, Seed, TruePose};
use asami_sim::drives::explore::Explore;
use asami_sim::drives::pace::Pace;
use asami_sim::drives::replay::Replay;
use asami_sim::drives::roam::Roam;
use asami_sim::ride::{CannotRide, Ride};
use asami_sim::robots::aibo::{self, AiboWorld, By, Start};
use asami_sim::robots::car;
use asami_sim::robots::create::{self, CreateConfig, CreateWorld};
use asami_sim::robots::plain::PlainWorld;
use asami_sim::scenes::field::Field;
use asami_sim::world::{self, Drive, World};
use rand::RngExt;

use crate::scenario::{Policy, Robot, Scenario, Simulation};

/// Why a scenario's world cannot be made or looked at.
#[derive(Debug, thiserror::Error)]
pub enum CannotSimulate {
    /// The Aibo cannot be built.
    #[error(transparent)]
    Aibo(#[from] aibo::BuildError),
    /// The car cannot be built.
    #[error(transparent)]
    Car(#[from] car::BuildError),
    /// The Create cannot be built.
    #[error(transparent)]
    Create(#[from] create::BuildError),
    /// There is no drive of it.
    #[error(transparent)]
    Ride(#[from] CannotRide),
    /// Another program's engine stopped on the way.
    #[error("the other engine failed: {0}")]
    Engine(String),
}

impl Simulation {
    /// The world of a case. The seed draws where the robot stands and where in its stride it is, and
    /// every noise.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn world(&self, seed: Seed) -> Result<Box<dyn World>, CannotSimulate> {
        self.world_from(self.start(seed), seed)
    }

    /// Where the robot of a case stands.
    fn start(&self, seed: Seed) -> Start {
        let mut rng = seed.stream("start");
        let ahead_m = self.start.y_spread_m * (2.0 * rng.random::<f64>() - 1.0);
        Start {
            x_m: self.start.x_m,
            y_m: self.start.y_m + ahead_m,
            theta_rad: self.start.theta_rad,
            gait_phase: rng.random::<f64>(),
        }
    }

    /// The world with the robot facing the field's first beacon (the origin, where there is none) from
    /// `distance_m`, and nothing else on the field; the seed draws where in its stride it is.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn before_beacon(&self, distance_m: f64, seed: Seed) -> Result<Box<dyn World>, CannotSimulate> {
        let [x_m, y_m] = self.field.beacons.first().map_or([0.0; 2], |beacon| [beacon.body.x_m, beacon.body.y_m]);
        let gait_phase = seed.stream("start").random::<f64>();
        let beacons = self.field.beacons.iter().take(1).cloned().collect();
        let alone = Self { field: Field { beacons, clutter: Vec::new() }, ..self.clone() };
        alone.world_from(Start { x_m, y_m: y_m - distance_m, theta_rad: 0.0, gait_phase }, seed)
    }

    fn world_from(&self, start: Start, seed: Seed) -> Result<Box<dyn World>, CannotSimulate> {
        Ok(match self.robot {
            Robot::Aibo => Box::new(self.aibo_at(start, seed)?),
            Robot::Plain => Box::new(self.plain_at(start, seed)),
            Robot::Create => Box::new(self.create_at(start, seed)?),
            // Where it stands is its route's beginning.
            Robot::Car => {
                let ride = if let Policy::Route(ride) = &self.drive { (**ride).clone() } else { Ride::default() };
                Box::new(ride.on(&ride.town(seed), &self.effects, seed)?)
            }
        })
    }

    /// The scenario's plain robot, put where the caller wants it.
    #[must_use]
    pub fn plain_at(&self, start: Start, seed: Seed) -> PlainWorld {
        let Start { x_m, y_m, theta_rad, .. } = start;
        let pose = TruePose { t_s: 0.0, x_m, y_m, theta_rad, v_m_per_s: None };
        PlainWorld::new(&self.plain, &self.suite, &self.field, &self.effects, pose, seed)
    }

    /// The scenario's Create, put where the caller wants it.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn create_at(&self, start: Start, seed: Seed) -> Result<CreateWorld, create::BuildError> {
        let Start { x_m, y_m, theta_rad, .. } = start;
        let pose = TruePose { t_s: 0.0, x_m, y_m, theta_rad, v_m_per_s: None };
        let config = if let Policy::Roam(roams) = &self.drive { roams.create.clone() } else { CreateConfig::default() };
        CreateWorld::new(&config, &self.field, &self.effects, pose, seed)
    }

    /// The scenario's Aibo, put where the caller wants it.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn aibo_at(&self, start: Start, seed: Seed) -> Result<AiboWorld, aibo::BuildError> {
        self.aibo_by(self.engine.as_deref().map_or(By::Rapier, By::Program), start, seed)
    }

    fn aibo_by(&self, by: By<'_>, start: Start, seed: Seed) -> Result<AiboWorld, aibo::BuildError> {
        AiboWorld::in_engine(by, &self.aibo, &self.field, &self.camera, &self.effects, start, seed)
    }

    /// The log of a case of an Aibo, whichever robot the scenario has, moved by an engine of the caller's choice, and where
    /// it was.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn walked(&self, by: By<'_>, seed: Seed) -> Result<Dataset, CannotSimulate> {
        let mut world = self.aibo_by(by, self.start(seed), seed)?;
        Ok(world::run(&mut world, &mut *self.policy(seed), self.duration_s))
    }

    /// The log of a case, and where the robot was.
    ///
    /// # Errors
    /// If the robot cannot be built, or another program's engine stops.
    pub fn dataset(&self, seed: Seed) -> Result<Dataset, CannotSimulate> {
        if let Policy::Route(ride) = &self.drive {
            return Ok(ride.dataset(&self.effects, self.duration_s, seed)?);
        }
        let mut world = self.world(seed)?;
        let dataset = world::run(&mut *world, &mut *self.policy(seed), self.duration_s);
        world.broken().map_or(Ok(dataset), |why| Err(CannotSimulate::Engine(why)))
    }

    /// The log of a robot on wheels that is told what another was: `commands`, in order of time. Other robots
    /// are told what their scenario says.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn replayed(&self, commands: Vec<Command>, seed: Seed) -> Result<Dataset, CannotSimulate> {
        let Policy::Roam(roams) = &self.drive else { return self.dataset(seed) };
        let mut drive = Replay::new(commands, roams.roaming.clone());
        Ok(world::run(&mut *self.world(seed)?, &mut drive, self.duration_s))
    }

    /// Who chooses the actions of a case.
    #[must_use]
    pub fn policy(&self, seed: Seed) -> Box<dyn Drive> {
        let rng = seed.stream("drive");
        match &self.drive {
            Policy::Pace(pacing) => Box::new(Pace::new(pacing.clone(), rng)),
            Policy::Stride(pacing) => Box::new(Pace::among(self.suite.strides(), pacing.clone(), rng)),
            Policy::Explore(exploring) => Box::new(Explore::new(exploring.clone(), self.suite.actions(), rng)),
            Policy::Roam(roams) => Box::new(Roam::new(roams.roaming.clone(), rng)),
            Policy::Route(ride) => Box::new(ride.driver(&ride.town(seed), seed)),
        }
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
