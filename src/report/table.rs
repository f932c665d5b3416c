//! Tables of a report: rows of cells that sort by value and show as text.

use asami_dataset::store::number;

use crate::sweep::rows::quoted;

/// Where a row's numbers come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RowKind {
    /// Measured in this run.
    #[default]
    Ours,
    /// Needs truth, so that no learner could have made it: a floor, an unlearned model.
    Reference,
    /// Printed in a paper.
    Published,
}

/// A cell: what it shows and, of a number, what it sorts by.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// As shown; empty for a number that does not exist.
    pub text: String,
    /// As sorted.
    pub value: Option<f64>,
    /// Shown on pointing at it.
    pub hint: String,
}

impl Cell {
    /// A number with so many decimals; NaN is an empty cell.
    #[must_use]
    pub fn number(value: f64, decimals: usize) -> Self {
        if value.is_nan() {
            return Self::default();
        }
        let digits = format!("{:.decimals$}", value.abs());
        let is_zero = !digits.bytes().any(|byte| (b'1'..=b'9').contains(&byte));
        let text = if value < 0.0 && !is_zero { format!("\u{2212}{digits}") } else { digits };
        Self { text, value: Some(value), hint: String::new() }
    }

    /// `mean ± sd` with so many decimals, sorted by the mean; without the mean an empty cell.
    #[must_use]
    pub fn mean_sd(mean: f64, sd: f64, decimals: usize) -> Self {
        let mut cell = Self::number(mean, decimals);
        if cell.value.is_some() && !sd.is_nan() {
            cell.text = format!("{} \u{b1} {sd:.decimals$}", cell.text);
        }
        cell
    }

    /// Adds what is shown on pointing at it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self { text: text.to_owned(), ..Self::default() }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, ..Self::default() }
    }
}

/// A row and where it comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Where it comes from.
    pub kind: RowKind,
    /// One cell a column.
    pub cells: Vec<Cell>,
}

/// A table with a caption; its columns sort on clicking at their heads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Short name: `Table 3.1`.
    pub name: String,
    /// What it shows, what is good, what to do about it if it is not.
    pub caption: String,
    /// Heads with units.
    pub heads: Vec<String>,
    /// In order.
    pub rows: Vec<Row>,
}

impl Table {
    /// A table without rows.
    #[must_use]
    pub fn new(name: &str, heads: &[&str]) -> Self {
        let heads = heads.iter().map(|head| (*head).to_owned()).collect();
        Self { name: name.to_owned(), heads, ..Self::default() }
    }

    /// Says what the table shows.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// Adds a row; short rows are filled up with empty cells.
    #[must_use]
    pub fn row(mut self, kind: RowKind, cells: impl IntoIterator<Item = Cell>) -> Self {
        let mut cells: Vec<Cell> = cells.into_iter().collect();
        cells.resize(self.heads.len(), Cell::default());
        self.rows.push(Row { kind, cells });
        self
    }

    /// As comma-separated values: numbers as they are, texts as shown.
    #[must_use]
    pub fn csv(&self) -> String {
        let line = |cells: Vec<String>| cells.iter().map(|cell| quoted(cell)).collect::<Vec<_>>().join(",") + "\n";
        let text = |cell: &Cell| cell.value.map_or_else(|| cell.text.clone(), number);
        let rows = self.rows.iter().map(|row| line(row.cells.iter().map(text).collect()));
        std::iter::once(line(self.heads.clone())).chain(rows).collect()
    }

    /// As Markdown, with the caption above it.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let rule: String = (0..self.heads.len()).map(|i| if self.is_numeric(i) { "---:|" } else { "---|" }).collect();
        let rows = self.rows.iter().map(|row| line(row.cells.iter().map(|cell| cell.text.as_str()).collect()));
        let head = line(self.heads.iter().map(String::as_str).collect());
        format!("**{}.** {}\n\n{head}|{rule}\n{}", self.name, self.caption, rows.collect::<String>())
    }

    /// Whether every value of a column is a number or missing, and at least one is a number.
    pub(crate) fn is_numeric(&self, column: usize) -> bool {
        let cells = || self.rows.iter().filter_map(|row| row.cells.get(column));
        cells().any(|cell| cell.value.is_some()) && cells().all(|cell| cell.value.is_some() || cell.text.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_written_with_numbers_as_they_are_or_as_shown() {
        let table = Table::new("T", &["who", "how many (m)"]).caption("Few, it is said.");
        let table = table.row(RowKind::Ours, ["a, b".into(), Cell::number(1.25, 1)]).row(RowKind::Ours, ["c".into()]);
        assert_eq!(table.csv(), "who,how many (m)\n\"a, b\",1.25\nc,\n");
        let expected = "**T.** Few, it is said.\n\n| who | how many (m) |\n|---|---:|\n| a, b | 1.2 |\n| c |  |\n";
        assert_eq!(table.markdown(), expected);
    }

    #[test]
    fn numbers_read_as_printed_and_sort_as_they_are() {
        let read = |value| Cell::number(value, 1).text;
        assert_eq!([read(-4.25), read(-0.04), read(0.0), read(1234.56)], ["\u{2212}4.2", "0.0", "0.0", "1234.6"]);
        assert_eq!(Cell::number(-0.04, 1).value, Some(-0.04));
        assert_eq!(Cell::number(f64::NAN, 1), Cell::default());
        assert_eq!(Cell::mean_sd(70.4, 13.9, 1).text, "70.4 \u{b1} 13.9");
        assert_eq!(Cell::mean_sd(48.8, f64::NAN, 1).text, "48.8");
        assert_eq!(Cell::mean_sd(f64::NAN, 1.0, 1), Cell::default());
    }
}
