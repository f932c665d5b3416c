//! What only the simulator or a motion-capture rig knows.

use asami_math::angle::wrap_rad;

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

/// Poses further apart than this are not interpolated.
pub const LONGEST_GAP_S: f64 = 0.5;

/// The pose at a time between two of the track's; `None` off its ends and in gaps longer than [`LONGEST_GAP_S`].
#[must_use]
pub fn pose_at(track: &[TruePose], t_s: f64) -> Option<TruePose> {
    let after = track.partition_point(|pose| pose.t_s < t_s);
    let b = track.get(after)?;
    if b.t_s == t_s {
        return Some(*b);
    }
    let a = track.get(after.checked_sub(1)?)?;
    let share = (t_s - a.t_s) / (b.t_s - a.t_s);
    let mix = |a: f64, b: f64| a + share * (b - a);
    (b.t_s - a.t_s <= LONGEST_GAP_S).then(|| TruePose {
        t_s,
        x_m: mix(a.x_m, b.x_m),
        y_m: mix(a.y_m, b.y_m),
        theta_rad: wrap_rad(a.theta_rad + share * wrap_rad(b.theta_rad - a.theta_rad)),
        v_m_per_s: None,
    })
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
