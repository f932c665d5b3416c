//! Places and turns in our numbers and in the engine's.

use asami_math::elementary::sin_cos;
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use rapier3d::prelude::{Pose, Rotation, Vector};

/// Turned about the vertical, counter-clockwise. nalgebra's own would take the platform's sine.
pub(super) fn yawed(angle_rad: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = sin_cos(0.5 * angle_rad);
    UnitQuaternion::from_quaternion(Quaternion::new(cos, 0.0, 0.0, sin))
}

pub(super) fn to_vector(it: &Vector3<f64>) -> Vector {
    Vector::new(it.x as f32, it.y as f32, it.z as f32)
}

pub(super) fn from_vector(it: Vector) -> Vector3<f64> {
    Vector3::new(f64::from(it.x), f64::from(it.y), f64::from(it.z))
}

pub(super) fn to_engine(pose: &Isometry3<f64>) -> Pose {
    let q = &pose.rotation;
    let rotation = Rotation::from_xyzw(q.i as f32, q.j as f32, q.k as f32, q.w as f32).normalize();
    Pose::from_parts(to_vector(&pose.translation.vector), rotation)
}

pub(super) fn from_engine(pose: &Pose) -> Isometry3<f64> {
    let q = pose.rotation;
    let quaternion = Quaternion::new(f64::from(q.w), f64::from(q.x), f64::from(q.y), f64::from(q.z));
    Isometry3::from_parts(from_vector(pose.translation).into(), UnitQuaternion::from_quaternion(quaternion))
}
