//! The Sony Aibo ERS-7 in Rapier: attempted velocities in, legs moved by servos, everything else by
//! contact.
//!
//! Once a control tick a command passes through [`gait`] (a virtual-wheel trot), [`leg`] (inverse
//! kinematics) and [`servo`] (speed-limited set-points) into the motors of an [`engine`]'s body, Rapier's ([`body`]) or
//! another program's ([`outside`]); [`world`] runs that loop. Controllers compute in `f64` with portable functions, the engine in `f32`.

pub mod blueprint;
pub mod body;
pub mod config;
pub mod engine;
pub mod eye;
pub mod gait;
pub mod grip;
pub mod heading;
pub mod leg;
pub mod outside;
pub mod posture;
pub mod servo;
pub mod watch;
pub mod world;

pub use config::AiboConfig;
pub use posture::Start;
pub use world::AiboWorld;

/// Why an Aibo could not be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The URDF does not parse.
    #[error("the URDF of the Aibo does not parse: {0}")]
    Urdf(String),
    /// The URDF lacks a part that the controller needs.
    #[error("the URDF of the Aibo has no {kind} `{name}`")]
    Missing {
        /// `link` or `joint`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// The engine refused a joint.
    #[error("the engine cannot attach joint `{0}`")]
    Joint(String),
    /// Another program's engine does not start.
    #[error("the engine `{0}` does not start: {1}")]
    Engine(String, String),
}
