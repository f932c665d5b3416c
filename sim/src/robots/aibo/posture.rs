//! How the robot stands: where its torso is over its feet, and how it holds its head.

use std::f64::consts::{FRAC_PI_2, TAU};

use asami_math::elementary::{asin, sin};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::blueprint::{Blueprint, JOINTS};
use super::config::{Gait, Head};
use super::gait::Trot;

/// Where and how the robot stands when the log begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// World x of the body's centre.
    pub x_m: f64,
    /// World y of the body's centre.
    pub y_m: f64,
    /// Heading.
    pub theta_rad: f64,
    /// Where in its stride the gait begins, `[0, 1)`.
    pub gait_phase: f64,
}

impl Start {
    /// The torso (x forward) of a robot that stands here with all feet on the ground.
    #[must_use]
    pub fn world_from_torso(&self, gait: &Gait, blueprint: &Blueprint, pitch_rad: f64) -> Isometry3<f64> {
        let height_m = blueprint.foot_radius_m + 0.5 * (gait.fore_height_m + gait.hind_height_m);
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.theta_rad + FRAC_PI_2);
        // About the left axis, nose down is positive.
        let pitch = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -pitch_rad);
        Isometry3::from_parts(Translation3::new(self.x_m, self.y_m, height_m), yaw * pitch)
    }
}

/// How evenly the head scans: 0 like a sine, towards 1 at one speed between sudden turns.
const EVENNESS: f64 = 0.995;

/// All joints at `t_s`: the legs as the gait wants them, neck tilt, pan and nod so that neck and camera
/// are held as configured over a torso at its stance's pitch.
#[must_use]
pub fn joints_rad(head: &Head, trot: &Trot, t_s: f64) -> [f64; JOINTS] {
    let pan_rad = head.scan_amplitude_rad * asin(EVENNESS * sin(TAU * t_s / head.scan_period_s)) / asin(EVENNESS);
    // Tilt and nod are nose down positive, pitches nose up.
    let tilt_rad = trot.pitch_rad() + head.neck_lean_rad;
    let nod_rad = -head.neck_lean_rad - head.camera_pitch_rad;
    let wanted = trot.angles_rad().into_iter().flatten().chain([tilt_rad, pan_rad, nod_rad]);
    let mut joints_rad = [0.0; JOINTS];
    for (joint, angle) in joints_rad.iter_mut().zip(wanted) {
        *joint = angle;
    }
    joints_rad
}
