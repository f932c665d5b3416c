//! From what a log says for every cause to a diagnosis. No response is learned by anything in here, and no planted case
//! weighed (`tests/arrows.rs`): what is kept of those outlives any change of it.

pub mod calibration;
pub mod contest;
pub mod diagnose;
pub mod diagnosis;
pub mod experiment;
pub mod how_far;
pub mod place;
pub mod rivals;
