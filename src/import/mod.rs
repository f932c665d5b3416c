//! Public log formats, read into data sets: one file and one row each.
//!
//! A new importer names its columns and their units, reads them with [`columns::read`] and
//! [`columns::timing`], rotates into the house's frames (theta = 0 faces world +y), and says in
//! [`Imported::notes`] everything that it took for granted.

pub mod barfoot_1d;
pub mod columns;

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
    pub read: fn(&Path) -> Result<Imported, ImportError>,
}

/// Every importer there is.
#[must_use]
pub fn catalogue() -> Vec<&'static Importer> {
    vec![&barfoot_1d::IMPORTER]
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
        name: &'static str,
        /// The header.
        found: String,
    },
    /// A value that breaks a rule.
    #[error("{}:{line}: {column} {rule}, not {found}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// Its line, from 1.
        line: u64,
        /// The column.
        column: &'static str,
        /// What it must be.
        rule: &'static str,
        /// What it is.
        found: String,
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
