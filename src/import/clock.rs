//! Whether times go forward, how regularly rows come, and what a clock in the wrong unit looks like.

use std::path::Path;

use super::ImportError;

/// How regularly rows come.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// One over the median step.
    pub rate_hz: f64,
    /// Where a step is more than one and a half times the median: from, to.
    pub gaps_s: Vec<(f64, f64)>,
    /// Shortest and longest step.
    pub steps_s: (f64, f64),
}

/// Checks that times increase, and measures their rate and gaps.
///
/// # Errors
/// [`ImportError`] for the first time that does not increase, or for fewer than two.
pub fn timing(file: &Path, column: &str, times: &[(u64, f64)]) -> Result<Timing, ImportError> {
    if times.len() < 2 {
        return Err(ImportError::TooShort { file: file.to_owned(), needed: 2, found: times.len() });
    }
    if let Some(pair) = times.windows(2).find(|pair| pair[1].1 <= pair[0].1) {
        let ((_, before_s), (line, t_s)) = (pair[0], pair[1]);
        let found = format!("{t_s} after {before_s}");
        return Err(ImportError::Value {
            file: file.to_owned(),
            line,
            column: column.to_owned(),
            rule: "must increase",
            found,
        });
    }
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    let gaps = |median: f64| {
        let long = times.windows(2).filter(|pair| pair[1].1 - pair[0].1 > 1.5 * median);
        long.map(|pair| (pair[0].1, pair[1].1)).collect()
    };
    steps.sort_by(f64::total_cmp);
    let median = steps[steps.len() / 2];
    Ok(Timing { rate_hz: 1.0 / median, gaps_s: gaps(median), steps_s: (steps[0], steps[steps.len() - 1]) })
}

/// Checks that times do not go back, for rows of which several may have one time.
///
/// # Errors
/// [`ImportError`] for the first time that goes back.
pub fn forward(file: &Path, column: &str, times: &[(u64, f64)]) -> Result<(), ImportError> {
    let Some(pair) = times.windows(2).find(|pair| pair[1].1 < pair[0].1) else { return Ok(()) };
    let ((_, before_s), (line, t_s)) = (pair[0], pair[1]);
    let found = format!("{t_s} after {before_s}");
    Err(ImportError::Value { file: file.to_owned(), line, column: column.to_owned(), rule: "must not decrease", found })
}

impl Timing {
    /// What was found of the rows called `what`, a sentence each.
    #[must_use]
    pub fn notes(&self, what: &str) -> Vec<String> {
        let (shortest_s, longest_s) = self.steps_s;
        let mut notes = vec![format!(
            "found: {what} at {:.3} Hz, steps of {shortest_s:.4} to {longest_s:.4} s, {} gaps",
            self.rate_hz,
            self.gaps_s.len()
        )];
        notes.extend(self.gaps_s.iter().filter(|(from_s, to_s)| to_s - from_s > LONG_GAP_S).take(MOST_GAPS).map(
            |(from_s, to_s)| {
                format!("found: a gap of {:.3} s in {what}, from {from_s:.3} to {to_s:.3} s", to_s - from_s)
            },
        ));
        if self.rate_hz < SLOWEST_HZ {
            let step = 1.0 / self.rate_hz;
            notes.push(format!("hint: {what} come every {step} s; are their times milliseconds or microseconds?"));
        }
        if self.rate_hz > FASTEST_HZ {
            notes.push(format!("hint: {what} come at {:.0} Hz; are their times seconds?", self.rate_hz));
        }
        notes
    }
}

/// A gap worth a sentence of its own.
const LONG_GAP_S: f64 = 0.5;
/// So many of them.
const MOST_GAPS: usize = 10;
/// Slower than any robot's log that could be learned from.
const SLOWEST_HZ: f64 = 0.1;
/// Faster than any sensor that is imported here.
const FASTEST_HZ: f64 = 20_000.0;
