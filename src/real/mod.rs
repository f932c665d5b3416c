//! Logs of real robots, each held against a nominal world and then against what motion capture shows: `study = "real"`.
//!
//! A diagnosis is given the log alone. What [`capture`] shows of the true track stands beside it afterwards.

pub mod among;
pub mod capture;
pub mod clock;
pub mod commanded;
pub mod cycle;
pub mod foretold;
pub mod kept;
pub mod learning;
pub mod make;
pub mod odometry;
pub mod pairs;
pub mod points;
pub mod record;
pub mod scanner;
pub mod scenario;
pub mod stand_in;
pub mod tables;
pub mod walk;
