//! The Aibo walking in open loop: what the time of an engine step is measured on.

use asami_dataset::Seed;
use asami_sim::robots::aibo::blueprint::{Blueprint, JOINTS};
use asami_sim::robots::aibo::body::Body;
use asami_sim::robots::aibo::gait::Trot;
use asami_sim::robots::aibo::servo::SetPoints;
use asami_sim::robots::aibo::{AiboConfig, BuildError};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

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
        let angles_rad = joints_rad(&config, &trot, trot.angles_rad());
        let height_m = blueprint.foot_radius_m + 0.5 * (config.gait.fore_height_m + config.gait.hind_height_m);
        // About the left axis, nose down is positive.
        let pitch = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -trot.pitch_rad());
        let world_from_torso = Isometry3::from_parts(Translation3::new(0.0, 0.0, height_m), pitch);
        let body = Body::new(&config, &blueprint, &world_from_torso, &angles_rad)?;
        let limits = blueprint.joints.map(|joint| joint.speed_rad_per_s);
        let tick_s = config.physics.tick_s();
        let rng = Seed(0).stream("walk");
        let set_points = SetPoints::new(&config.servo, tick_s, angles_rad.to_vec(), limits.into_iter(), rng);
        Ok(Self { config, blueprint, world_from_torso, angles_rad, body, trot, set_points })
    }

    /// Moves the set-points on by one control period and gives them to the motors.
    pub fn aim(&mut self) -> Vec<f64> {
        let legs_rad = self.trot.step(self.config.physics.tick_s(), ATTEMPT);
        let wanted_rad = joints_rad(&self.config, &self.trot, legs_rad);
        let aimed_rad = self.set_points.approach(&wanted_rad).to_vec();
        self.body.aim(&aimed_rad);
        aimed_rad
    }
}

/// Legs, then the head held upright, level and straight ahead.
fn joints_rad(config: &AiboConfig, trot: &Trot, legs_rad: [[f64; 3]; 4]) -> [f64; JOINTS] {
    let lean_rad = config.head.neck_lean_rad;
    let head_rad = [trot.pitch_rad() + lean_rad, 0.0, -lean_rad];
    let mut joints = [0.0; JOINTS];
    for (joint, angle) in joints.iter_mut().zip(legs_rad.into_iter().flatten().chain(head_rad)) {
        *joint = angle;
    }
    joints
}
