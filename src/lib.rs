//! The verbs of asami and what they share: scenarios, trials, tables.

pub mod scenario;
