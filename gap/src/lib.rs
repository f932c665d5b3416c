//! The gap between a nominal world and a log: where they part, which unmodelled effect parts them, and
//! how far the gap shrinks once that effect is added.
//!
//! The world's answer to commands, and its sensor's to what stands around it, are learned once from
//! simulated runs into a [`Library`]: nominally, and with each effect at several sizes. A log is then
//! filtered with each hypothesis's response in the place of the nominal one, and its likelihood decides.
//! Nothing here reads files or clocks, or prints.

pub mod aside;
pub mod blocks;
pub mod calibration;
pub mod columns;
pub mod contest;
pub mod diagnose;
pub mod diagnosis;
pub mod directions;
pub mod drive;
pub mod evidence;
pub mod experiment;
pub mod filter;
pub mod findings;
pub mod fit;
pub mod groups;
pub mod hears;
pub mod how_far;
pub mod judge;
pub mod library;
pub mod memory;
pub mod newton;
pub mod nominal;
pub mod place;
pub mod plant;
pub mod practice;
pub mod race;
pub mod real;
pub mod regimes;
pub mod rhythm;
pub mod rivals;
pub mod shape;
pub mod shrink;
pub mod sighted;
pub mod sizes;
pub mod state;
pub mod touch;
pub mod view;

pub use calibration::Calibration;
pub use contest::{CannotDiagnose, Diagnoses, Judges, Likelihood};
pub use diagnose::Diagnoser;
pub use diagnosis::Diagnosis;
pub use drive::Drives;
pub use judge::Judge;
pub use library::{Budget, Library, Responds, Responses};
pub use nominal::{CannotPlay, Nominal};
pub use plant::{Planted, Variant};
pub use sighted::Sighted;
