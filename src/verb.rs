//! What every verb does alike: results to stdout, the rest to stderr, and how it exits.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;

use asami_dataset::packets::Tally;
use asami_dataset::store::{self, Place, ReadError};
use asami_dataset::{Dataset, Log};
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

/// `PARAM=VALUE` on a command line.
///
/// # Errors
/// What it must be.
pub fn assignment(text: &str) -> Result<(String, f64), String> {
    let pair =
        text.split_once('=').and_then(|(name, value)| Some((name.trim().to_owned(), value.trim().parse().ok()?)));
    pair.filter(|(_, value): &(String, f64)| value.is_finite()).ok_or_else(|| "must be NAME=NUMBER".to_owned())
}

/// The part of a log that a verb looks at.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Window {
    /// Only the log from this time on
    #[arg(long, value_name = "S")]
    from_s: Option<f64>,
    /// Only so much of the log
    #[arg(long, value_name = "S")]
    duration_s: Option<f64>,
}

impl Window {
    /// That part of `log`.
    #[must_use]
    pub fn of(&self, log: &Log) -> Log {
        let (None, None) = (self.from_s, self.duration_s) else {
            let from_s = self.from_s.or(log.span_s().map(|(first_s, _)| first_s)).unwrap_or(0.0);
            return log.window(from_s..self.duration_s.map_or(f64::INFINITY, |duration_s| from_s + duration_s));
        };
        log.clone()
    }
}

/// Reads a data set; what its capture lacks goes to stderr.
///
/// # Errors
/// A report that shows what is wrong with which file.
pub fn dataset(dir: &Path) -> Result<Dataset, Report> {
    let (dataset, tally) = store::read_and_count(dir).map_err(shown)?;
    if let Some(note) = tally.as_ref().and_then(note) {
        eprintln!("{}: {note}", dir.join("lidar.pcap").display());
    }
    Ok(dataset)
}

/// What a capture has besides sound packets without a gap.
fn note(tally: &Tally) -> Option<String> {
    let counts = [(tally.lost_packets, "lost"), (tally.skipped, "of other kinds passed over")];
    let mut said: Vec<String> = counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    if tally.gaps > 0 {
        said.push(format!("{} gaps", tally.gaps));
    }
    if tally.jumps > 0 {
        said.push(format!("the encoder jumps {} times", tally.jumps));
    }
    (!said.is_empty()).then(|| format!("{} packets read; {}", tally.packets, said.join(", ")))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_capture_that_lacks_something_is_spoken_of() {
        let sound = Tally { packets: 900, ..Tally::default() };
        assert_eq!(note(&sound), None);
        let torn = Tally { lost_packets: 3, gaps: 1, ..sound };
        assert_eq!(note(&torn).unwrap(), "900 packets read; 3 lost, 1 gaps");
    }
}
