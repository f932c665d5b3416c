//! The verbs of asami (Autonomous Sensor and Action Model Induction) and what they share: scenarios,
//! trials, tables, figures, reports.

pub mod binning;
pub mod blind;
pub mod depths;
pub mod diagnose;
pub mod draw;
pub mod generate;
pub mod import;
pub mod learn;
pub mod list;
pub mod real;
pub mod report;
pub mod scenario;
pub mod score;
pub mod scorer;
pub mod simulate;
pub mod splice;
pub mod study;
pub mod survey;
pub mod sweep;
pub mod trial;
pub mod twin;
pub mod verb;
