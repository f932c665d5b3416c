//! Worlds that make data sets: robots in scenes with sensors, and the effects that a simulator may
//! leave out. The only user of Rapier.

pub mod drives;
pub mod effect;
pub mod effects;
pub mod knobs;
pub mod ride;
pub mod robots;
pub mod scenes;
pub mod sensors;
pub mod survey;
pub mod world;
