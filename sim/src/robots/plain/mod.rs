//! The dissertation's own simulator (Stronger 2008, section 4.4.2): it "models the robot's pose and
//! observation vectors, but not its physical joint angles or camera image".

pub mod config;
pub mod sight;
pub mod velocities;
pub mod world;

pub use config::PlainConfig;
pub use world::PlainWorld;
