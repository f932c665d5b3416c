//! What every verb does alike: results to stdout, the rest to stderr, and how it exits.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use asami_dataset::store::{Place, ReadError};
use miette::{LabeledSpan, NamedSource, Report};

/// How a verb ended without an error of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Done: exit 0.
    Done,
    /// Done, but some trial had an error: exit 3.
    TrialErred,
}

/// Runs a verb: exit 0 or 3 as it [`Ending`] says, 2 with its report where input is bad or missing, 1
/// where it panics (our bug).
pub fn main(verb: impl FnOnce() -> Result<Ending, Report>) -> ExitCode {
    match catch_unwind(AssertUnwindSafe(verb)) {
        Ok(Ok(Ending::Done)) => ExitCode::SUCCESS,
        Ok(Ok(Ending::TrialErred)) => ExitCode::from(3),
        Ok(Err(report)) => {
            eprintln!("{report:?}");
            ExitCode::from(2)
        }
        Err(_) => {
            eprintln!("This is a bug in asami.");
            ExitCode::from(1)
        }
    }
}

/// Prints a result; a reader that has gone away (`| head`) is no error.
pub fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// An error in a report of one sentence.
pub fn plain(error: impl std::error::Error + Send + Sync + 'static) -> Report {
    Report::msg(error.to_string())
}

/// Files longer than this are named, not shown.
const LONGEST_SHOWN_BYTES: u64 = 4 << 20;

/// What is wrong with a file of a data set, shown in the file where it is short enough.
#[must_use]
pub fn shown(error: ReadError) -> Report {
    let short = std::fs::metadata(&error.file).is_ok_and(|of| of.is_file() && of.len() <= LONGEST_SHOWN_BYTES);
    let text = short.then(|| std::fs::read_to_string(&error.file).ok()).flatten();
    match (error.place, text) {
        (Some(place), Some(text)) => {
            let label = LabeledSpan::at_offset(offset(&text, place), error.wrong.to_string());
            let source = NamedSource::new(error.file.display().to_string(), text);
            miette::miette!(labels = vec![label], "{error}").with_source_code(source)
        }
        _ => plain(error),
    }
}

fn offset(text: &str, place: Place) -> usize {
    let line = text.split_inclusive('\n').take(place.line.saturating_sub(1) as usize).map(str::len).sum::<usize>();
    let within = text.get(line..).unwrap_or_default().chars().take(place.column.saturating_sub(1) as usize);
    (line + within.map(char::len_utf8).sum::<usize>()).min(text.len())
}
