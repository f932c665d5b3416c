//! Data sets on disk, format version 1.
//!
//! A data set is a folder that any program can write:
//!
//! | file | columns |
//! |---|---|
//! | `dataset.toml` | what the robot knows before it moves, and where the data set came from |
//! | `commands.csv` | `t_s,action,ax_m_per_s,ay_m_per_s,atheta_rad_per_s` (robot `aibo`), `t_s,throttle,brake,steering` (`car`), `t_s,v_m_per_s,omega_rad_per_s` (`create`), the first or the last (`plain`) |
//! | `frames.csv` | `t_s,head_pan_rad` |
//! | `sightings.csv` | `t_s,landmark,height_px,bearing_rad` or `t_s,landmark,range_m,bearing_rad` |
//! | `odometry.csv` | `t_s,v_m_per_s,omega_rad_per_s` |
//! | `lidar.pcap` | data packets of a Velodyne HDL-64E, stamped in seconds since the log began ([`packets`](crate::packets)) |
//! | `truth.csv` | `t_s,x_m,y_m,theta_rad[,v_m_per_s,...]` |
//! | `survey.toml` | truth about the models |
//!
//! What the reader holds every file to:
//!
//! - TOML files are UTF-8 of at most 4 MiB, with `schema = 1`; unknown keys are errors.
//! - CSV files are UTF-8 with a header, at most 4096 bytes a line and 20 million rows; every line
//!   ends in a line break, so that a file cut short shows. Columns may stand in any order; unknown
//!   and doubled ones are errors, except that `truth.csv` may have further columns of numbers, which
//!   are passed over. A field is empty only where there is no value (`action`, a true speed).
//! - `commands_are` is `"told"`, as without it, or `"odometry"`.
//! - Every number is finite; angles lie in `[-pi, pi)`; heights and ranges are positive, pedals in
//!   0..=1, steering in -1..=1, ids whole numbers in 0..=65535.
//! - Times increase from row to row; sightings of one frame share its time.
//! - Sightings are heights or ranges, as `[camera]` or `[range_bearing]` says, of declared landmarks.
//! - `commands.csv`, `frames.csv`, `sightings.csv`, `odometry.csv`, `lidar.pcap`, `truth.csv` and
//!   `survey.toml` may be missing. Without `frames.csv`, misses are unknown.
//!
//! - `lidar.pcap` may hold other packets, which are passed over, and may lack some, as captures do; [`read_and_count`]
//!   counts both. Its data packets must be sound and in order of time.
//!
//! Other files in the folder are left alone. Reading is total: broken input gives a [`ReadError`] that names file,
//! line and column or packet, rule and value, and nothing is repaired.

mod error;
mod keys;
mod known;
mod lidar;
mod models;
mod number;
mod rows;
mod rule;
mod survey;
mod tables;
mod toml_text;

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use error::{Place, ReadError, WriteError, Wrong};
pub use models::{models_text, parse_models, read_models, write_models};
pub use number::{number, push_number};
pub use survey::{read_survey, write_survey};

use crate::log::{Channel, Command, Known, Log, Sighting, Size, Timed};
use crate::packets::Tally;
use crate::truth::{Dataset, Truth};
use keys::Source;
use rows::{Finding, read_rows, rows_text};
use tables::Table;

/// Reads the data set in the folder `dir`.
///
/// # Errors
/// [`ReadError`] for the first thing found that the format does not allow.
pub fn read(dir: &Path) -> Result<Dataset, ReadError> {
    Ok(read_and_count(dir)?.0)
}

/// Reads the data set in the folder `dir`, and counts the packets of its `lidar.pcap`, if it has one.
///
/// # Errors
/// As [`read`].
pub fn read_and_count(dir: &Path) -> Result<(Dataset, Option<Tally>), ReadError> {
    let (known, provenance) = known::parse(&Source::require(&dir.join("dataset.toml"))?)?;
    let commands = read_rows(&dir.join("commands.csv"), &command_tables(&known.robot), no_header_rule, |_| None)?;
    let frames = read_rows(&dir.join("frames.csv"), &[&tables::FRAMES], no_header_rule, |_| None)?;
    let declared = declared(&known);
    let sightings = read_rows(
        &dir.join("sightings.csv"),
        &[&tables::HEIGHTS, &tables::RANGES],
        |names| mixed(&known, names.contains(&"height_px"), names.contains(&"range_m")),
        |row| undeclared(&declared, row),
    )?;
    let odometry = read_rows(&dir.join("odometry.csv"), &[&tables::ODOMETRY], no_header_rule, |_| None)?;
    let track = read_rows(&dir.join("truth.csv"), &[&tables::TRUTH], no_header_rule, |_| None)?;
    let (firings, tally) = lidar::read(dir)?.map(|(firings, tally)| (Arc::new(firings), tally)).unzip();
    lidar::fits(dir, &known, firings.as_deref())?;
    let survey = Source::read(&dir.join("survey.toml"))?.map(|source| survey::parse(&source)).transpose()?;
    let log = Log {
        known: Arc::new(known),
        commands: channel(commands),
        frames: frames.map(Channel::from),
        sightings: channel(sightings),
        odometry: channel(odometry),
        firings,
    };
    Ok((Dataset { log, truth: Truth { track: channel(track), survey }, provenance }, tally))
}

/// Writes `dataset` into the folder `dir`, which is made if need be; files of the format that
/// stand there are replaced or, where the data set has nothing for them, removed.
///
/// # Errors
/// [`WriteError`] where a file cannot be written, or the data set holds what the reader would refuse;
/// then nothing has been touched.
pub fn write(dataset: &Dataset, dir: &Path) -> Result<(), WriteError> {
    let files = files(dataset, dir)?;
    fs::create_dir_all(dir).map_err(|source| WriteError::Io { file: dir.to_owned(), source })?;
    for (name, text) in files {
        let path = dir.join(name);
        match text {
            Some(text) => replace(&path, &text)?,
            None => remove(path)?,
        }
    }
    lidar::write(dir, dataset.log.firings.as_deref())
}

/// Every file of the format with its text, if the data set has something for it.
fn files(dataset: &Dataset, dir: &Path) -> Result<Vec<(&'static str, Option<String>)>, ReadError> {
    let Dataset { log, truth, provenance } = dataset;
    let known = &*log.known;
    let source = Source { file: dir.join("dataset.toml"), text: known::text(known, provenance.as_ref()) };
    known::parse(&source)?;
    lidar::check(dir, known, log.firings.as_deref())?;

    let declared = declared(known);
    let has = |kind: fn(&Size) -> bool| log.sightings.iter().any(|row| kind(&row.size));
    let (heights, ranges) = (has(|s| matches!(s, Size::HeightPx(_))), has(|s| matches!(s, Size::RangeM(_))));
    let path = dir.join("sightings.csv");
    if let Some((_, wrong)) = mixed(known, heights, ranges) {
        return Err(ReadError { file: path, place: None, wrong: Box::new(wrong) });
    }
    let sightings_table = if ranges { &tables::RANGES } else { &tables::HEIGHTS };
    let sightings = some_rows(dir, "sightings.csv", sightings_table, &log.sightings, |row| undeclared(&declared, row))?;
    let frames = log.frames.as_ref().map(|rows| any_rows(dir, "frames.csv", &tables::FRAMES, rows, |_| None));
    let survey = truth.survey.as_ref().map(|survey| survey::checked_text(survey, &dir.join("survey.toml")));
    Ok(vec![
        ("dataset.toml", Some(source.text)),
        ("commands.csv", some_rows(dir, "commands.csv", command_table(known, &log.commands), &log.commands, |_| None)?),
        ("frames.csv", frames.transpose()?),
        ("sightings.csv", sightings),
        ("odometry.csv", some_rows(dir, "odometry.csv", &tables::ODOMETRY, &log.odometry, |_| None)?),
        ("truth.csv", some_rows(dir, "truth.csv", &tables::TRUTH, &truth.track, |_| None)?),
        ("survey.toml", survey.transpose()?),
    ])
}

fn some_rows<T: Timed>(
    dir: &Path,
    name: &str,
    table: &Table<T>,
    rows: &[T],
    check: impl Fn(&T) -> Finding,
) -> Result<Option<String>, ReadError> {
    if rows.is_empty() { Ok(None) } else { any_rows(dir, name, table, rows, check).map(Some) }
}

fn any_rows<T: Timed>(
    dir: &Path,
    name: &str,
    table: &Table<T>,
    rows: &[T],
    check: impl Fn(&T) -> Finding,
) -> Result<String, ReadError> {
    rows_text(&dir.join(name), table, rows, check)
}

fn replace(path: &Path, text: &str) -> Result<(), WriteError> {
    replace_by(path, |to| to.write_all(text.as_bytes()))
}

/// Writes beside, then renames: a reader sees the old file or the new one.
fn replace_by(path: &Path, put: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), WriteError> {
    let io = |source| WriteError::Io { file: path.to_owned(), source };
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let mut to = BufWriter::with_capacity(1 << 16, File::create(&beside).map_err(io)?);
    put(&mut to).and_then(|()| to.flush()).map_err(io)?;
    fs::rename(&beside, path).map_err(io)
}

fn remove(path: PathBuf) -> Result<(), WriteError> {
    match fs::remove_file(&path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(WriteError::Io { file: path, source }),
        _ => Ok(()),
    }
}

fn channel<T>(rows: Option<Vec<T>>) -> Channel<T> {
    rows.unwrap_or_default().into()
}

fn no_header_rule(_: &[&str]) -> Finding {
    None
}

fn command_tables(robot: &str) -> Vec<&'static Table<Command>> {
    match robot {
        "car" => vec![&tables::PEDALS],
        "create" => vec![&tables::WHEELS],
        "aibo" => vec![&tables::LEGS],
        _ => vec![&tables::LEGS, &tables::WHEELS],
    }
}

/// The table that fits the first command, if the robot has it.
fn command_table(known: &Known, commands: &[Command]) -> &'static Table<Command> {
    let tables = command_tables(&known.robot);
    let fits = |table: &&&Table<Command>| commands.first().is_some_and(|first| (table.give)(first).is_some());
    tables.iter().find(fits).copied().unwrap_or(tables[0])
}

fn declared(known: &Known) -> BTreeSet<u16> {
    known.landmarks.iter().map(|landmark| landmark.id).collect()
}

fn undeclared(declared: &BTreeSet<u16>, row: &Sighting) -> Finding {
    (!declared.contains(&row.landmark)).then_some(("landmark", Wrong::Undeclared { id: row.landmark }))
}

fn mixed(known: &Known, heights: bool, ranges: bool) -> Finding {
    match (heights, ranges) {
        (true, true) => Some(("range_m", Wrong::MixedSightings)),
        (true, false) if known.range_bearing.is_some() => {
            Some(("height_px", Wrong::WrongSightings { expected: "ranges", table: "range_bearing" }))
        }
        (false, true) if known.camera.is_some() => {
            Some(("range_m", Wrong::WrongSightings { expected: "heights", table: "camera" }))
        }
        _ => None,
    }
}
