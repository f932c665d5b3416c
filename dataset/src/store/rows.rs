//! Reading and writing one CSV file, row by row.

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::error::{Place, ReadError, Wrong, shown};
use super::number::push_number;
use super::rule::Rule;
use super::tables::{Column, Fields, May, Table};
use crate::log::Timed;

const LONGEST_LINE_BYTES: usize = 4096;
const MOST_ROWS: usize = 20_000_000;

/// What a further check of a row finds: the column, and what is wrong with it.
pub(super) type Finding = Option<(&'static str, Wrong)>;

/// Opens a regular file; `None` if there is none of that name.
pub(super) fn open(path: &Path) -> Result<Option<File>, ReadError> {
    let whole = |wrong| ReadError { file: path.to_owned(), place: None, wrong: Box::new(wrong) };
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => File::open(path).map(Some).map_err(|e| whole(Wrong::Unreadable(e))),
        Ok(_) => Err(whole(Wrong::NotAFile)),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
        Err(e) => Err(whole(Wrong::Unreadable(e))),
    }
}

/// All rows of `path`, as the first of `tables` whose columns its header has; `None` if there is no
/// such file.
pub(super) fn read_rows<T: Timed>(
    path: &Path,
    tables: &[&Table<T>],
    check_header: impl FnOnce(&[&str]) -> Finding,
    check: impl Fn(&T) -> Finding,
) -> Result<Option<Vec<T>>, ReadError> {
    let Some(file) = open(path)? else { return Ok(None) };
    let mut lines = Lines { path, from: BufReader::new(file), line: 0, buffer: Vec::new() };
    if !lines.next()? {
        return Err(lines.wrong(1, Wrong::CutShort));
    }
    let header = lines.text()?.to_owned();
    let names: Vec<&str> = header.split(',').map(unquoted).collect();
    if header.starts_with('\u{feff}') {
        return Err(lines.wrong(1, Wrong::ByteOrderMark));
    }
    if let Some((name, wrong)) = check_header(&names) {
        return Err(lines.wrong(column_of(&header, &names, name), wrong));
    }
    let table = best(tables, &names);
    let places = places(table, &names).map_err(|(i, wrong)| lines.wrong(start_of(&header, i), wrong))?;

    let mut rows: Vec<T> = Vec::new();
    let mut values = vec![None; table.columns.len()];
    while lines.next()? {
        let text = lines.text()?;
        if text.is_empty() {
            return Err(lines.wrong(1, Wrong::Blank));
        }
        let found = text.split(',').count();
        if found != names.len() {
            return Err(lines.wrong(1, Wrong::FieldCount { expected: names.len(), found }));
        }
        for (i, (field, place)) in text.split(',').map(unquoted).zip(&places).enumerate() {
            let value = match place {
                Some(at) => read_field(&table.columns[*at], field),
                None => read_passed_over(names[i], field),
            };
            let value = value.map_err(|wrong| lines.wrong(start_of(text, i), wrong))?;
            if let Some(at) = place {
                values[*at] = value;
            }
        }
        let row = (table.take)(&Fields(&values));
        let finding = time_goes_back(table, rows.last(), &row).or_else(|| check(&row));
        if let Some((name, wrong)) = finding {
            return Err(lines.wrong(column_of(text, &names, name), wrong));
        }
        if rows.len() == MOST_ROWS {
            return Err(lines.wrong(1, Wrong::TooManyRows { limit: MOST_ROWS }));
        }
        rows.push(row);
    }
    Ok(Some(rows))
}

/// The rows as text, checked by the reader's rules; `file` names them in errors.
pub(super) fn rows_text<T: Timed>(
    file: &Path,
    table: &Table<T>,
    rows: &[T],
    check: impl Fn(&T) -> Finding,
) -> Result<String, ReadError> {
    let at = |i: usize, column: usize, wrong| ReadError {
        file: file.to_owned(),
        place: Some(Place { line: i as u64 + 2, column: column as u64 + 1 }),
        wrong: Box::new(wrong),
    };
    let all: Vec<Vec<Option<f64>>> = rows
        .iter()
        .enumerate()
        .map(|(i, row)| (table.give)(row).ok_or_else(|| at(i, 0, Wrong::OtherKind)))
        .collect::<Result<_, _>>()?;
    let stands: Vec<bool> = (0..table.columns.len())
        .map(|c| table.columns[c].may != May::BeAbsent || all.iter().any(|values| values[c].is_some()))
        .collect();
    let mut text = String::new();
    push_line(&mut text, table.columns.iter().zip(&stands).filter(|(_, s)| **s).map(|(c, _)| c.name.to_owned()));
    for (i, (row, values)) in rows.iter().zip(&all).enumerate() {
        for (c, (column, value)) in table.columns.iter().zip(values).enumerate() {
            if value.is_some_and(|value| !column.rule.holds(value)) {
                let found = value.map_or(String::new(), |value| format!("{value:?}"));
                return Err(at(i, c, Wrong::value(column.name, column.rule.says(), &found)));
            }
        }
        let finding = time_goes_back(table, i.checked_sub(1).map(|before| &rows[before]), row).or_else(|| check(row));
        if let Some((_, wrong)) = finding {
            return Err(at(i, 0, wrong));
        }
        let fields = table.columns.iter().zip(values).zip(&stands).filter(|(_, s)| **s);
        push_line(&mut text, fields.map(|((column, value), _)| written(column, *value)));
    }
    Ok(text)
}

fn push_line(text: &mut String, fields: impl Iterator<Item = String>) {
    for (i, field) in fields.enumerate() {
        if i > 0 {
            text.push(',');
        }
        text.push_str(&field);
    }
    text.push('\n');
}

fn written(column: &Column, value: Option<f64>) -> String {
    let mut text = String::new();
    match value {
        Some(value) if column.rule.is_whole() => text = format!("{value}"),
        Some(value) => push_number(&mut text, value),
        None => {}
    }
    text
}

fn read_field(column: &Column, field: &str) -> Result<Option<f64>, Wrong> {
    if field.is_empty() && column.may != May::Nothing {
        return Ok(None);
    }
    match column.rule.parse(field) {
        Some(value) => Ok(Some(value)),
        None => Err(Wrong::value(column.name, column.rule.says(), field)),
    }
}

fn read_passed_over(name: &str, field: &str) -> Result<Option<f64>, Wrong> {
    match field.is_empty() || Rule::Finite.parse(field).is_some() {
        true => Ok(None),
        false => Err(Wrong::value(&shown(name), Rule::Finite.says(), field)),
    }
}

fn time_goes_back<T: Timed>(table: &Table<T>, previous: Option<&T>, row: &T) -> Finding {
    let (previous_s, t_s) = (previous?.t_s(), row.t_s());
    let rule = match table.repeats {
        true if t_s < previous_s => "not decrease",
        false if t_s <= previous_s => "increase",
        _ => return None,
    };
    Some(("t_s", Wrong::TimeGoesBack { rule, t_s, previous_s }))
}

/// The table that shares most columns with the header; the first of equals.
fn best<'a, T>(tables: &[&'a Table<T>], names: &[&str]) -> &'a Table<T> {
    let shared = |table: &Table<T>| table.columns.iter().filter(|column| names.contains(&column.name)).count();
    tables.iter().skip(1).fold(tables[0], |best, table| if shared(table) > shared(best) { table } else { best })
}

/// For every column of the file the column of the table, or the column at fault.
fn places<T>(table: &Table<T>, names: &[&str]) -> Result<Vec<Option<usize>>, (usize, Wrong)> {
    let columns = || table.columns.iter().map(|column| column.name).collect::<Vec<_>>().join(",");
    let mut places = Vec::new();
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err((i, Wrong::DuplicateColumn { name: shown(name) }));
        }
        let at = table.columns.iter().position(|column| column.name == *name);
        if at.is_none() && !(table.open && is_name(name)) {
            return Err((i, Wrong::UnknownColumn { name: shown(name), columns: columns() }));
        }
        places.push(at);
    }
    let missing = table.columns.iter().find(|c| c.may != May::BeAbsent && !names.contains(&c.name));
    match missing {
        Some(column) => Err((0, Wrong::MissingColumn { name: column.name, columns: columns() })),
        None => Ok(places),
    }
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// RFC 4180 lets any field stand in quotes; none of ours has a comma or a quote inside.
fn unquoted(field: &str) -> &str {
    field.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(field)
}

/// Characters before field `i`, plus one.
fn start_of(text: &str, i: usize) -> u64 {
    text.split(',').take(i).map(|field| field.chars().count() as u64 + 1).sum::<u64>() + 1
}

fn column_of(text: &str, names: &[&str], name: &str) -> u64 {
    start_of(text, names.iter().position(|other| *other == name).unwrap_or(0))
}

/// Lines of bounded length, one at a time.
struct Lines<'a> {
    path: &'a Path,
    from: BufReader<File>,
    line: u64,
    buffer: Vec<u8>,
}

impl Lines<'_> {
    /// Reads the next line; `false` at the end of the file.
    fn next(&mut self) -> Result<bool, ReadError> {
        self.buffer.clear();
        self.line += 1;
        let limit = LONGEST_LINE_BYTES as u64 + 2;
        let read = self.from.by_ref().take(limit).read_until(b'\n', &mut self.buffer);
        if let Err(e) = read {
            return Err(self.wrong(1, Wrong::Unreadable(e)));
        }
        if self.buffer.is_empty() {
            return Ok(false);
        }
        if self.buffer.pop_if(|last| *last == b'\n').is_none() {
            let wrong = match self.buffer.len() > LONGEST_LINE_BYTES {
                true => Wrong::LineTooLong { limit_bytes: LONGEST_LINE_BYTES },
                false => Wrong::CutShort,
            };
            return Err(self.wrong(1, wrong));
        }
        self.buffer.pop_if(|last| *last == b'\r');
        Ok(true)
    }

    fn text(&self) -> Result<&str, ReadError> {
        std::str::from_utf8(&self.buffer).map_err(|e| {
            let before = String::from_utf8_lossy(&self.buffer[..e.valid_up_to()]).chars().count();
            self.wrong(before as u64 + 1, Wrong::NotUtf8)
        })
    }

    fn wrong(&self, column: u64, wrong: Wrong) -> ReadError {
        ReadError {
            file: PathBuf::from(self.path),
            place: Some(Place { line: self.line, column }),
            wrong: Box::new(wrong),
        }
    }
}
