//! The Sony Aibo ERS-7 in Rapier: attempted velocities in, legs moved by servos, everything else by
//! contact.
//!
//! Once a control tick a command passes through [`gait`] (a virtual-wheel trot), [`leg`] (inverse
//! kinematics) and [`servo`] (speed-limited set-points) into the motors of an [`engine`]'s body, Rapier's ([`body`]),
//! another program's ([`outside`]), or one that need not do again what it did before ([`rehearsal`]); [`world`] runs that loop.
//! Controllers compute in `f64` with portable functions, the engine in `f32`.

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
pub mod rehearsal;
pub mod servo;
pub mod watch;
pub mod world;

use std::sync::Arc;

use nalgebra::Isometry3;

use blueprint::{Blueprint, JOINTS};
use body::Body;
pub use config::AiboConfig;
use engine::Engine;
use outside::{Outside, Program};
pub use posture::Start;
use rehearsal::{Notes, Rehearsed, Take};
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

/// Which engine moves the body.
#[derive(Clone, Copy, Debug, Default)]
pub enum By<'a> {
    /// Rapier.
    #[default]
    Rapier,
    /// Another program's.
    Program(&'a Program),
    /// Rapier, and a take of it is noted.
    Noted(&'a Notes),
    /// Rapier, once something else is to be done than in a take of it.
    Rehearsed(&'a Arc<Take>),
}

impl By<'_> {
    /// The body with the given joint angles at a pose of its torso (URDF axes: x forward).
    fn body(
        self,
        config: &AiboConfig,
        blueprint: &Blueprint,
        world_from_torso: &Isometry3<f64>,
        angles_rad: &[f64; JOINTS],
    ) -> Result<Box<dyn Engine>, BuildError> {
        let rapier = || Body::new(config, blueprint, world_from_torso, angles_rad).map(Box::new);
        Ok(match self {
            Self::Rapier => rapier()?,
            Self::Program(program) => Box::new(Outside::new(program, config, blueprint, world_from_torso, angles_rad)?),
            Self::Noted(notes) => Box::new(Rehearsed::noting(rapier()?, notes)),
            Self::Rehearsed(take) => Box::new(Rehearsed::following(rapier()?, take)),
        })
    }
}
