//! Devices that observe: what the robot is given instead of the truth.

pub mod applanix;
mod blobs;
pub mod camera;
pub mod image;
mod paint;
mod raster;
pub mod velodyne;
pub mod vision;
