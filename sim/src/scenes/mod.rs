//! What surrounds robots, one file each.

pub mod field;
pub mod solid;
pub mod town;
