//! Named columns of numbers out of a CSV file, plain or gzipped.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;

use super::ImportError;

/// More text than any log that is imported here.
const LONGEST_BYTES: u64 = 256 << 20;

/// A row: its line in the file, and one value a column, `None` where the field is empty.
pub type Row<const N: usize> = (u64, [Option<f64>; N]);

/// The text of a file, gunzipped if its name ends in `.gz`.
///
/// # Errors
/// [`ImportError`] if it cannot be opened.
pub fn open(path: &Path) -> Result<Box<dyn Read>, ImportError> {
    let file =
        File::open(path).map_err(|error| ImportError::Unreadable { file: path.to_owned(), why: error.to_string() })?;
    Ok(match path.extension().is_some_and(|extension| extension == "gz") {
        true => Box::new(GzDecoder::new(file).take(LONGEST_BYTES)),
        false => Box::new(file.take(LONGEST_BYTES)),
    })
}

/// The file `name` or `name.gz` in `folder`; or `folder` itself, if it is a file.
#[must_use]
pub fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    [folder.to_owned(), folder.join(name), folder.join(format!("{name}.gz"))].into_iter().find(|path| path.is_file())
}

/// The file `name` or `name.gz` of the source that is the folder `folder`.
///
/// # Errors
/// [`ImportError::Absent`] with `hint` where there is none.
pub fn of_folder(folder: &Path, name: &str, hint: &'static str) -> Result<PathBuf, ImportError> {
    let found = if folder.is_dir() { find(folder, name) } else { None };
    found.ok_or_else(|| ImportError::Absent { path: folder.join(name), hint })
}

/// The number that a row must have under `column`.
///
/// # Errors
/// [`ImportError`] where the field is empty.
pub fn required(file: &Path, line: u64, column: &str, value: Option<f64>) -> Result<f64, ImportError> {
    let (file, column) = (file.to_owned(), column.to_owned());
    value.ok_or(ImportError::Value { file, line, column, rule: "must be a finite number", found: "empty".to_owned() })
}

/// A number that counts or names.
///
/// # Errors
/// [`ImportError`] where it is not a whole number that fits.
pub fn whole(file: &Path, line: u64, column: &str, value: f64) -> Result<u16, ImportError> {
    if value.fract() == 0.0 && (0.0..=f64::from(u16::MAX)).contains(&value) {
        return Ok(value as u16);
    }
    let rule = "must be a whole number in 0..=65535";
    Err(ImportError::Value { file: file.to_owned(), line, column: column.to_owned(), rule, found: value.to_string() })
}

/// The columns `names` of `path`, whatever others there are; gunzipped if its name ends in `.gz`.
///
/// # Errors
/// [`ImportError`] where the file cannot be read, lacks a column, or a value is not a finite number.
pub fn read<const N: usize>(path: &Path, names: [&str; N]) -> Result<Vec<Row<N>>, ImportError> {
    let unreadable = |why: String| ImportError::Unreadable { file: path.to_owned(), why };
    let mut csv = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(open(path)?);
    let header = csv.headers().map_err(|e| unreadable(e.to_string()))?.clone();
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(names) {
        *place = header.iter().position(|found| found == name).ok_or_else(|| ImportError::MissingColumn {
            file: path.to_owned(),
            name: name.to_owned(),
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
                column: column.to_owned(),
                rule: "must be a finite number or empty",
                found,
            })?;
        }
        rows.push((line, values));
    }
    Ok(rows)
}

/// A field's number, `None` where it is empty; or the field, cut short for a message.
pub(super) fn number(field: &str) -> Result<Option<f64>, String> {
    if field.is_empty() {
        return Ok(None);
    }
    let shown = || field.chars().take(40).collect();
    field.parse::<f64>().ok().filter(|value| value.is_finite()).map(Some).ok_or_else(shown)
}
