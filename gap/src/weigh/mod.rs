//! What a log says for every cause, and planted cases to learn from what that is worth. No response is learned by anything
//! in here (`tests/arrows.rs`): libraries outlive any change of it, planted cases do not.

pub mod causes;
pub(crate) mod cores;
pub mod evidence;
pub mod findings;
pub mod groups;
pub mod pairs;
pub mod practice;
pub mod together;
