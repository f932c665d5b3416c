//! Writing TOML in the order and shape of the format's description.

use super::number::push_number;

/// A TOML file under writing.
pub(super) struct Toml(String);

impl Toml {
    pub(super) fn new() -> Self {
        Self("schema = 1\n".to_owned())
    }

    pub(super) fn finish(self) -> String {
        self.0
    }

    pub(super) fn head(&mut self, head: &str) {
        self.0.push_str(&format!("\n{head}\n"));
    }

    fn line(&mut self, key: &str, value: &str) {
        self.0.push_str(&format!("{key} = {value}\n"));
    }

    pub(super) fn text(&mut self, key: &str, text: &str) {
        self.line(key, &quoted(text));
    }

    pub(super) fn whole(&mut self, key: &str, value: u64) {
        self.line(key, &value.to_string());
    }

    pub(super) fn number(&mut self, key: &str, value: f64) {
        self.line(key, &value_text(value));
    }

    pub(super) fn maybe_number(&mut self, key: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.number(key, value);
        }
    }

    /// Nothing for an empty list.
    pub(super) fn numbers(&mut self, key: &str, values: &[f64]) {
        if !values.is_empty() {
            self.line(key, &list(values));
        }
    }

    /// One inline table a line; nothing for an empty list.
    pub(super) fn inline_tables<T>(&mut self, key: &str, rows: &[T], row: impl Fn(&T) -> String) {
        if !rows.is_empty() {
            let rows: String = rows.iter().map(|one| format!("    {{ {} }},\n", row(one))).collect();
            self.line(key, &format!("[\n{rows}]"));
        }
    }
}

/// The pairs of an inline table.
pub(super) fn pairs(pairs: &[(&str, f64)]) -> String {
    pairs.iter().map(|(key, value)| format!("{key} = {}", value_text(*value))).collect::<Vec<_>>().join(", ")
}

/// A list of numbers.
pub(super) fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|value| value_text(*value)).collect::<Vec<_>>().join(", "))
}

/// What is no number is written as TOML has it, for the check that follows every writing to refuse.
fn value_text(value: f64) -> String {
    let mut text = String::new();
    push_number(&mut text, value);
    match value {
        _ if !text.is_empty() => text,
        value if value.is_nan() => "nan".to_owned(),
        value if value > 0.0 => "inf".to_owned(),
        _ => "-inf".to_owned(),
    }
}

/// A basic string of TOML, as a key or as a value: one line, whatever is in it.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => out.extend(['\\', letter]),
            // TOML forbids these unescaped, but for the tab, which nobody would see.
            '\0'..='\u{1f}' | '\u{7f}' => out.push_str(&format!("\\u{:04x}", u32::from(letter))),
            _ => out.push(letter),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn every_string_is_read_back_as_key_and_as_value() {
        for text in ["", "plain", "'\\", "'''", "\"", "a\nb", "\t\0\u{7f}", "\u{1f}é\u{10ffff}", "a.b", "# no"] {
            let line = format!("{} = {}", quoted(text), quoted(text));
            let table: toml::Table = line.parse().expect(&line);
            assert_eq!(table.get(text).and_then(toml::Value::as_str), Some(text), "{line}");
        }
    }
}
