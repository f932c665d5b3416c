//! Robots, one folder each, and what several of them have.

pub mod actuator;
pub mod aibo;
pub mod car;
pub mod create;
mod frames;
pub mod past;
pub mod plain;
