//! Robots, one folder each.

pub mod aibo;
pub mod plain;
