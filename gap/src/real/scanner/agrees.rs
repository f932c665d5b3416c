//! How well a scanner's lasers agree, by measures that its table is not corrected by.

use asami_dataset::Log;
use asami_math::elementary::sin_cos;
use asami_math::rigid::Rigid;
use asami_math::statistics::median;
use asami_scans::{Thickness, off_planes, thickness};

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
    /// How far each turn that is matched lies off the planes of the one before, in the median; `None` where none is met.
    pub off_planes_m: Option<f64>,
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
        let off_m: Vec<f64> = moved.steps.iter().filter_map(|step| residual_m(&moved, step)).collect();
        Ok(Self {
            thickness: thickness(&moved.drive, &turns, &moved.angles_rad),
            off_planes_m: median(&off_m),
            steps: moved.steps,
        })
    }
}

/// How far the later turn of a step lies off the planes of the earlier.
fn residual_m(moved: &Moved<'_>, step: &Step) -> Option<f64> {
    let begins = |t_s: f64| moved.scans.iter().find(|scan| (scan.t_s - t_s).abs() < 1e-6);
    let turns = [begins(step.t_s)?, begins(step.t_s + step.dt_s)?];
    let (turn_rad, way_m) = (step.omega_rad_per_s * step.dt_s, step.v_m_per_s * step.dt_s);
    let (sin, cos) = sin_cos(0.5 * turn_rad);
    let motion = Rigid { x: way_m * cos, y: way_m * sin, turn_rad };
    off_planes(&moved.drive, turns, &moved.angles_rad, &motion)
}
