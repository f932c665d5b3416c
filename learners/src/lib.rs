//! Pure algorithms that learn sensor and action models from a log: no physics, no files, no clock,
//! no printing.

pub mod learner;

pub use learner::{About, CannotLearn, Lack, Learned, Learner, Needs, Step, Trace, Verdict};
