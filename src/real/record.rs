//! What is kept of a part of a log.

use std::collections::BTreeMap;

use asami_dataset::Log;
use asami_gap::Diagnosis;
use serde::{Deserialize, Serialize};

use super::scanner::Checked;
use crate::sweep::Timing;

/// Which part of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// All of it.
    Whole,
    /// The first half of it.
    FirstHalf,
    /// The second half of it.
    SecondHalf,
}

impl Part {
    /// All, in order.
    pub const ALL: [Part; 3] = [Part::Whole, Part::FirstHalf, Part::SecondHalf];
    /// The halves, in order.
    pub const HALVES: [Part; 2] = [Part::FirstHalf, Part::SecondHalf];

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Part::Whole => "whole",
            Part::FirstHalf => "first_half",
            Part::SecondHalf => "second_half",
        }
    }

    /// This part of a log.
    #[must_use]
    pub fn of(self, log: &Log) -> Log {
        let [first, second] = log.halves();
        match self {
            Part::Whole => log.clone(),
            Part::FirstHalf => first,
            Part::SecondHalf => second,
        }
    }
}

/// What is kept of a part of a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The log's name in the scenario.
    pub log: String,
    /// Whose, of a recording of several.
    pub robot: Option<u16>,
    /// Which part.
    pub part: Part,
    /// Whether it is beside what others of the robot's make have.
    pub among: bool,
    /// What was said of it; `None` where nothing can be.
    pub diagnosis: Option<Diagnosis>,
    /// What motion capture shows, by `NAME.PARAM`.
    pub capture: BTreeMap<String, f64>,
    /// Standard errors of that.
    pub capture_errors: BTreeMap<String, f64>,
    /// How much of what motion is off each discrepancy explains alone, by motion capture, the largest first.
    pub shares: Vec<(String, f64)>,
    /// Of a laser scanner: whether correcting its table makes its scans better.
    pub checked: Option<Checked>,
    /// Why nothing can be said; empty if something was.
    pub error: String,
    /// Goes to `timings.csv` only.
    pub timing: Timing,
}

impl Record {
    /// Its name in files.
    #[must_use]
    pub fn name(&self) -> String {
        name(&self.log, self.robot, self.part, self.among)
    }
}

/// The name in files of such a record.
pub(super) fn name(log: &str, robot: Option<u16>, part: Part, among: bool) -> String {
    let robot = robot.map(|robot| format!("_{robot}")).unwrap_or_default();
    format!("{log}{robot}-{}{}", part.name(), if among { "-among" } else { "" })
}

/// Each whole log's record, and those of its halves after it.
pub(super) fn in_order(wholes: Vec<Record>, halves: Vec<Record>) -> Vec<Record> {
    let mut halves = halves.into_iter();
    let mut records = Vec::new();
    for whole in wholes {
        records.push(whole);
        records.extend(halves.by_ref().take(Part::HALVES.len()));
    }
    records
}
