//! The verbs of asami (Autonomous Sensor and Action Model Induction) and what they share: scenarios,
//! trials, tables, figures, reports.

pub mod draw;
pub mod import;
pub mod report;
pub mod scenario;
pub mod scorer;
pub mod simulate;
pub mod splice;
pub mod sweep;
pub mod trial;
pub mod verb;
