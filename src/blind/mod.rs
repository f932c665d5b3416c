//! The blind check: effects are planted by a salt that no diagnosis sees, each log is diagnosed alone,
//! and only the scorer opens the key.

pub mod draw;
pub mod withhold;

pub use draw::{Mix, Planting};
