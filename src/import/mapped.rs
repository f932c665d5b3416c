//! A robot of one's own: CSV files as they are, and a table, `columns.toml`, that says which column of which file holds
//! what, and in what unit.
//!
//! `docs/your-own-log.md` goes through one. Commands are a wheeled robot's speeds; sightings are ranges and bearings of
//! numbered landmarks; frames (whenever the sensor looked) and truth may be there.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use asami_dataset::log::RangeBearing;
use asami_dataset::{Action, Beacon, Command, CommandsAre, Frame, Known, Log, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;
use serde::Deserialize;

use super::clock::{self, Timing};
use super::units::{self, Dimension};
use super::{ImportError, Imported, Importer, Read, capture, columns};

/// The importer's row in the list.
pub static IMPORTER: Importer = Importer {
    name: "csv",
    what: "CSV files of a wheeled robot of one's own, and columns.toml, which says what their columns hold and in what unit.",
    source: "anybody's; docs/your-own-log.md says how columns.toml is written",
    read: Read::One(read),
};

const TABLE: &str = "columns.toml";
const HINT: &str = "columns.toml says which column of which file holds what (docs/your-own-log.md)";

/// `columns.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    /// What heading 0 of the truth faces.
    #[serde(default)]
    heading_zero: Axis,
    #[serde(default)]
    bearings: Sense,
    /// Right and ahead of the robot's centre.
    #[serde(default)]
    sensor_origin_m: [f64; 2],
    max_range_m: Option<f64>,
    commands: Commands,
    sightings: Sightings,
    frames: Option<Frames>,
    truth: Option<TrueTrack>,
    landmarks: Vec<Landmark>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Axis {
    #[default]
    X,
    Y,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Sense {
    #[default]
    CounterClockwise,
    Clockwise,
}

/// The words for what commands are.
#[derive(Deserialize)]
#[serde(remote = "CommandsAre", rename_all = "snake_case")]
enum Are {
    Told,
    Odometry,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Commands {
    file: String,
    /// What they are; what the robot was told, unless said.
    #[serde(default, with = "Are")]
    are: CommandsAre,
    t: Column,
    v: Column,
    omega: Column,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sightings {
    file: String,
    t: Column,
    landmark: String,
    range: Column,
    bearing: Column,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Frames {
    file: String,
    t: Column,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrueTrack {
    file: String,
    t: Column,
    x: Column,
    y: Column,
    theta: Column,
}

/// A column and its unit.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Column {
    column: String,
    unit: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Landmark {
    id: u16,
    x_m: f64,
    y_m: f64,
}

/// Reads the log that `columns.toml`, or the folder that it is in, tells of.
///
/// # Errors
/// [`ImportError`] where there is no such table, it is wrong, or a file is not as it says.
pub fn read(source: &Path) -> Result<Imported, ImportError> {
    let file = if source.is_dir() { source.join(TABLE) } else { source.to_owned() };
    if !file.is_file() {
        return Err(ImportError::Absent { path: file, hint: HINT });
    }
    let text = std::fs::read_to_string(&file)
        .map_err(|error| ImportError::Unreadable { file: file.clone(), why: error.to_string() })?;
    let table: Table =
        toml::from_str(&text).map_err(|error| ImportError::Table { file: file.clone(), why: error.to_string() })?;
    Reading { folder: file.parent().unwrap_or(Path::new(".")), table_file: &file, table: &table }.all()
}

/// A table, and where it and its files are.
struct Reading<'a> {
    folder: &'a Path,
    table_file: &'a Path,
    table: &'a Table,
}

/// Rows of a file, in SI units, each with its line.
struct Rows<const N: usize> {
    file: PathBuf,
    rows: Vec<(u64, [f64; N])>,
}

impl<const N: usize> Rows<N> {
    fn times(&self) -> Vec<(u64, f64)> {
        self.rows.iter().map(|(line, values)| (*line, values[0])).collect()
    }
}

impl Reading<'_> {
    fn wrong(&self, why: String) -> ImportError {
        ImportError::Table { file: self.table_file.to_owned(), why }
    }

    /// The name of a column, and its unit in SI units.
    fn si<'a>(&self, Column { column, unit }: &'a Column, dimension: Dimension) -> Result<(&'a str, f64), ImportError> {
        let si = dimension.in_si(unit).ok_or_else(|| {
            let units = dimension.units().join(", ");
            self.wrong(format!("the unit of column {column} must be one of {units}, not {unit:?}"))
        })?;
        Ok((column, si))
    }

    /// Columns of a file, the time first, each times its unit.
    fn rows<const N: usize>(&self, name: &str, of: [(&str, f64); N]) -> Result<Rows<N>, ImportError> {
        let file = columns::of_folder(self.folder, name, HINT)?;
        let mut rows = Vec::new();
        for (line, values) in columns::read(&file, of.map(|(column, _)| column))? {
            let mut row = [0.0; N];
            for ((si, value), (column, unit)) in row.iter_mut().zip(values).zip(of) {
                *si = unit * columns::required(&file, line, column, value)?;
            }
            rows.push((line, row));
        }
        Ok(Rows { file, rows })
    }

    /// Commands, on a clock that begins with the first, how regularly they come, and what that clock's 0 was.
    fn commands(&self, notes: &mut Vec<String>) -> Result<(Vec<Command>, Timing, f64), ImportError> {
        let Commands { file, are, t, v, omega } = &self.table.commands;
        let of = [self.si(t, Dimension::Time)?, self.si(v, Dimension::Speed)?, self.si(omega, Dimension::Turning)?];
        let given = self.rows(file, of)?;
        let timing = clock::timing(&given.file, &t.column, &given.times())?;
        let zero_s = given.rows[0].1[0];
        let command = |(_, [t_s, v_m_per_s, omega_rad_per_s]): &(u64, [f64; 3])| Command {
            t_s: t_s - zero_s,
            action: Action::Wheels { id: None, v_m_per_s: *v_m_per_s, omega_rad_per_s: *omega_rad_per_s },
        };
        let commands: Vec<Command> = given.rows.iter().map(command).collect();
        notes.extend([
            match are {
                CommandsAre::Told => {
                    "assumed: commands are a wheeled robot's speeds, each held until the next (robot \"create\")"
                }
                CommandsAre::Odometry => {
                    "assumed: the wheels' speeds stand in for the command, held until the next (robot \"create\")"
                }
            }
            .to_owned(),
            format!("found: {} commands; the clock is set to 0 at the first, {zero_s} s", commands.len()),
        ]);
        notes.extend(timing.notes("commands"));
        notes.extend(units::hints_of_wheels(&commands, ["speeds", "turning rates"]));
        Ok((commands, timing, zero_s))
    }

    fn sensor(&self, sightings: &[Sighting], notes: &mut Vec<String>) -> Result<RangeBearing, ImportError> {
        let Table { max_range_m, sensor_origin_m, .. } = *self.table;
        if let Some(max_range_m) = max_range_m.filter(|it| !(it.is_finite() && *it > 0.0)) {
            return Err(self.wrong(format!("max_range_m must be greater than 0, not {max_range_m}")));
        }
        if !sensor_origin_m.iter().all(|it| it.is_finite()) {
            return Err(self.wrong(format!("sensor_origin_m must be two finite numbers, not {sensor_origin_m:?}")));
        }
        let longest_m = sightings.iter().map(|seen| seen.size.value()).fold(f64::MIN_POSITIVE, f64::max);
        if max_range_m.is_none() {
            notes.push(format!("assumed: the sensor's reach is the longest range in the log, {longest_m:.6} m"));
        }
        Ok(RangeBearing { max_range_m: max_range_m.unwrap_or(longest_m), sensor_origin_m })
    }

    fn all(&self) -> Result<Imported, ImportError> {
        let mut notes = Vec::new();
        let landmarks = self.landmarks()?;
        let (commands, timing, zero_s) = self.commands(&mut notes)?;
        let sightings = self.sightings(&landmarks, zero_s, &mut notes)?;
        let frames = self.frames(zero_s, &mut notes)?;
        let track = self.track(zero_s, &mut notes)?;
        let known = Known {
            robot: "create".to_owned(),
            command_rate_hz: Some((timing.rate_hz * 1e6).round() / 1e6),
            range_bearing: Some(self.sensor(&sightings, &mut notes)?),
            landmarks,
            commands_are: self.table.commands.are,
            ..Known::default()
        };
        let log = Log {
            known: known.into(),
            commands: commands.into(),
            frames: frames.map(Into::into),
            sightings: sightings.into(),
            ..Log::default()
        };
        Ok(capture::agreed(log, track, notes))
    }

    fn landmarks(&self) -> Result<Vec<Beacon>, ImportError> {
        let mut landmarks: Vec<Beacon> = Vec::new();
        for &Landmark { id, x_m, y_m } in &self.table.landmarks {
            if landmarks.iter().any(|it| it.id == id) {
                return Err(self.wrong(format!("landmark {id} must be there once, not twice")));
            }
            if !(x_m.is_finite() && y_m.is_finite()) {
                return Err(self.wrong(format!("landmark {id} must stand somewhere, not at {x_m}, {y_m} m")));
            }
            landmarks.push(Beacon { id, x_m, y_m, height_m: None });
        }
        landmarks.sort_by_key(|it| it.id);
        Ok(landmarks)
    }

    /// Sightings of declared landmarks, in order of time; robots often see others besides.
    fn sightings(
        &self,
        landmarks: &[Beacon],
        zero_s: f64,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Sighting>, ImportError> {
        let Sightings { file, t, landmark, range, bearing } = &self.table.sightings;
        let [t_si, range_si] = [self.si(t, Dimension::Time)?, self.si(range, Dimension::Length)?];
        let seen = self.rows(file, [t_si, (landmark, 1.0), range_si, self.si(bearing, Dimension::Angle)?])?;
        clock::forward(&seen.file, &t.column, &seen.times())?;
        let turns = if self.table.bearings == Sense::Clockwise { -1.0 } else { 1.0 };
        let (mut sightings, mut others) = (Vec::new(), 0);
        for (line, [t_s, id, range_m, bearing_rad]) in seen.rows {
            let id = columns::whole(&seen.file, line, landmark, id)?;
            if !landmarks.iter().any(|it| it.id == id) {
                others += 1;
                continue;
            }
            sightings.push(Sighting {
                t_s: t_s - zero_s,
                landmark: id,
                size: Size::RangeM(units::range(&seen.file, line, &range.column, range_m)?),
                bearing_rad: wrap_rad(turns * units::radians(&seen.file, line, &bearing.column, bearing_rad)?),
            });
        }
        notes.push(format!(
            "found: {} sightings of {} landmarks; {others} of what is no landmark, left out",
            sightings.len(),
            landmarks.len()
        ));
        notes.extend(units::hint("ranges", sightings.iter().map(|it| it.size.value()), units::FAR_M, "m"));
        Ok(sightings)
    }

    fn frames(&self, zero_s: f64, notes: &mut Vec<String>) -> Result<Option<Vec<Frame>>, ImportError> {
        let Some(Frames { file, t }) = &self.table.frames else {
            notes.push(
                "assumed: nothing of misses: without [frames] it is not known when the sensor looked and saw nothing"
                    .to_owned(),
            );
            return Ok(None);
        };
        let looked = self.rows(file, [self.si(t, Dimension::Time)?])?;
        notes.extend(clock::timing(&looked.file, &t.column, &looked.times())?.notes("frames"));
        Ok(Some(looked.rows.iter().map(|(_, [t_s])| Frame { t_s: t_s - zero_s, head_pan_rad: 0.0 }).collect()))
    }

    fn track(&self, zero_s: f64, notes: &mut Vec<String>) -> Result<Vec<TruePose>, ImportError> {
        let Some(TrueTrack { file, t, x, y, theta }) = &self.table.truth else { return Ok(Vec::new()) };
        let [x_si, y_si] = [self.si(x, Dimension::Length)?, self.si(y, Dimension::Length)?];
        let poses = self.rows(file, [self.si(t, Dimension::Time)?, x_si, y_si, self.si(theta, Dimension::Angle)?])?;
        clock::timing(&poses.file, &t.column, &poses.times())?;
        let faces_y_rad = match self.table.heading_zero {
            Axis::X => {
                notes.push(
                    "assumed: heading 0 faces +x in the source; pi/2 is taken off, so that 0 faces +y; places stay"
                        .to_owned(),
                );
                FRAC_PI_2
            }
            Axis::Y => 0.0,
        };
        let pose = |(line, [t_s, x_m, y_m, theta_rad]): &(u64, [f64; 4])| {
            let theta_rad = units::radians(&poses.file, *line, &theta.column, *theta_rad)? - faces_y_rad;
            Ok(TruePose { t_s: t_s - zero_s, x_m: *x_m, y_m: *y_m, theta_rad: wrap_rad(theta_rad), v_m_per_s: None })
        };
        poses.rows.iter().map(pose).collect()
    }
}
