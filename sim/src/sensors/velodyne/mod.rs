//! The car's Velodyne HDL-64E: 64 lasers that turn ten times a second on a moving, pitching body.

mod pose;

pub use pose::SensorPose;
