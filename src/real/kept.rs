//! Finished diagnoses, kept by sweep and by log: a scenario that asks for logs of which another asked before takes what was found.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::sweep::CannotSweep;
use crate::sweep::cases::{Found, Store};

/// What is kept of some cases.
pub struct Kept<'a> {
    of_sweep: &'a Store,
    /// Each case's name, and where it is found whichever scenario asks for it.
    cases: Vec<(String, Store)>,
}

impl<'a> Kept<'a> {
    /// Of cases with names and what they are of, be it of this sweep or under `libraries`.
    ///
    /// # Errors
    /// If a folder cannot be made.
    pub fn open(of_sweep: &'a Store, libraries: &Path, cases: Vec<(String, String)>) -> Result<Self, CannotSweep> {
        let open = |(name, of): (String, String)| {
            let key = blake3::hash(of.as_bytes()).to_hex();
            Ok((name, Store::open(&libraries.join("logs").join(&key[..12]), key.as_ref())?))
        };
        Ok(Self { of_sweep, cases: cases.into_iter().map(open).collect::<Result<_, CannotSweep>>()? })
    }

    /// What was done of each case.
    ///
    /// # Errors
    /// If a folder cannot be read or written.
    pub fn find<R: Serialize + DeserializeOwned>(&self) -> Result<Found<R>, CannotSweep> {
        let names: Vec<String> = self.cases.iter().map(|it| it.0.clone()).collect();
        let mut found = self.of_sweep.find::<R>(&names)?;
        for ((name, of_log), record) in self.cases.iter().zip(&mut found.records) {
            if record.is_none() {
                *record = of_log.read(name);
                record.iter().try_for_each(|it| self.of_sweep.keep(name, it))?;
            }
        }
        found.count.done = found.records.iter().flatten().count();
        Ok(found)
    }

    /// Keeps a finished case, by its number.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep<R: Serialize>(&self, case: usize, record: &R) -> Result<(), CannotSweep> {
        let (name, of_log) = &self.cases[case];
        of_log.keep(name, record)?;
        self.of_sweep.keep(name, record)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second sweep finds what a first one made of the same log, and nothing of another log or of one that was changed.
    #[test]
    fn another_sweep_takes_what_is_of_the_same_log() {
        let dir = tempfile::tempdir().unwrap();
        let (libraries, case) = (dir.path().join("library"), |name: &str, of: &str| (name.to_owned(), of.to_owned()));
        let store = |name: &str| Store::open(&dir.path().join(name), name).unwrap();
        let (first, second) = (store("first"), store("second"));
        let kept = Kept::open(&first, &libraries, vec![case("whole", "a log"), case("half", "half of it")]).unwrap();
        assert_eq!(kept.find::<f64>().unwrap().records, [None, None]);
        kept.keep(0, &0.94).unwrap();
        kept.keep(1, &0.95).unwrap();
        let asked = vec![case("half", "half of it"), case("whole", "a log, changed"), case("other", "a log")];
        let kept = Kept::open(&second, &libraries, asked).unwrap();
        let found = kept.find::<f64>().unwrap();
        assert_eq!((found.records, found.count.done), (vec![Some(0.95), None, None], 1));
        // From then on it is the second sweep's own.
        std::fs::remove_dir_all(&libraries).unwrap();
        assert_eq!(second.find::<f64>(&["half".to_owned()]).unwrap().records, [Some(0.95)]);
    }
}
