//! What only the simulator or a motion-capture rig knows.

use crate::log::{Channel, Log, Timed};
use crate::survey::Survey;

/// One row of `truth.csv`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruePose {
    /// Seconds since the log began.
    pub t_s: f64,
    /// World x of the robot's origin.
    pub x_m: f64,
    /// World y of the robot's origin.
    pub y_m: f64,
    /// Heading, 0 facing world +y, counter-clockwise, in `[-pi, pi)`.
    pub theta_rad: f64,
    /// Forward speed, where it is known.
    pub v_m_per_s: Option<f64>,
}

impl Timed for TruePose {
    fn t_s(&self) -> f64 {
        self.t_s
    }
}

/// Truth about a log: where the robot was, and what its models really are. Either may be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Where the robot was.
    pub track: Channel<TruePose>,
    /// What its models really are.
    pub survey: Option<Survey>,
}

/// Where a data set came from. Withheld cases carry none.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Name of the scenario.
    pub scenario: String,
    /// `blake3:` and the hash of the checked scenario.
    pub scenario_hash: String,
    /// Seed of the case.
    pub seed: u64,
    /// Version of asami that made it.
    pub version: String,
}

/// A log and the truth about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset {
    /// What the robot knows.
    pub log: Log,
    /// What it does not.
    pub truth: Truth,
    /// Where it came from.
    pub provenance: Option<Provenance>,
}
