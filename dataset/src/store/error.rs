//! What can be wrong with a data set on disk, and where.

use std::fmt;
use std::path::PathBuf;

use crate::packets::{PacketError, Unfit};

/// A file that is not what the format says: which, where, which rule, what value.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {wrong}", file.display(), Colon(place))]
pub struct ReadError {
    /// The file.
    pub file: PathBuf,
    /// Where in it, unless the fault is the file's as a whole.
    pub place: Option<Place>,
    /// The rule and the value.
    pub wrong: Box<Wrong>,
}

/// A place in a text file, both counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: u64,
    /// Character within the line.
    pub column: u64,
}

struct Colon<'a>(&'a Option<Place>);

impl fmt::Display for Colon<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |Place { line, column }| write!(f, ":{line}:{column}"))
    }
}

/// The rule that was broken, and the value that breaks it.
#[derive(Debug, thiserror::Error)]
pub enum Wrong {
    /// A file that must be there is not.
    #[error("the file must be there, but is not")]
    Missing,
    /// A folder, a pipe or a device.
    #[error("must be a regular file")]
    NotAFile,
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Unreadable(#[source] std::io::Error),
    /// Longer than any honest file of its kind.
    #[error("must not be longer than {limit_bytes} bytes")]
    TooLong {
        /// The limit.
        limit_bytes: u64,
    },
    /// More rows than any honest file.
    #[error("must not have more than {limit} rows")]
    TooManyRows {
        /// The limit.
        limit: usize,
    },
    /// A line longer than any honest line.
    #[error("a line must not be longer than {limit_bytes} bytes")]
    LineTooLong {
        /// The limit.
        limit_bytes: usize,
    },
    /// Not text.
    #[error("must be UTF-8")]
    NotUtf8,
    /// A mark of byte order before the header.
    #[error("must not begin with a byte order mark")]
    ByteOrderMark,
    /// The last line lacks its end: a file cut short cannot be told from a whole one otherwise.
    #[error("must end in a line break: the file seems to have been cut short")]
    CutShort,
    /// An empty line.
    #[error("a line must not be blank")]
    Blank,
    /// A row of another width than the header.
    #[error("a row must have as many fields as the header, {expected}, not {found}")]
    FieldCount {
        /// Columns in the header.
        expected: usize,
        /// Fields in the row.
        found: usize,
    },
    /// A required column is not in the header.
    #[error("the header must have a column {name} (columns: {columns})")]
    MissingColumn {
        /// Which.
        name: &'static str,
        /// The file's columns.
        columns: String,
    },
    /// A column that the format does not have.
    #[error("unknown column {name} (columns: {columns})")]
    UnknownColumn {
        /// Its name.
        name: String,
        /// The file's columns.
        columns: String,
    },
    /// A column that stands twice.
    #[error("column {name} must not stand twice")]
    DuplicateColumn {
        /// Its name.
        name: String,
    },
    /// A command of another robot, or of another kind than the first.
    #[error("commands must be of one kind, and of the kind that the robot takes")]
    OtherKind,
    /// Heights and ranges in one log.
    #[error("sightings must be heights or ranges, not both")]
    MixedSightings,
    /// Heights from a range sensor, or ranges from a camera.
    #[error("sightings must be {expected}: dataset.toml has [{table}]")]
    WrongSightings {
        /// `heights` or `ranges`.
        expected: &'static str,
        /// The sensor's table.
        table: &'static str,
    },
    /// The file is not TOML.
    #[error("{0}")]
    Syntax(String),
    /// A format of another version.
    #[error("schema must be 1, not {found}")]
    Schema {
        /// What stands there.
        found: String,
    },
    /// A required key is not there.
    #[error("a key {name} must be given")]
    MissingKey {
        /// Which.
        name: &'static str,
    },
    /// A key that the format does not have.
    #[error("unknown key {name} (keys: {keys})")]
    UnknownKey {
        /// Its name.
        name: String,
        /// The table's keys.
        keys: String,
    },
    /// A value that breaks its rule.
    #[error("{name} {rule}, not {found}")]
    Value {
        /// Key or column.
        name: String,
        /// What it must be.
        rule: &'static str,
        /// What stands there.
        found: String,
    },
    /// A list of another length than it must have.
    #[error("{name} must have {expected} values, not {found}")]
    Length {
        /// Key.
        name: &'static str,
        /// How many it must have.
        expected: String,
        /// How many it has.
        found: usize,
    },
    /// Something named twice.
    #[error("{name} must differ from one another: {found} stands twice")]
    Twice {
        /// What.
        name: &'static str,
        /// The value.
        found: String,
    },
    /// A row earlier than the one before it.
    #[error("times must {rule}: {t_s} follows {previous_s}")]
    TimeGoesBack {
        /// `increase` or `not decrease`.
        rule: &'static str,
        /// Its time.
        t_s: f64,
        /// The time of the row before.
        previous_s: f64,
    },
    /// A packet of the laser scanner's, by its number, that is not what it must be.
    #[error("{0}")]
    Packet(#[from] PacketError),
    /// Laser firings that packets cannot hold.
    #[error("{0}")]
    Firings(#[from] Unfit),
    /// A sighting of something unknown.
    #[error("landmark must be one that dataset.toml declares, not {id}")]
    Undeclared {
        /// Its id.
        id: u16,
    },
}

impl Wrong {
    /// A value that breaks a rule, cut to a readable length.
    pub(super) fn value(name: &str, rule: &'static str, found: &str) -> Self {
        Wrong::Value { name: name.to_owned(), rule, found: shown(found) }
    }
}

/// What stands there, fit for one line of an error message.
pub(super) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.is_empty() {
        return "an empty field".to_owned();
    }
    let mut shown: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push_str("...");
    }
    shown
}

/// What kept a data set or a model from being written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: cannot be written: {source}", file.display())]
    Io {
        /// The file or folder.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// What was to be written is not what the format allows; nothing was written in its place.
    #[error("cannot be written as a data set of version 1: {0}")]
    Unfit(#[from] ReadError),
}
