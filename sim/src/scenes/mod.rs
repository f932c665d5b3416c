//! What stands around the robot.

pub mod field;
