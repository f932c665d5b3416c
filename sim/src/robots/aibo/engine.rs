//! What a physics engine owes the Aibo: a body that follows set-points, and says where it is.

use nalgebra::Isometry3;

use crate::knobs::BodyKnobs;

/// A body in a physics engine, on flat ground.
pub trait Engine: Send {
    /// Puts a load on the torso, and shortens legs; before the first step.
    fn load(&mut self, knobs: &BodyKnobs);

    /// Inclines the ground: gravity in the ground's own axes. `slope` is its sine, times the unit vector uphill.
    fn incline(&mut self, slope: [f64; 2]);

    /// Sets the torques that the motors of the four legs give for an error, and at most, relative to the nominal
    /// ones.
    fn set_torque(&mut self, ratios: [f64; 4]);

    /// Sets the friction coefficients of the four feet and of everything else.
    fn set_friction(&mut self, feet: [f64; 4], shell: f64);

    /// Gives the motors their set-points, in the order of [`JOINT_NAMES`](super::blueprint::JOINT_NAMES).
    fn aim(&mut self, set_points_rad: &[f64]);

    /// Moves on by one engine step.
    fn step(&mut self);

    /// The angle of joint `i` of [`JOINT_NAMES`](super::blueprint::JOINT_NAMES) as its encoder reads it.
    fn angle_rad(&self, i: usize) -> f64;

    /// Which feet press on the ground.
    fn feet_down(&self) -> [bool; 4];

    /// The torso in the world (URDF axes: x forward).
    fn world_from_torso(&self) -> Isometry3<f64>;

    /// The head in the world (URDF axes: x forward).
    fn world_from_head(&self) -> Isometry3<f64>;

    /// A link of the URDF in the world; `None` of one that the engine does not tell of.
    fn world_from_link(&self, name: &str) -> Option<Isometry3<f64>>;

    /// Mass of all links as the engine holds it; 0 before the first step.
    fn mass_kg(&self) -> f64;

    /// Why the engine does not go on, if it does not.
    fn broken(&self) -> Option<String> {
        None
    }
}
