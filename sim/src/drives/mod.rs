//! Policies: what the robot is commanded, chosen from the logged past.

pub mod driver;
pub mod explore;
pub mod hold;
pub mod pace;
pub mod replay;
pub mod roam;
pub mod suite;
