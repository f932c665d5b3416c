//! How well a scanner's lasers agree, by measures that its table is not corrected by.

use asami_dataset::Log;
use asami_scans::{Thickness, thickness};

use super::seen::apart_s;
use crate::drive::motion::{Moved, Step};
use crate::view::CannotSee;

/// One turn of so many seconds is looked at.
const EVERY_S: f64 = 0.5;

/// What a log's scans say with the table as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// How thick surfaces are, each turn by itself; `None` where none shows.
    pub thickness: Option<Thickness>,
    /// How the car moved, by matching scan to scan.
    pub steps: Vec<Step>,
}

impl Agreement {
    /// Reads a log.
    ///
    /// # Errors
    /// [`CannotSee`] where its scans cannot be followed.
    pub fn of(log: &Log) -> Result<Self, CannotSee> {
        let moved = Moved::read_every(log, apart_s(log))?;
        let turns = moved.drive.scans(EVERY_S);
        Ok(Self { thickness: thickness(&moved.drive, &turns, &moved.angles_rad), steps: moved.steps })
    }
}
