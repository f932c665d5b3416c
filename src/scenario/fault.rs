//! What is wrong with a scenario file, shown in the file.

use std::ops::Range;
use std::string::FromUtf8Error;
use std::sync::Arc;

use asami_dataset::parameters::Fault;
use miette::{LabeledSpan, NamedSource};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A scenario file that cannot be used: where, which rule, which value.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{message}")]
#[diagnostic(code(scenario::invalid))]
pub struct Bad {
    message: String,
    #[source_code]
    source_code: Arc<NamedSource<String>>,
    #[label(collection)]
    labels: Vec<LabeledSpan>,
    #[help]
    help: Option<String>,
}

impl Bad {
    /// The file cannot be read at all.
    #[must_use]
    pub fn unreadable(shown: &str, error: &std::io::Error) -> Self {
        Self::new(format!("cannot read {shown}: {error}"), shown, "", Vec::new(), None)
    }

    /// The file is not UTF-8.
    #[must_use]
    pub fn not_text(shown: &str, error: &FromUtf8Error) -> Self {
        let valid = error.utf8_error().valid_up_to();
        let byte = error.as_bytes().get(valid).copied().unwrap_or_default();
        let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let label = LabeledSpan::at(valid..valid, format!("byte 0x{byte:02x}"));
        Self::new("a scenario file must be UTF-8 text".into(), shown, &text, vec![label], None)
    }

    /// The file is no TOML, or a key or a type is wrong.
    #[must_use]
    pub fn syntax(shown: &str, text: &str, error: &toml::de::Error) -> Self {
        let span = first_line(text, error.span().unwrap_or(0..0));
        let help = nearest_key(error.message());
        let label = LabeledSpan::at(span, "here");
        Self::new(error.message().to_owned(), shown, text, vec![label], help)
    }

    /// Values break rules; each is shown at its place.
    #[must_use]
    pub fn faults(shown: &str, text: &str, table: &Spanned<DeTable<'_>>, faults: &[Fault]) -> Self {
        let message = match faults {
            [only] => only.message.clone(),
            _ => format!("{} values break rules", faults.len()),
        };
        let labels = faults
            .iter()
            .map(|fault| LabeledSpan::at(first_line(text, span_of(table, &fault.path)), fault.message.clone()))
            .collect();
        Self::new(message, shown, text, labels, faults.iter().find_map(|fault| nearest_key(&fault.message)))
    }

    /// Where the first label stands: line, counted from 1.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        let at = self.labels.first()?.offset();
        Some(1 + self.source_code.inner().as_bytes().iter().take(at).filter(|byte| **byte == b'\n').count())
    }

    fn new(message: String, shown: &str, text: &str, labels: Vec<LabeledSpan>, help: Option<String>) -> Self {
        let source_code = Arc::new(NamedSource::new(shown, text.to_owned()).with_language("TOML"));
        Self { message, source_code, labels, help }
    }
}

/// The part of `span` that lies on its first line: a whole table underlined says less than its head.
fn first_line(text: &str, span: Range<usize>) -> Range<usize> {
    let start = span.start.min(text.len());
    let end = span.end.clamp(start, text.len());
    let rest = text.get(start..end).unwrap_or_default();
    start..start + rest.find('\n').unwrap_or(rest.len())
}

/// Where the value of a dotted path stands; of a path that leads nowhere, where the last table does
/// that it leads through.
fn span_of(table: &Spanned<DeTable<'_>>, path: &str) -> Range<usize> {
    let mut keys = path.split('.').filter(|key| !key.is_empty());
    let Some((key, mut value)) = keys.next().and_then(|key| table.get_ref().get_key_value(key)) else {
        return 0..0;
    };
    let mut span = value_or_key(key.span(), value);
    for key in keys {
        let next = match value.get_ref() {
            DeValue::Table(inner) => inner.get_key_value(key).map(|(key, value)| (key.span(), value)),
            DeValue::Array(inner) => {
                key.parse::<usize>().ok().and_then(|i| inner.get(i)).map(|value| (value.span(), value))
            }
            _ => None,
        };
        let Some((key_span, inner)) = next else { break };
        span = value_or_key(key_span, inner);
        value = inner;
    }
    span
}

/// Values are shown where they stand, tables at their heads.
fn value_or_key(key: Range<usize>, value: &Spanned<DeValue<'_>>) -> Range<usize> {
    match value.get_ref() {
        DeValue::Table(_) => key,
        DeValue::Array(items) if items.iter().any(|item| item.get_ref().is_table()) => key,
        _ => value.span(),
    }
}

/// Out of "unknown x `frction`, expected `dt` or `friction`": which of the expected names is meant.
fn nearest_key(message: &str) -> Option<String> {
    if !message.starts_with("unknown ") {
        return None;
    }
    let mut names = message.split('`').skip(1).step_by(2);
    let unknown = names.next()?;
    nearest(unknown, names).map(|name| format!("did you mean `{name}`?"))
}

/// The name most like `unknown`, if any is alike at all.
#[must_use]
pub fn nearest<'a>(unknown: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    names
        .map(|name| (strsim::damerau_levenshtein(unknown, name), name))
        .filter(|(distance, name)| *distance <= 2.max(name.chars().count() / 3))
        .min()
        .map(|(_, name)| name)
}
