//! Where the sensor is, from one physics step to the next.

use nalgebra::UnitQuaternion;

/// Where the sensor is and how it is turned. The sensor's frame is the robot's: +x right, +y forward, +z up;
/// its origin is the sensor's centre, where the spin axis and the lasers meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPose {
    /// Seconds since the log began.
    pub t_s: f64,
    /// The sensor's centre in the world.
    pub position_m: [f64; 3],
    /// How the sensor is turned, its spin left out.
    pub world_from_sensor: UnitQuaternion<f64>,
}
