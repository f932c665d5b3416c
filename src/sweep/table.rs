//! Tables of chapter 4: our rows, the dissertation's under them, what needs the truth at the end; as CSV,
//! Markdown, TeX, plain text and for a report.

use asami_math::statistics;

use super::rows::optional;
use super::spread::Spread;
use super::tally::{Group, Tallied, Tally};
use super::{Results, Whose};
use crate::report;
use crate::scenario::{Era, Start};

/// A table that is a file of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its file's name without the extension.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it shows, and what is good.
    pub caption: &'static str,
    /// In order.
    pub columns: Vec<Column>,
    /// In order.
    pub lines: Vec<Line>,
}

/// A quantity of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Its name in `trials.csv`.
    pub quantity: &'static str,
    /// Its head, with the unit.
    pub head: &'static str,
    /// Decimals that are shown.
    pub decimals: usize,
}

/// A column of this quantity, under this head.
#[must_use]
pub const fn column(quantity: &'static str, head: &'static str, decimals: usize) -> Column {
    Column { quantity, head, decimals }
}

/// A number that dissertation or truth gives, or the statistics of ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// Over trials.
    Measured(Spread),
    /// A single one.
    Printed(f64),
}

/// A row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Whose numbers.
    pub whose: Whose,
    /// Which learner.
    pub learner: String,
    /// Started from what.
    pub start: Option<Start>,
    /// On which part of the log.
    pub era: Option<Era>,
    /// In which group.
    pub group: Group,
    /// Under each column.
    pub entries: Vec<Option<Entry>>,
    /// How many trials converged, of how many.
    pub converged: Option<(usize, usize)>,
}

/// A line of the dissertation: what it prints of quantities.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    /// What we call its learner.
    pub learner: &'static str,
    /// What it started from.
    pub start: Option<Start>,
    /// On which part of the log it learned; `None` in the plane.
    pub era: Option<Era>,
    /// Against whose truth.
    pub truth: Option<Era>,
    /// By the names of `trials.csv`.
    pub values: &'static [(&'static str, f64)],
    /// Where it is printed.
    pub place: &'static str,
}

/// What a table is made of, beside a study's tallies.
#[derive(Clone, Copy)]
pub struct Plan {
    /// As [`Table::name`].
    pub name: &'static str,
    /// As [`Table::title`].
    pub title: &'static str,
    /// As [`Table::caption`].
    pub caption: &'static str,
    /// As [`Table::columns`].
    pub columns: &'static [Column],
    /// Only rows that start from this, where it is given; from nothing, always.
    pub start: Option<Start>,
}

/// The table that `plan` says; lines and columns without any number are left out.
#[must_use]
pub fn table<S: Tallied>(results: &Results<S>, tallies: &[Tally], published: &[Published], plan: &Plan) -> Table {
    let columns = plan.columns.to_vec();
    let (mut lines, mut printed): (Vec<Line>, Vec<usize>) = (Vec::new(), Vec::new());
    let quantity = |column: &Column| S::names().iter().position(|name| *name == column.quantity);
    for tally in tallies {
        let row = &results.scenario.rows[tally.row];
        if !fits(plan, row.start) {
            continue;
        }
        let era = tally.group.truth.map(|_| row.era);
        let entry = |column: &Column| tally.spreads.get(quantity(column)?)?.map(Entry::Measured);
        let entries = columns.iter().map(entry).collect();
        let (learner, converged) = (row.label.clone(), Some((tally.converged, tally.trials)));
        lines.push(Line {
            whose: Whose::Asami,
            learner,
            start: row.start,
            era,
            group: tally.group,
            entries,
            converged,
        });
        let same = published.iter().position(|it| {
            (it.learner, it.start, it.era, it.truth) == (&*row.label, row.start, era, tally.group.truth)
        });
        if let Some(same) = same.filter(|same| !printed.contains(same)) {
            printed.push(same);
            lines.extend(published_line(&published[same], &columns));
        }
    }
    for group in S::groups(results) {
        for (name, start) in reference_names(results).into_iter().filter(|(_, start)| fits(plan, *start)) {
            let entries =
                columns.iter().map(|column| reference(results, &name, start, group, quantity(column)?)).collect();
            // A starting model like one above in everything that this table shows.
            let is_known = |line: &Line| line.learner == name && line.group == group && line.entries == entries;
            if lines.iter().any(is_known) {
                continue;
            }
            let learner = name.clone();
            lines.push(Line { whose: Whose::Reference, learner, start, era: None, group, entries, converged: None });
        }
    }
    let rest = published.iter().enumerate().filter(|(i, it)| !printed.contains(i) && fits(plan, it.start));
    lines.extend(rest.filter_map(|(_, it)| published_line(it, &columns)));
    lines.retain(|line| line.whose == Whose::Asami || line.entries.iter().any(Option::is_some));
    without_empty_columns(Table { name: plan.name, title: plan.title, caption: plan.caption, columns, lines })
}

fn fits(plan: &Plan, start: Option<Start>) -> bool {
    plan.start.is_none() || start.is_none() || start == plan.start
}

fn published_line(published: &Published, columns: &[Column]) -> Option<Line> {
    let entry = |column: &Column| {
        let value = published.values.iter().find(|(name, _)| *name == column.quantity);
        value.map(|(_, value)| Entry::Printed(*value))
    };
    let entries: Vec<_> = columns.iter().map(entry).collect();
    entries.iter().any(Option::is_some).then(|| Line {
        whose: Whose::Dissertation,
        learner: published.learner.to_owned(),
        start: published.start,
        era: published.era,
        group: Group { truth: published.truth, ..Group::default() },
        entries,
        converged: None,
    })
}

fn reference_names<S: Tallied>(results: &Results<S>) -> Vec<(String, Option<Start>)> {
    let mut names: Vec<(String, Option<Start>)> = Vec::new();
    for reference in results.records.iter().flat_map(|record| &record.references) {
        let name = (reference.name.clone(), reference.start);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// A reference over the group's cases; one number where all cases share it.
fn reference<S: Tallied>(
    results: &Results<S>,
    name: &str,
    start: Option<Start>,
    group: Group,
    quantity: usize,
) -> Option<Entry> {
    let records =
        results.counted().filter(|record| record.case.robot == group.robot && record.case.landmarks == group.landmarks);
    let values: Vec<f64> = records
        .filter_map(|record| {
            let found = record.references.iter().find(|it| it.name == name && it.start == start)?;
            S::reference(record, &found.scores, group.truth, quantity)
        })
        .collect();
    let first = *values.first()?;
    match values.iter().all(|value| *value == first) {
        true => Some(Entry::Printed(first)),
        false => Some(Entry::Measured(Spread {
            mean: statistics::mean(&values)?,
            sd: statistics::standard_deviation(&values),
            median: statistics::median(&values)?,
            interquartile_mean: statistics::interquartile_mean(&values)?,
            interval: None,
        })),
    }
}

fn without_empty_columns(mut table: Table) -> Table {
    let is_used = |i: &usize| table.lines.iter().any(|line| line.entries[*i].is_some());
    let used: Vec<usize> = (0..table.columns.len()).filter(is_used).collect();
    table.columns = used.iter().map(|i| table.columns[*i]).collect();
    for line in &mut table.lines {
        line.entries = used.iter().map(|i| line.entries[*i]).collect();
    }
    table
}

/// A head and what stands under it in a line.
type Label = (&'static str, fn(&Line) -> String);

const LABELS: [Label; 7] = [
    ("source", |line| line.whose.name().to_owned()),
    ("learner", |line| line.learner.clone()),
    ("start", |line| line.start.map_or("", Start::name).to_owned()),
    ("robot", |line| line.group.robot.map_or_else(String::new, |robot| robot.to_string())),
    ("landmarks", |line| line.group.landmarks.map_or_else(String::new, |landmarks| landmarks.to_string())),
    ("learned", |line| line.era.map_or("", Era::name).to_owned()),
    ("truth", |line| line.group.truth.map_or("", Era::name).to_owned()),
];

impl Table {
    /// As CSV.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut heads: Vec<String> =
            ["source", "learner", "starting_model", "robot", "landmarks", "learned_era", "truth_era"]
                .map(str::to_owned)
                .into();
        for column in &self.columns {
            let name = column.quantity;
            heads.extend(["median", "mean", "sd", "mean_95_low", "mean_95_high"].map(|of| format!("{name}_{of}")));
        }
        heads.extend(["converged", "trials"].map(str::to_owned));
        let mut text = heads.join(",") + "\n";
        for line in &self.lines {
            let mut fields: Vec<String> = LABELS.iter().map(|(_, of)| of(line)).collect();
            for entry in &line.entries {
                fields.extend(
                    match entry {
                        None => [None; 5],
                        // A printed number is one run's: its value stands for the median.
                        Some(Entry::Printed(value)) => [Some(*value), None, None, None, None],
                        Some(Entry::Measured(it)) => {
                            let [low, high] = it.interval.map_or([None; 2], |interval| interval.map(Some));
                            [Some(it.median), Some(it.mean), it.sd, low, high]
                        }
                    }
                    .map(optional),
                );
            }
            let count =
                |of: fn((usize, usize)) -> usize| line.converged.map_or_else(String::new, |it| of(it).to_string());
            fields.extend([count(|it| it.0), count(|it| it.1)]);
            text.push_str(&fields.join(","));
            text.push('\n');
        }
        text
    }

    /// Heads and cells as text: labels, numbers, converged. Labels that no line has are left out.
    fn cells(&self, interval: bool, plus_minus: &str) -> Vec<Vec<String>> {
        let labels: Vec<&Label> =
            LABELS.iter().filter(|(_, of)| self.lines.iter().any(|line| !of(line).is_empty())).collect();
        let heads = labels.iter().map(|(head, _)| (*head).to_owned());
        let heads = heads.chain(self.columns.iter().map(|column| column.head.to_owned()));
        let mut rows = vec![heads.chain(["converged".to_owned()]).collect::<Vec<_>>()];
        rows.extend(self.lines.iter().map(|line| {
            let numbers = line.entries.iter().zip(&self.columns);
            let numbers = numbers.map(|(entry, column)| shown(entry.as_ref(), column, interval, plus_minus));
            let converged =
                line.converged.map_or_else(String::new, |(converged, trials)| format!("{converged}/{trials}"));
            labels.iter().map(|(_, of)| of(line)).chain(numbers).chain([converged]).collect()
        }));
        rows
    }

    /// As Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let cells = self.cells(true, " ± ");
        let row = |cells: &Vec<String>| format!("| {} |\n", cells.join(" | "));
        let rule = format!("|{}\n", "---|".repeat(cells[0].len()));
        cells[..1].iter().map(row).chain([rule]).chain(cells[1..].iter().map(row)).collect()
    }

    /// As a TeX `tabular`.
    #[must_use]
    pub fn tex(&self) -> String {
        let cells = self.cells(false, " $\\pm$ ");
        let numbers = self.columns.len() + 1;
        let spec = "l".repeat(cells[0].len() - numbers) + &"r".repeat(numbers);
        let row = |cells: &Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('_', "\\_").replace('%', "\\%")).collect();
            format!("{} \\\\\n", cells.join(" & "))
        };
        let rows: String = cells[1..].iter().map(row).collect();
        format!("\\begin{{tabular}}{{{spec}}}\n\\hline\n{}\\hline\n{rows}\\hline\n\\end{{tabular}}\n", row(&cells[0]))
    }

    /// For a terminal, columns aligned.
    #[must_use]
    pub fn plain(&self) -> String {
        let cells = self.cells(false, " ± ");
        let labels = cells[0].len() - self.columns.len() - 1;
        let width = |i: usize| cells.iter().map(|row| row[i].chars().count()).max().unwrap_or(0);
        let line = |row: &Vec<String>| {
            let padded = row.iter().enumerate().map(|(i, cell)| match i < labels {
                true => format!("{cell:<width$}", width = width(i)),
                false => format!("{cell:>width$}", width = width(i)),
            });
            format!("{}\n", padded.collect::<Vec<_>>().join("  ").trim_end())
        };
        format!("{}\n{}", self.title, cells.iter().map(line).collect::<String>())
    }

    /// For a report.
    #[must_use]
    pub fn reported(&self) -> report::Table {
        let cells = self.cells(false, " \u{b1} ");
        let heads: Vec<&str> = cells[0].iter().map(String::as_str).collect();
        let labels = heads.len() - self.columns.len() - 1;
        let table = report::Table::new(self.title, &heads).caption(self.caption);
        self.lines.iter().zip(&cells[1..]).fold(table, |table, (line, texts)| {
            let kind = match line.whose {
                Whose::Asami => report::RowKind::Ours,
                Whose::Reference => report::RowKind::Reference,
                Whose::Dissertation => report::RowKind::Published,
            };
            let cell = |(i, text): (usize, &String)| {
                let entry = i.checked_sub(labels).and_then(|i| line.entries.get(i)).copied().flatten();
                let decimals =
                    i.checked_sub(labels).and_then(|i| self.columns.get(i)).map_or(0, |column| column.decimals);
                let (value, hint) = match entry {
                    Some(Entry::Measured(it)) => (Some(it.median), hint(&it, decimals)),
                    Some(Entry::Printed(value)) => (Some(value), String::new()),
                    None => (None, String::new()),
                };
                let text = if value.is_some() { text.replace('-', "\u{2212}") } else { text.clone() };
                report::Cell { text, value, hint }
            };
            let mut row: Vec<report::Cell> = texts.iter().enumerate().map(cell).collect();
            if let (Some(last), Some((converged, trials))) = (row.last_mut(), line.converged) {
                last.value = Some(converged as f64 / trials.max(1) as f64);
            }
            table.row(kind, row)
        })
    }
}

/// Median, then mean and standard deviation in brackets.
fn shown(entry: Option<&Entry>, column: &Column, interval: bool, plus_minus: &str) -> String {
    let decimals = column.decimals;
    let (zero, spread) = (format!("{:.decimals$}", 0.0), !column.head.starts_with(['%', 'x']));
    match entry {
        None => String::new(),
        Some(Entry::Printed(value)) => format!("{value:.decimals$}"),
        Some(Entry::Measured(Spread { median, sd: None, .. })) => format!("{median:.decimals$}"),
        // Of what is the same in every trial, and of a percentage beside its number, one number says enough.
        Some(Entry::Measured(Spread { median, sd: Some(sd), .. })) if !spread || format!("{sd:.decimals$}") == zero => {
            format!("{median:.decimals$}")
        }
        Some(Entry::Measured(Spread { median, mean, sd: Some(sd), interval: between, .. })) => {
            let between = between.filter(|_| interval);
            let between =
                between.map_or_else(String::new, |[low, high]| format!("; {low:.decimals$}..{high:.decimals$}"));
            format!("{median:.decimals$} ({mean:.decimals$}{plus_minus}{sd:.decimals$}{between})")
        }
    }
}

fn hint(spread: &Spread, decimals: usize) -> String {
    let interval = spread
        .interval
        .map_or_else(String::new, |[low, high]| format!("\n95 % of the mean {low:.decimals$} to {high:.decimals$}"));
    format!("interquartile mean {:.decimals$}{interval}", spread.interquartile_mean)
}
