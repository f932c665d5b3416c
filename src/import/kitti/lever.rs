//! Where the laser scanner stands on the car, seen from the navigation unit that says how the car moved.
//!
//! In a curve they move differently: at 0.3 m to the outside and 0.2 rad/s the scanner is 0.06 m/s faster.

use std::path::Path;

use asami_dataset::TruePose;
use asami_math::elementary::sin_cos;

use super::super::ImportError;
use super::super::columns::open;
use super::super::track::Moving;

/// The scanner's place in the navigation unit's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lever {
    /// Forward.
    pub ahead_m: f64,
    /// Leftward.
    pub left_m: f64,
}

const NAME: &str = "Tr_imu_to_velo";
const RULE: &str = "must be a row of Tr_imu_to_velo: 12 finite numbers, three rows of a rotation and a shift";
/// More text than any table of calibrations.
const LONGEST_BYTES: u64 = 1 << 16;

/// Reads `Tr_imu_to_velo` (Geiger, Lenz, Stiller and Urtasun 2013): it takes the navigation unit's coordinates, x forward and y left, to the
/// scanner's. `None` where the file has no such row.
pub(super) fn read(file: &Path) -> Result<Option<Lever>, ImportError> {
    let mut text = String::new();
    let read = std::io::Read::read_to_string(&mut std::io::Read::take(open(file)?, LONGEST_BYTES), &mut text);
    read.map_err(|error| ImportError::Unreadable { file: file.to_owned(), why: error.to_string() })?;
    let wrong = |line: usize, found: &str| ImportError::Value {
        file: file.to_owned(),
        line: line as u64,
        column: NAME.to_owned(),
        rule: RULE,
        found: found.to_owned(),
    };
    let found = (1..).zip(text.lines()).find_map(|(line, row)| Some((line, row.trim().strip_prefix(NAME)?)));
    let Some((line, row)) = found else { return Ok(None) };
    let numbers: Option<Vec<f64>> = row.trim_start_matches(':').split_whitespace().map(|it| it.parse().ok()).collect();
    let numbers = numbers.filter(|all| all.iter().all(|it| it.is_finite())).ok_or_else(|| wrong(line, row.trim()))?;
    let [a, b, _, x, c, d, _, y, e, f, _, z] = numbers[..] else { return Err(wrong(line, row.trim())) };
    // Where p = R q + t is zero: q = -R^T t.
    Ok(Some(Lever { ahead_m: -(a * x + c * y + e * z), left_m: -(b * x + d * y + f * z) }))
}

impl Lever {
    /// Poses of the scanner, of a navigation unit with these poses that moves so.
    pub(super) fn end(self, unit: &[TruePose], moving: &[Moving]) -> Vec<TruePose> {
        let Self { ahead_m, left_m } = self;
        let end = |(pose, now): (&TruePose, &Moving)| {
            let (sin, cos) = sin_cos(pose.theta_rad);
            TruePose {
                x_m: pose.x_m - ahead_m * sin - left_m * cos,
                y_m: pose.y_m + ahead_m * cos - left_m * sin,
                v_m_per_s: Some(now.v_m_per_s - now.omega_rad_per_s * left_m),
                ..*pose
            }
        };
        unit.iter().zip(moving).map(end).collect()
    }
}
