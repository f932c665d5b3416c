//! Units of columns, and what one in the wrong unit looks like.

use std::f64::consts::TAU;
use std::path::Path;

use asami_dataset::{Action, Command};
use asami_math::angle::wrap_rad;

use super::ImportError;

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// A time.
    Time,
    /// A length.
    Length,
    /// An angle.
    Angle,
    /// A speed.
    Speed,
    /// A turning rate.
    Turning,
}

impl Dimension {
    /// Names of its units, and what one of each is in SI units.
    const fn known(self) -> &'static [(&'static str, f64)] {
        const DEGREE_RAD: f64 = TAU / 360.0;
        match self {
            Self::Time => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)],
            Self::Length => &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)],
            Self::Angle => &[("rad", 1.0), ("deg", DEGREE_RAD)],
            Self::Speed => &[("m/s", 1.0), ("cm/s", 1e-2), ("mm/s", 1e-3), ("km/h", 1.0 / 3.6)],
            Self::Turning => &[("rad/s", 1.0), ("deg/s", DEGREE_RAD)],
        }
    }

    /// One of a unit in SI units; `None` if it is of another dimension.
    #[must_use]
    pub fn in_si(self, unit: &str) -> Option<f64> {
        self.known().iter().find(|(name, _)| *name == unit).map(|(_, si)| *si)
    }

    /// Names of its units.
    #[must_use]
    pub fn units(self) -> Vec<&'static str> {
        self.known().iter().map(|(name, _)| *name).collect()
    }
}

/// An angle, wrapped to `[-pi, pi)`: more than a turn is no angle in radians.
///
/// # Errors
/// [`ImportError`], asking for degrees, where it is more.
pub fn radians(file: &Path, line: u64, column: &str, angle_rad: f64) -> Result<f64, ImportError> {
    if angle_rad.abs() <= TAU {
        return Ok(wrap_rad(angle_rad));
    }
    let rule = "must be an angle of at most a turn, 2 pi rad (is the column in degrees?)";
    Err(ImportError::Value {
        file: file.to_owned(),
        line,
        column: column.to_owned(),
        rule,
        found: angle_rad.to_string(),
    })
}

/// A range, which must be greater than 0.
///
/// # Errors
/// [`ImportError`] where it is not.
pub fn range(file: &Path, line: u64, column: &str, range_m: f64) -> Result<f64, ImportError> {
    if range_m > 0.0 {
        return Ok(range_m);
    }
    let (rule, found) = ("must be greater than 0", format!("{range_m:?}"));
    Err(ImportError::Value { file: file.to_owned(), line, column: column.to_owned(), rule, found })
}

/// A sentence, where half of the numbers of a column called `what` exceed `most`, what a wheeled robot indoors has:
/// their `unit` may be a thousandth, or degrees.
#[must_use]
pub fn hint(what: &str, values: impl Iterator<Item = f64>, most: f64, unit: &str) -> Option<String> {
    let mut sizes: Vec<f64> = values.map(f64::abs).filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let median = *sizes.get(sizes.len() / 2)?;
    let other = if unit.starts_with("rad") { "degrees" } else { "millimetres" };
    (median > most).then(|| format!("hint: half of the {what} exceed {median} {unit}; is the column in {other}?"))
}

/// Such sentences of a wheeled robot's commands, `what` being its speeds and its turning rates.
#[must_use]
pub fn hints_of_wheels(commands: &[Command], what: [&str; 2]) -> Vec<String> {
    let wheels = |of: fn(f64, f64) -> f64| {
        commands.iter().filter_map(move |command| match command.action {
            Action::Wheels { v_m_per_s, omega_rad_per_s, .. } => Some(of(v_m_per_s, omega_rad_per_s)),
            Action::Legs { .. } | Action::Pedals { .. } => None,
        })
    };
    let fast = hint(what[0], wheels(|v_m_per_s, _| v_m_per_s), FAST_M_PER_S, "m/s");
    let turning = hint(what[1], wheels(|_, omega_rad_per_s| omega_rad_per_s), FAST_RAD_PER_S, "rad/s");
    fast.into_iter().chain(turning).collect()
}

/// Ranges of sensors and places of landmarks indoors, m.
pub const FAR_M: f64 = 200.0;
/// Speeds of wheeled robots, m/s.
const FAST_M_PER_S: f64 = 20.0;
/// Turning rates of wheeled robots, rad/s.
const FAST_RAD_PER_S: f64 = 15.0;
