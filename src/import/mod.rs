//! Public log formats, read into data sets: one file and one row each.
//!
//! A new importer names its columns and their units, reads them with [`columns`] (CSV) or [`words`] (text in columns
//! of blanks), has their clock and units checked, rotates into the house's frames (theta = 0 faces world +y), and
//! says in [`Imported::notes`] everything that it took for granted. Where the log has a motion capture, [`capture`]
//! holds its sightings against it.

pub mod av21;
pub mod barfoot_1d;
pub mod barfoot_2d;
pub mod capture;
pub mod clock;
pub mod columns;
pub mod hdl64e;
pub mod kitti;
pub mod mapped;
pub mod mrclam;
pub mod track;
pub mod units;
pub mod words;

use std::path::{Path, PathBuf};

use asami_dataset::Dataset;

/// A format that can be imported.
#[derive(Debug)]
pub struct Importer {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it reads.
    pub what: &'static str,
    /// Where the data come from.
    pub source: &'static str,
    /// Reads it from a file or folder.
    pub read: Read,
}

/// How many robots' logs a source of a format holds.
#[derive(Debug)]
pub enum Read {
    /// One.
    One(fn(&Path) -> Result<Imported, ImportError>),
    /// One for each of these numbers.
    OneOf(&'static [u16], fn(&Path, u16) -> Result<Imported, ImportError>),
}

impl Importer {
    /// Reads the log of `robot` at `source`; `robot` is `None` for formats of one robot.
    ///
    /// # Errors
    /// [`ImportError`] where there is no such log or robot, or the log is not as its format says.
    pub fn import(&self, source: &Path, robot: Option<u16>) -> Result<Imported, ImportError> {
        match (&self.read, robot) {
            (Read::One(read), None) => read(source),
            (Read::OneOf(robots, read), Some(robot)) if robots.contains(&robot) => read(source, robot),
            (_, found) => Err(ImportError::Robot { format: self.name, robots: self.robots(), found }),
        }
    }

    /// The robots to choose from; empty for formats of one robot.
    #[must_use]
    pub fn robots(&self) -> &'static [u16] {
        match self.read {
            Read::One(_) => &[],
            Read::OneOf(robots, _) => robots,
        }
    }
}

/// Every importer there is.
#[must_use]
pub fn catalogue() -> Vec<&'static Importer> {
    vec![
        &barfoot_1d::IMPORTER,
        &barfoot_2d::IMPORTER,
        &mrclam::IMPORTER,
        &kitti::IMPORTER,
        &av21::IMPORTER,
        &hdl64e::IMPORTER,
        &mapped::IMPORTER,
    ]
}

/// What an importer gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The data set.
    pub dataset: Dataset,
    /// What was assumed and what was found, a sentence each.
    pub notes: Vec<String>,
}

/// What kept a log from being imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// Nothing there.
    #[error("{}: no such file or folder; {hint}", path.display())]
    Absent {
        /// The path given.
        path: PathBuf,
        /// Where the data can be had.
        hint: &'static str,
    },
    /// The operating system, the decompression or the CSV syntax refuses.
    #[error("{}: cannot be read: {why}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        why: String,
    },
    /// A column that the importer needs.
    #[error("{}:1: the header must have a column {name}; it has {found}", file.display())]
    MissingColumn {
        /// The file.
        file: PathBuf,
        /// Which.
        name: String,
        /// The header.
        found: String,
    },
    /// A table that says what is where, and is wrong.
    #[error("{}: {why}", file.display())]
    Table {
        /// The file.
        file: PathBuf,
        /// Where in it, and what.
        why: String,
    },
    /// A value that breaks a rule.
    #[error("{}:{line}: {column} {rule}, not {found}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// Its line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// What it must be.
        rule: &'static str,
        /// What it is.
        found: String,
    },
    /// A row with too few or too many fields.
    #[error("{}:{line}: a row must have {needed} fields ({names}), not {found}", file.display())]
    Fields {
        /// The file.
        file: PathBuf,
        /// Its line, from 1.
        line: u64,
        /// What they are.
        names: String,
        /// How many.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A robot that the source does not hold, or none where one must be chosen.
    #[error("{}", robot_rule(format, robots, *found))]
    Robot {
        /// The format.
        format: &'static str,
        /// To choose from.
        robots: &'static [u16],
        /// What was asked for.
        found: Option<u16>,
    },
    /// Nothing but a header.
    #[error("{}: must have at least {needed} rows, not {found}", file.display())]
    TooShort {
        /// The file.
        file: PathBuf,
        /// Needed.
        needed: usize,
        /// Found.
        found: usize,
    },
}

fn robot_rule(format: &str, robots: &[u16], found: Option<u16>) -> String {
    let found = found.map_or("none".to_owned(), |robot| robot.to_string());
    match robots {
        [] => format!("robot must be left out: a {format} source holds one robot's log; found {found}"),
        _ => {
            let robots: Vec<String> = robots.iter().map(u16::to_string).collect();
            format!("robot must be one of {} for {format}, not {found}", robots.join(", "))
        }
    }
}
