//! Everything that is said about a sweep of chapter 4, and its files.

use super::cases::write_whole;
use super::table::{Plan, Published, Table, table};
use super::tally::{Comparison, Tallied, Tally, comparisons, comparisons_csv, statistics_csv, tallies, verdicts};
use super::verdict::{self, Verdict};
use super::{CannotSweep, Finished, Results, manifest, rows, verb};
use crate::study::Finishing;

/// Results with everything that is said about them.
pub struct Outcome<S: Tallied> {
    /// Raw rows.
    pub results: Results<S>,
    /// Statistics of each row in each group.
    pub tallies: Vec<Tally>,
    /// Paired tests against the published learner.
    pub comparisons: Vec<Comparison>,
    /// The tables, in order.
    pub tables: Vec<Table>,
    /// Expected answers.
    pub verdicts: Vec<Verdict>,
}

impl<S: Tallied> Outcome<S> {
    /// Works out everything that is said about `results`; `compared` are the learner that every other is
    /// held against, and in which quantities.
    #[must_use]
    pub fn of(results: Results<S>, plans: &[Plan], published: &[Published], compared: (&str, &[&str])) -> Self {
        let tallies = tallies(&results);
        let tables = plans.iter().map(|plan| table(&results, &tallies, published, plan));
        let tables = tables.filter(|table| !table.columns.is_empty()).collect();
        let comparisons = comparisons(&results, compared.0, compared.1);
        let verdicts = verdicts(&results, &tallies);
        Self { results, tallies, comparisons, tables, verdicts }
    }

    /// Writes every file but figures and the report.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, trials: &str, finishing: &Finishing<'_>) -> Result<(), CannotSweep> {
        let out = finishing.out;
        rows::write(&self.results, trials, out)?;
        let write = |name: &str, text: &str| write_whole(&out.join(name), text.as_bytes());
        for table in &self.tables {
            write(&format!("{}.csv", table.name), &table.csv())?;
            write(&format!("{}.md", table.name), &table.markdown())?;
            write(&format!("{}.tex", table.name), &table.tex())?;
        }
        write("statistics.csv", &statistics_csv(&self.results, &self.tallies))?;
        write("comparisons.csv", &comparisons_csv(&self.results, &self.comparisons))?;
        manifest::manifest(&self.results, finishing.program).write(out)
    }

    /// What a terminal shows at the end: question, first table, expected answers, errors.
    #[must_use]
    pub fn finished(&self) -> Finished {
        let table = self.tables.first().map(Table::plain).unwrap_or_default();
        let more: Vec<String> = self.tables.iter().skip(1).map(|table| format!("{}.md", table.name)).collect();
        let more = if more.is_empty() { String::new() } else { format!("\nmore: {}\n", more.join(", ")) };
        let (about, verdicts) = (&self.results.scenario.about, verdict::text(&self.verdicts));
        let text = format!("{about}\n\n{table}{more}{verdicts}{}\n", verb::errors(&self.results));
        Finished { text, has_errors: self.results.has_errors() }
    }
}
