//! Effects on the car and its Velodyne: the conformance suite, and what follows from each that no formula in its file
//! states.

mod actuation;
#[path = "../catalogue/mod.rs"]
mod catalogue;
mod conformance;
mod drives;
mod dynamics;
mod lidar;
mod scans;
