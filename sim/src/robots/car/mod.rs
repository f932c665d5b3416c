//! A 1999 Isuzu VehiCross in Rapier: pedals and a steering wheel in, everything else by suspension, tyres and engine.
//!
//! Once a physics step the commands pass through [`actuator`](super::actuator) into [`drivetrain`] and the [`wheel`]s, whose forces act
//! on the rigid body of [`body`]; [`world`] runs that loop. Rapier holds the body, the ground and what can be run into,
//! and answers the wheels' rays. Its own ray-cast vehicle is not used: its tyres are as stiff as the time step makes
//! them and its engine switches its brakes off, so that neither slip nor standing still would be physics.

pub mod blueprint;
pub mod body;
pub mod brakes;
pub mod config;
pub mod drivetrain;
pub mod wheel;
pub mod world;

pub use blueprint::Model;
pub use config::CarConfig;
pub use world::{CarWorld, Start};

/// Why a car could not be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The URDF does not parse.
    #[error("the URDF of the car does not parse: {0}")]
    Urdf(String),
    /// The URDF lacks a part that the simulation needs.
    #[error("the URDF of the car has no {kind} `{name}`")]
    Missing {
        /// `link`, `joint` or `cylinder of link`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// The engine refused the ground.
    #[error("the engine cannot take the ground: {0}")]
    Ground(String),
    /// There is no ground under a wheel.
    #[error("there is no ground under the car's start")]
    OffGround,
}
