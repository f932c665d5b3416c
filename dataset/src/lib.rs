//! What simulators and learners agree on.
//!
//! A [`Dataset`] is a [`Log`] (what the robot knows) and a [`Truth`] (what only the simulator or a
//! motion-capture rig knows). Learners and diagnosers are given `&Log` alone: nothing in a `Log`
//! leads to its `Truth`, so that a leak does not compile.

pub mod firings;
pub mod log;
pub mod models;
pub mod packets;
pub mod parameters;
pub mod seed;
pub mod store;
pub mod survey;
pub mod truth;

pub use firings::Firings;
pub use log::{
    Action, Beacon, Camera, Channel, Command, CommandsAre, Frame, Known, Log, Odometry, Sighting, Size, Timed,
};
pub use models::{ActionModel, Models, Noise, SensorModel};
pub use seed::{Rng, Seed};
pub use survey::Survey;
pub use truth::{Dataset, Provenance, TruePose, Truth};
