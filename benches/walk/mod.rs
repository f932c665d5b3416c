//! The Aibo walking in open loop: what the time of an engine step is measured on.

use std::f64::consts::FRAC_PI_2;

use asami_dataset::Seed;
use asami_sim::robots::aibo::blueprint::{Blueprint, JOINTS};
use asami_sim::robots::aibo::body::Body;
use asami_sim::robots::aibo::engine::Engine as _;
use asami_sim::robots::aibo::gait::Trot;
use asami_sim::robots::aibo::posture::joints_rad;
use asami_sim::robots::aibo::servo::SetPoints;
use asami_sim::robots::aibo::{AiboConfig, BuildError, Start};
use nalgebra::Isometry3;

/// Forward, well below the greatest speed.
const ATTEMPT: [f64; 3] = [0.0, 0.2, 0.0];

/// A body with its gait and servos, and nothing above them.
#[allow(dead_code, reason = "where the walk starts is read by the example alone")]
pub struct Walk {
    pub config: AiboConfig,
    pub blueprint: Blueprint,
    /// Torso at the start; x is ahead.
    pub world_from_torso: Isometry3<f64>,
    /// Joint angles at the start.
    pub angles_rad: [f64; JOINTS],
    pub body: Body,
    trot: Trot,
    set_points: SetPoints,
}

impl Walk {
    /// Standing, before it settles.
    pub fn new() -> Result<Self, BuildError> {
        let (config, blueprint) = (AiboConfig::default(), Blueprint::shipped()?);
        let trot = Trot::new(config.gait.clone(), blueprint.legs.clone(), 0.0);
        let angles_rad = joints_rad(&config.head, &trot, 0.0);
        // Facing world +x.
        let start = Start { theta_rad: -FRAC_PI_2, ..Start::default() };
        let world_from_torso = start.world_from_torso(&config.gait, &blueprint, trot.pitch_rad());
        let body = Body::new(&config, &blueprint, &world_from_torso, &angles_rad)?;
        let limits = blueprint.joints.map(|joint| joint.speed_rad_per_s);
        let tick_s = config.physics.tick_s();
        let rng = Seed(0).stream("walk");
        let set_points = SetPoints::new(&config.servo, tick_s, angles_rad.to_vec(), limits.into_iter(), rng);
        Ok(Self { config, blueprint, world_from_torso, angles_rad, body, trot, set_points })
    }

    /// Moves the set-points on by one control period and gives them to the motors.
    pub fn aim(&mut self) -> Vec<f64> {
        self.trot.step(self.config.physics.tick_s(), ATTEMPT);
        let wanted_rad = joints_rad(&self.config.head, &self.trot, 0.0);
        let aimed_rad = self.set_points.approach(&wanted_rad, 1.0).to_vec();
        self.body.aim(&aimed_rad);
        aimed_rad
    }
}
