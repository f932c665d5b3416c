//! Robots, one folder each.

pub mod aibo;
pub mod car;
pub mod plain;
