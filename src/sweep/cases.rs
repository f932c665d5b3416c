//! One file for each finished case: what makes a stopped sweep go on.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::CannotSweep;

/// The folder of finished cases.
pub struct Store {
    folder: PathBuf,
    key: String,
}

/// What a folder held before the sweep began.
#[derive(Debug)]
pub struct Found<R> {
    /// For each case, what was done of it.
    pub records: Vec<Option<R>>,
    /// In numbers.
    pub count: Count,
}

/// How much of a sweep was done before it began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// Cases done.
    pub done: usize,
    /// Of how many.
    pub of: usize,
    /// Whether there were cases of another scenario or program, which are not gone on with.
    pub stale: bool,
}

/// The file of a case.
#[derive(Serialize, Deserialize)]
struct Kept<R> {
    key: String,
    record: R,
}

/// Only the key: what a file of another program may still have in common with ours.
#[derive(Deserialize)]
struct Keyed {
    key: String,
}

impl Store {
    /// Opens the folder `cases` under `out`, making it if need be.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn open(out: &Path, key: &str) -> Result<Self, CannotSweep> {
        let folder = out.join("cases");
        std::fs::create_dir_all(&folder).map_err(CannotSweep::file("make", &folder))?;
        Ok(Self { folder, key: key.to_owned() })
    }

    /// Looks for each case of these names, and removes what belongs to none of them.
    ///
    /// # Errors
    /// If the folder cannot be read, or leftovers not be removed.
    pub fn find<R: DeserializeOwned>(&self, cases: &[String]) -> Result<Found<R>, CannotSweep> {
        let mut stale = false;
        let entries = std::fs::read_dir(&self.folder).map_err(CannotSweep::file("read", &self.folder))?;
        for entry in entries {
            let path = entry.map_err(CannotSweep::file("read", &self.folder))?.path();
            let is_case = path.extension().is_some_and(|extension| extension == "json");
            let is_part = path.extension().is_some_and(|extension| extension == "part");
            if !is_case && !is_part {
                continue;
            }
            let key = is_case.then(|| std::fs::read(&path).ok()).flatten();
            let key = key.and_then(|bytes| serde_json::from_slice::<Keyed>(&bytes).ok()).map(|kept| kept.key);
            if key.as_deref() == Some(&*self.key) {
                continue;
            }
            // Half-written files of a killed sweep end in .part: they say nothing of another program.
            stale |= is_case;
            std::fs::remove_file(&path).map_err(CannotSweep::file("remove", &path))?;
        }
        let records: Vec<_> = cases.iter().map(|case| self.read(case)).collect();
        let count = Count { done: records.iter().flatten().count(), of: records.len(), stale };
        Ok(Found { records, count })
    }

    /// Keeps a finished case: written aside, then renamed, so that a file is whole or not there.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep<R: Serialize>(&self, case: &str, record: &R) -> Result<(), CannotSweep> {
        let path = self.path(case);
        let kept = Kept { key: self.key.clone(), record };
        let bytes = serde_json::to_vec(&kept).map_err(|error| std::io::Error::other(error.to_string()));
        write_whole(&path, &bytes.map_err(CannotSweep::file("serialise", &path))?)
    }

    fn path(&self, case: &str) -> PathBuf {
        self.folder.join(format!("{case}.json"))
    }

    /// What was done of a case.
    pub fn read<R: DeserializeOwned>(&self, case: &str) -> Option<R> {
        let bytes = std::fs::read(self.path(case)).ok()?;
        let kept: Kept<R> = serde_json::from_slice(&bytes).ok()?;
        (kept.key == self.key).then_some(kept.record)
    }
}

/// What a sweep kept of a case under `out`, whichever program and scenario made it; `None` where that is nothing that can be read.
#[must_use]
pub fn kept<R: DeserializeOwned>(out: &Path, case: &str) -> Option<R> {
    let bytes = std::fs::read(out.join("cases").join(format!("{case}.json"))).ok()?;
    serde_json::from_slice::<Kept<R>>(&bytes).ok().map(|kept| kept.record)
}

/// Writes a file aside, then renames it.
///
/// # Errors
/// If either fails.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), CannotSweep> {
    let mut aside = path.as_os_str().to_owned();
    aside.push(".part");
    let aside = PathBuf::from(aside);
    std::fs::write(&aside, bytes).map_err(CannotSweep::file("write", &aside))?;
    std::fs::rename(&aside, path).map_err(CannotSweep::file("rename", path))
}
