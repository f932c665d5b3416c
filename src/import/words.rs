//! Columns of numbers out of text with blanks between them and `#` before remarks, plain or gzipped.

use std::io::{BufRead, BufReader};
use std::path::Path;

use super::ImportError;
use super::columns::{number, open};

/// The rows of `path`, each with its line, under columns called `names`.
///
/// # Errors
/// [`ImportError`] where the file cannot be read, a row has other than `N` fields, or a field is not a finite number.
pub fn read<const N: usize>(path: &Path, names: [&str; N]) -> Result<Vec<(u64, [f64; N])>, ImportError> {
    let mut rows = Vec::new();
    for (line, text) in (1..).zip(BufReader::new(open(path)?).lines()) {
        let text = text
            .map_err(|error| ImportError::Unreadable { file: path.to_owned(), why: format!("line {line}: {error}") })?;
        let row = text.split('#').next().unwrap_or_default();
        let fields = row.split_ascii_whitespace().collect::<Vec<_>>();
        if fields.is_empty() {
            continue;
        }
        if fields.len() != N {
            let (needed, found) = (N, fields.len());
            return Err(ImportError::Fields { file: path.to_owned(), line, names: names.join(" "), needed, found });
        }
        let mut values = [0.0; N];
        for ((value, field), column) in values.iter_mut().zip(fields).zip(names) {
            let (file, rule) = (path.to_owned(), "must be a finite number");
            *value = number(field).ok().flatten().ok_or_else(|| ImportError::Value {
                file,
                line,
                column: column.to_owned(),
                rule,
                found: field.chars().take(40).collect(),
            })?;
        }
        rows.push((line, values));
    }
    Ok(rows)
}
