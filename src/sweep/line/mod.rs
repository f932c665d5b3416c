//! Chapter 3's side of a sweep: Table 3.1 and what stands around it.

pub mod expect;
pub mod published;
pub mod rows;
pub mod summary;
pub mod table;

use std::path::Path;

use asami_dataset::{Dataset, Log, Models, Survey};

use self::summary::{Comparison, Summary};
use self::table::Line;
use super::verdict::{self, Verdict};
use super::{CannotSweep, Finished, Options, Plan, Results, Watcher, cases, manifest, rows as shared, verb};
use crate::report;
use crate::report::exhibits::Exhibits;
use crate::scenario::{Row, Scenario, Start};
use crate::scorer::line::{Scores, Yardstick};
use crate::study::{Finishing, Reference, Study};

/// Chapter 3 of Stronger (2008).
#[derive(Clone, Debug, PartialEq)]
pub struct Chapter3;

impl Study for Chapter3 {
    type Scores = Scores;
    type Yardstick = Yardstick;
    type Truth = ();

    fn yardstick(_: &Scenario, dataset: &Dataset, _: Option<&Survey>) -> Yardstick {
        Yardstick::of(&dataset.log, &dataset.truth)
    }

    fn given(_: &Scenario, row: &Row, _: &Log, yardstick: &Yardstick) -> Result<Models, String> {
        let given = match row.start {
            None => Some(Models::default()),
            Some(Start::ReferenceQuartic) => {
                yardstick.best_action(4).map(|action| Models { action: Some(action), ..Models::default() })
            }
            Some(Start::ReferenceCubic) => {
                yardstick.best_sensor(3).map(|sensor| Models { sensor: Some(sensor), ..Models::default() })
            }
            Some(start) => start.models(),
        };
        given.ok_or_else(|| "the models were not surveyed: there is no reference to be given".to_owned())
    }

    fn truth(_: &Yardstick) {}

    fn score(yardstick: &Yardstick, models: &Models) -> Scores {
        yardstick.score(models)
    }

    fn faults(scenario: &Scenario, _: &Row, yardstick: &Yardstick, models: &Models, scores: &Scores) -> Vec<String> {
        yardstick.faults(models, scores, scenario.divergence.r2_min)
    }

    /// The floors: best polynomials of the published degrees; and what starting models are as they are.
    fn references(_: &Scenario, _: &Log, yardstick: &Yardstick) -> Vec<Reference<Scores>> {
        let floor = Models { action: yardstick.best_action(4), sensor: yardstick.best_sensor(3), ..Models::default() };
        let unlearned =
            [Start::C, Start::Sgn, Start::One].into_iter().filter_map(|start| Some((start, start.models()?)));
        std::iter::once(("floor", None, floor))
            .chain(unlearned.map(|(start, models)| ("unlearned", Some(start), models)))
            .map(|(name, start, models)| Reference { name: name.to_owned(), start, scores: yardstick.score(&models) })
            .collect()
    }

    fn finish(results: Results<Self>, finishing: &Finishing<'_>) -> Result<Finished, CannotSweep> {
        let outcome = written(results, &finishing.exhibits, finishing.program, finishing.out)?;
        Ok(Finished { text: outcome.text(), has_errors: outcome.results.has_errors() })
    }
}

/// Results with everything that is said about them.
pub struct Outcome {
    /// Raw rows.
    pub results: Results<Chapter3>,
    /// Statistics of each row.
    pub summaries: Vec<Summary>,
    /// Paired tests.
    pub comparisons: Vec<Comparison>,
    /// The table.
    pub lines: Vec<Line>,
    /// Expected answers.
    pub verdicts: Vec<Verdict>,
}

/// Runs a plan and writes its files.
///
/// # Errors
/// If files cannot be written.
pub fn carry_out(plan: &Plan, options: &Options, watcher: &dyn Watcher) -> Result<Outcome, CannotSweep> {
    written(super::run(plan, options, watcher)?, &plan.source.exhibits(), &options.program, &options.out)
}

fn written(results: Results<Chapter3>, exhibits: &Exhibits, program: &str, out: &Path) -> Result<Outcome, CannotSweep> {
    let outcome = Outcome::of(results);
    outcome.write(out, program)?;
    report::sweep::write(&outcome, exhibits, program, out)?;
    Ok(outcome)
}

impl Outcome {
    /// Works out everything that is said about `results`.
    #[must_use]
    pub fn of(results: Results<Chapter3>) -> Self {
        let summaries = summary::summaries(&results);
        let comparisons = summary::comparisons(&results);
        let lines = table::lines(&results, &summaries);
        let verdicts = expect::verdicts(&results, &summaries, &comparisons, &lines);
        Self { results, summaries, comparisons, lines, verdicts }
    }

    /// Writes every file but figures and the report.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, out: &Path, program: &str) -> Result<(), CannotSweep> {
        shared::write(&self.results, &rows::trials(&self.results), out)?;
        manifest::manifest(&self.results, program).write(out)?;
        let files = [
            ("table_3_1.csv", table::csv(&self.lines)),
            ("table_3_1.md", table::markdown(&self.lines)),
            ("table_3_1.tex", table::tex(&self.lines)),
            ("statistics.csv", table::statistics_csv(&self.results, &self.summaries)),
            ("comparisons.csv", table::comparisons_csv(&self.results, &self.comparisons)),
        ];
        for (name, text) in files {
            cases::write_whole(&out.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// What a terminal shows at the end: question, table, expected answers, errors.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n{}", self.results.scenario.about, table::plain(&self.lines));
        for remark in table::remarks(&self.results, &self.summaries) {
            text.push_str(&format!("\n{remark}"));
        }
        for it in &self.comparisons {
            let name = |row: usize| {
                let row = &self.results.scenario.rows[row];
                format!("{} {}", row.label, row.start.map_or("", Start::name)).trim_end().to_owned()
            };
            let (row, against, seconds) =
                (name(it.row), name(it.against), self.results.scenario.rows[it.row].duration_s);
            let difference = it.median_difference * 1000.0;
            let (quantity, pairs, p) = (it.quantity, it.pairs, it.p);
            text.push_str(&format!(
                "\n{row} against {against}, {seconds} s, {quantity}: median difference {difference:+.1} over {pairs} \
                 logs, Wilcoxon p = {p:.1e}"
            ));
        }
        text.push('\n');
        text.push_str(&verdict::text(&self.verdicts));
        text.push_str(&verb::errors(&self.results));
        text.push('\n');
        text
    }
}
