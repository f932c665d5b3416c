//! An iRobot Create in Rapier, a disc on two driven wheels and a caster, with a sensor of landmarks on its deck.
//!
//! Commanded velocities become wanted speeds of the two wheels; each wheel's motor holds its own, and friction between tyre
//! and floor moves the robot ([`body`]). [`sight`] measures ranges and bearings of landmarks; [`world`] runs the loop.

pub mod blueprint;
pub mod body;
pub mod config;
pub mod sight;
pub mod world;

pub use config::CreateConfig;
pub use world::CreateWorld;

/// Why a Create could not be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The URDF does not parse.
    #[error("the URDF of the Create does not parse: {0}")]
    Urdf(String),
    /// The URDF lacks a part that the simulation needs.
    #[error("the URDF of the Create has no {kind} `{name}`")]
    Missing {
        /// `link`, `joint` or `sphere of link`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// The engine refused a wheel.
    #[error("the engine cannot hold the {0} wheel")]
    Joint(&'static str),
}
