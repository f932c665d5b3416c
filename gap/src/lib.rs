//! The gap between a nominal world and a log: where they part, which unmodelled effect parts them, and
//! how far the gap shrinks once that effect is added.
//!
//! The world's answer to commands, and its sensor's to what stands around it, are learned once from
//! simulated runs into a [`Library`]: nominally, and with each effect at several sizes. A log is then
//! filtered with each hypothesis's response in the place of the nominal one, and its likelihood decides.
//! `weigh` says what a log says for every cause, `answer` what to make of that. Nothing here reads files or clocks, or
//! prints.

pub mod answer;
pub mod blocks;
pub mod columns;
pub mod directions;
pub mod drive;
pub mod filter;
pub mod fit;
pub mod hears;
pub mod judge;
pub mod library;
pub mod memory;
pub mod newton;
pub mod nominal;
pub mod plant;
pub mod race;
pub mod real;
pub mod regimes;
pub mod rhythm;
pub mod shape;
pub mod shrink;
pub mod sighted;
pub mod sizes;
pub mod start;
pub mod state;
#[cfg(test)]
mod straight;
pub mod tails;
pub mod touch;
pub mod view;
pub mod weigh;

pub use answer::calibration::Calibration;
pub use answer::contest::{CannotDiagnose, Diagnoses, Judges, Likelihood};
pub use answer::diagnose::Diagnoser;
pub use answer::diagnosis::Diagnosis;
pub use drive::Drives;
pub use judge::Judge;
pub use library::{Budget, Library, Responds, Responses};
pub use nominal::{CannotPlay, Nominal};
pub use plant::{Planted, Variant};
pub use sighted::Sighted;
