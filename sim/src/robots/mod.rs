//! Robots, one folder each.

pub mod aibo;
