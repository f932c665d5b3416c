//! Named columns of numbers out of a CSV file, plain or gzipped.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;

use super::ImportError;

/// More text than any log that is imported here.
const LONGEST_BYTES: u64 = 256 << 20;

/// A row: its line in the file, and one value a column, `None` where the field is empty.
pub type Row<const N: usize> = (u64, [Option<f64>; N]);

/// The columns `names` of `path`, whatever others there are; gunzipped if its name ends in `.gz`.
///
/// # Errors
/// [`ImportError`] where the file cannot be read, lacks a column, or a value is not a finite number.
pub fn read<const N: usize>(path: &Path, names: [&'static str; N]) -> Result<Vec<Row<N>>, ImportError> {
    let unreadable = |why: String| ImportError::Unreadable { file: path.to_owned(), why };
    let file = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let plain: Box<dyn Read> = match path.extension().is_some_and(|extension| extension == "gz") {
        true => Box::new(GzDecoder::new(file)),
        false => Box::new(file),
    };
    let mut csv = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(plain.take(LONGEST_BYTES));
    let header = csv.headers().map_err(|e| unreadable(e.to_string()))?.clone();
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(names) {
        *place = header.iter().position(|found| found == name).ok_or_else(|| ImportError::MissingColumn {
            file: path.to_owned(),
            name,
            found: header.iter().take(20).collect::<Vec<_>>().join(","),
        })?;
    }
    let mut rows = Vec::new();
    for record in csv.records() {
        let record = record.map_err(|e| unreadable(e.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut values = [None; N];
        for ((value, place), column) in values.iter_mut().zip(places).zip(names) {
            *value = number(record.get(place).unwrap_or_default()).map_err(|found| ImportError::Value {
                file: path.to_owned(),
                line,
                column,
                rule: "must be a finite number or empty",
                found,
            })?;
        }
        rows.push((line, values));
    }
    Ok(rows)
}

fn number(field: &str) -> Result<Option<f64>, String> {
    if field.is_empty() {
        return Ok(None);
    }
    let shown = || field.chars().take(40).collect();
    field.parse::<f64>().ok().filter(|value| value.is_finite()).map(Some).ok_or_else(shown)
}

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
pub fn timing(file: &Path, column: &'static str, times: &[(u64, f64)]) -> Result<Timing, ImportError> {
    if times.len() < 2 {
        return Err(ImportError::TooShort { file: file.to_owned(), needed: 2, found: times.len() });
    }
    if let Some(pair) = times.windows(2).find(|pair| pair[1].1 <= pair[0].1) {
        let ((_, before_s), (line, t_s)) = (pair[0], pair[1]);
        let found = format!("{t_s} after {before_s}");
        return Err(ImportError::Value { file: file.to_owned(), line, column, rule: "must increase", found });
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
