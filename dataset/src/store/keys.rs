//! Reading TOML key by key, so that every value can be checked where it stands.

use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{Place, ReadError, Wrong, shown};
use super::rows::open;
use super::rule::Rule;

const LONGEST_TOML_BYTES: u64 = 4 << 20;

/// A TOML file's text.
pub(super) struct Source {
    pub(super) file: PathBuf,
    pub(super) text: String,
}

impl Source {
    /// Reads it; `None` if there is no such file.
    pub(super) fn read(path: &Path) -> Result<Option<Self>, ReadError> {
        let whole = |wrong| ReadError { file: path.to_owned(), place: None, wrong: Box::new(wrong) };
        let Some(file) = open(path)? else { return Ok(None) };
        let mut bytes = Vec::new();
        file.take(LONGEST_TOML_BYTES + 1).read_to_end(&mut bytes).map_err(|e| whole(Wrong::Unreadable(e)))?;
        if bytes.len() as u64 > LONGEST_TOML_BYTES {
            return Err(whole(Wrong::TooLong { limit_bytes: LONGEST_TOML_BYTES }));
        }
        let text = String::from_utf8(bytes).map_err(|e| {
            let before = String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]).into_owned();
            let place = place_of(&before, before.len());
            ReadError { file: path.to_owned(), place: Some(place), wrong: Box::new(Wrong::NotUtf8) }
        })?;
        Ok(Some(Self { file: path.to_owned(), text }))
    }

    /// [`read`](Self::read) of a file that must be there.
    pub(super) fn require(path: &Path) -> Result<Self, ReadError> {
        Self::read(path)?.ok_or_else(|| ReadError {
            file: path.to_owned(),
            place: None,
            wrong: Box::new(Wrong::Missing),
        })
    }

    /// The file's table, its schema checked.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'_>>, ReadError> {
        let root = DeTable::parse(&self.text).map_err(|e| {
            let message = e.message().lines().map(str::trim).collect::<Vec<_>>().join(", ");
            self.wrong(e.span().unwrap_or(0..0), Wrong::Syntax(shown(&message)))
        })?;
        match root.get_ref().get("schema") {
            Some(value) => match value.get_ref() {
                DeValue::Integer(found) if found.as_str() == "1" => Ok(root),
                found => Err(self.wrong(value.span(), Wrong::Schema { found: shown_value(found) })),
            },
            None => Err(self.wrong(0..0, Wrong::MissingKey { name: "schema" })),
        }
    }

    pub(super) fn wrong(&self, span: Range<usize>, wrong: Wrong) -> ReadError {
        let place = Some(place_of(&self.text, span.start));
        ReadError { file: self.file.clone(), place, wrong: Box::new(wrong) }
    }
}

fn place_of(text: &str, byte: usize) -> Place {
    let byte = byte.min(text.len());
    let before = &text.as_bytes()[..byte];
    let start = before.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
    let line = before.iter().filter(|b| **b == b'\n').count() as u64 + 1;
    let column = text.get(start..byte).map_or(byte - start, |part| part.chars().count()) as u64 + 1;
    Place { line, column }
}

fn shown_value(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("\"{}\"", if text.is_empty() { String::new() } else { shown(text) }),
        DeValue::Integer(number) => shown(number.as_str()),
        DeValue::Float(number) => shown(number.as_str()),
        DeValue::Boolean(truth) => truth.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// One table under reading: it remembers which keys were asked for, and the rest are unknown.
pub(super) struct Keys<'a> {
    source: &'a Source,
    table: &'a DeTable<'a>,
    span: Range<usize>,
    asked: Vec<&'static str>,
}

impl<'a> Keys<'a> {
    pub(super) fn of(source: &'a Source, root: &'a Spanned<DeTable<'a>>) -> Self {
        Self { source, table: root.get_ref(), span: 0..0, asked: vec!["schema"] }
    }

    /// Where the table stands, for findings about all of it.
    pub(super) fn wrong(&self, wrong: Wrong) -> ReadError {
        self.source.wrong(self.span.clone(), wrong)
    }

    /// A finding about one key.
    pub(super) fn wrong_at(&self, key: &str, wrong: Wrong) -> ReadError {
        let span = self.table.get(key).map_or(self.span.clone(), Spanned::span);
        self.source.wrong(span, wrong)
    }

    fn get(&mut self, key: &'static str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.asked.push(key);
        self.table.get(key)
    }

    fn require<T>(&self, key: &'static str, found: Option<T>) -> Result<T, ReadError> {
        found.ok_or_else(|| self.wrong(Wrong::MissingKey { name: key }))
    }

    fn value_wrong(&self, key: &str, rule: &'static str, value: &Spanned<DeValue<'_>>) -> ReadError {
        let found = shown_value(value.get_ref());
        self.source.wrong(value.span(), Wrong::Value { name: key.to_owned(), rule, found })
    }

    fn to_number(&self, key: &str, rule: Rule, value: &Spanned<DeValue<'_>>) -> Result<f64, ReadError> {
        let number = match value.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => rule.parse(number.as_str()),
            DeValue::Float(number) if !rule.is_whole() => rule.parse(number.as_str()),
            _ => None,
        };
        number.ok_or_else(|| self.value_wrong(key, rule.says(), value))
    }

    pub(super) fn maybe_number(&mut self, key: &'static str, rule: Rule) -> Result<Option<f64>, ReadError> {
        self.get(key).map(|value| self.to_number(key, rule, value)).transpose()
    }

    pub(super) fn number(&mut self, key: &'static str, rule: Rule) -> Result<f64, ReadError> {
        let found = self.maybe_number(key, rule)?;
        self.require(key, found)
    }

    pub(super) fn id(&mut self, key: &'static str) -> Result<u16, ReadError> {
        Ok(self.number(key, Rule::Id)? as u16)
    }

    pub(super) fn count(&mut self, key: &'static str) -> Result<u32, ReadError> {
        Ok(self.number(key, Rule::Count)? as u32)
    }

    pub(super) fn seed(&mut self, key: &'static str) -> Result<u64, ReadError> {
        let value = self.get(key);
        let value = self.require(key, value)?;
        let seed = match value.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
            _ => None,
        };
        seed.ok_or_else(|| self.value_wrong(key, "must be a whole number in 0..=18446744073709551615", value))
    }

    pub(super) fn maybe_text(&mut self, key: &'static str) -> Result<Option<String>, ReadError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::String(text) => Ok(Some(text.to_string())),
            _ => Err(self.value_wrong(key, "must be a string", value)),
        }
    }

    pub(super) fn text(&mut self, key: &'static str) -> Result<String, ReadError> {
        let found = self.maybe_text(key)?;
        self.require(key, found)
    }

    /// One of a few words.
    pub(super) fn word(
        &mut self,
        key: &'static str,
        words: &[&'static str],
        rule: &'static str,
    ) -> Result<&'static str, ReadError> {
        let found = self.maybe_word(key, words, rule)?;
        self.require(key, found)
    }

    /// The same, where the key may be left out.
    pub(super) fn maybe_word(
        &mut self,
        key: &'static str,
        words: &[&'static str],
        rule: &'static str,
    ) -> Result<Option<&'static str>, ReadError> {
        let Some(text) = self.maybe_text(key)? else { return Ok(None) };
        let known = words.iter().find(|word| **word == text);
        let known = known.ok_or_else(|| self.wrong_at(key, Wrong::value(key, rule, &format!("\"{text}\""))))?;
        Ok(Some(known))
    }

    pub(super) fn maybe_numbers(&mut self, key: &'static str, rule: Rule) -> Result<Option<Vec<f64>>, ReadError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Array(values) => values.iter().map(|value| self.to_number(key, rule, value)).collect(),
            _ => Err(self.value_wrong(key, "must be a list of numbers", value)),
        }
        .map(Some)
    }

    pub(super) fn numbers(&mut self, key: &'static str, rule: Rule) -> Result<Vec<f64>, ReadError> {
        let found = self.maybe_numbers(key, rule)?;
        self.require(key, found)
    }

    /// A list of exactly `N` numbers.
    pub(super) fn maybe_array<const N: usize>(
        &mut self,
        key: &'static str,
        rule: Rule,
    ) -> Result<Option<[f64; N]>, ReadError> {
        let Some(values) = self.maybe_numbers(key, rule)? else { return Ok(None) };
        let length = |found| self.wrong_at(key, Wrong::Length { name: key, expected: N.to_string(), found });
        values.try_into().map(Some).map_err(|values: Vec<f64>| length(values.len()))
    }

    fn to_keys(&self, key: &str, value: &'a Spanned<DeValue<'a>>) -> Result<Keys<'a>, ReadError> {
        match value.get_ref() {
            DeValue::Table(table) => Ok(Keys { source: self.source, table, span: value.span(), asked: Vec::new() }),
            _ => Err(self.value_wrong(key, "must be a table", value)),
        }
    }

    pub(super) fn maybe_table(&mut self, key: &'static str) -> Result<Option<Keys<'a>>, ReadError> {
        self.get(key).map(|value| self.to_keys(key, value)).transpose()
    }

    /// A list of tables, each read by `read`; none where the key is not given.
    pub(super) fn tables<T>(
        &mut self,
        key: &'static str,
        read: impl Fn(&mut Keys<'a>) -> Result<T, ReadError>,
    ) -> Result<Vec<T>, ReadError> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let DeValue::Array(values) = value.get_ref() else {
            return Err(self.value_wrong(key, "must be a list of tables", value));
        };
        let one = |value| {
            let mut keys = self.to_keys(key, value)?;
            let read = read(&mut keys)?;
            keys.close()?;
            Ok(read)
        };
        values.iter().map(one).collect()
    }

    /// Every key of the table with its number, for tables whose keys are free.
    pub(super) fn all_numbers(self, rule: Rule) -> Result<Vec<(String, f64)>, ReadError> {
        let number = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, _)| {
            let name = key.get_ref().to_string();
            self.to_number(&shown(&name), rule, value).map(|number| (name, number))
        };
        self.table.iter().map(number).collect()
    }

    /// Refuses the keys that nobody asked for.
    pub(super) fn close(self) -> Result<(), ReadError> {
        let unknown = self.table.iter().find(|(key, _)| !self.asked.contains(&key.get_ref().as_ref()));
        match unknown {
            Some((key, _)) => {
                let wrong = Wrong::UnknownKey { name: shown(key.get_ref()), keys: self.asked.join(", ") };
                Err(self.source.wrong(key.span(), wrong))
            }
            None => Ok(()),
        }
    }
}
