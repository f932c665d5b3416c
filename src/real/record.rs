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

/// What a part of a log is diagnosed beside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Beside {
    /// Nothing, and each of its nats counts: by such halves of logs it is found how far those are to be believed.
    Nothing,
    /// How far halves of its recording's logs are to be believed.
    Halves,
    /// That, and what others of the robot's make have.
    Make,
}

impl Beside {
    fn ending(self) -> &'static str {
        match self {
            Beside::Nothing => "-as_it_speaks",
            Beside::Halves => "",
            Beside::Make => "-among",
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
    /// What it was diagnosed beside.
    pub beside: Beside,
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
        name(&self.log, self.robot, self.part, self.beside)
    }
}

/// The name in files of such a record.
pub(super) fn name(log: &str, robot: Option<u16>, part: Part, beside: Beside) -> String {
    let robot = robot.map(|robot| format!("_{robot}")).unwrap_or_default();
    format!("{log}{robot}-{}{}", part.name(), beside.ending())
}
