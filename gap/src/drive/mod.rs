//! Logs of a car with a laser scanner: no landmark, no map.
//!
//! How the car moved is read off its scans ([`motion`]), and held against what the nominal car does under the same
//! commands when it is played on a plane ([`road`]): whatever moves otherwise shows there. What is wrong with the
//! scanner shows where its own redundancy breaks ([`scanner`]): neighbouring lasers, the ground under all of them,
//! consecutive turns must agree.

pub mod between;
pub mod driven;
pub mod flexible;
pub mod gears;
pub mod ground;
pub mod law;
pub mod library;
pub mod memory;
pub mod motion;
pub mod read;
pub mod road;
pub mod scanner;
pub mod walls;

pub use driven::Driven;
pub use library::{Base, Drives, Entry};
