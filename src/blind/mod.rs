//! The blind check: effects are planted by a salt that no diagnosis sees, each log is diagnosed alone,
//! and only the scorer opens the key.

pub mod answer;
pub mod draw;
pub mod field;
pub mod folder;
pub mod next;
pub mod pool;
pub mod referee;
pub mod rows;
pub mod scenario;
pub mod scores;
pub mod tables;
pub mod tally;
pub mod walk;
pub mod withhold;

pub use draw::{Mix, Planting};
