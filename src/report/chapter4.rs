//! The report of a sweep of chapter 4: tables first, then expected answers, figures, tests, every trial.

use super::sweep::{arranged, made_with, survey_sections, verdicts_section, write_plates};
use super::{CannotWrite, Cell, Plate, Report, RowKind, Section, Table};
use crate::draw::Figure;
use crate::scenario::{Era, Start};
use crate::study::Finishing;
use crate::sweep::outcome::Outcome;
use crate::sweep::tally::Tallied;
use crate::sweep::{CannotSweep, manifest, verdict};
use crate::trial::Ending;

/// Writes `report.html` and `figures/*.svg`; `footnote` says how errors are measured.
///
/// # Errors
/// If a file cannot be written.
pub fn write<S: Tallied>(
    outcome: &Outcome<S>,
    figures: &[Figure],
    footnote: &str,
    finishing: &Finishing<'_>,
) -> Result<(), CannotSweep> {
    let report = report(outcome, figures, finishing).footnote(footnote);
    let failed = |error: CannotWrite| CannotSweep::file("write", &error.path)(error.source);
    report.write(&finishing.out.join("report.html")).map_err(failed)?;
    let exhibits = finishing.exhibits.walk.iter().chain(&finishing.exhibits.scans).cloned();
    write_plates(figures.iter().map(Plate::from).chain(exhibits), finishing.out)
}

fn report<S: Tallied>(outcome: &Outcome<S>, figures: &[Figure], finishing: &Finishing<'_>) -> Report {
    let scenario = &outcome.results.scenario;
    let mut report = Report::new(&scenario.name, &scenario.about)
        .answer(answer(outcome))
        .as_expected(verdict::all_hold(&outcome.verdicts));
    for table in &outcome.tables {
        report = report.section(Section::new(table.title).table(table.reported()));
    }
    if !outcome.verdicts.is_empty() {
        report = report.section(verdicts_section(&outcome.verdicts));
    }
    if !figures.is_empty() {
        report = report.section(arranged(Section::new("Figures"), figures.iter().map(Plate::from)));
    }
    if !finishing.exhibits.walk.is_empty() {
        report = report.section(arranged(Section::new("The walk"), finishing.exhibits.walk.iter().cloned()));
    }
    if !finishing.exhibits.scans.is_empty() {
        let section = Section::new("What the scanner sees");
        report = report.section(arranged(section, finishing.exhibits.scans.iter().cloned()));
    }
    if !outcome.comparisons.is_empty() {
        report = report.section(comparisons_section(outcome));
    }
    if let Some(survey) = &outcome.results.survey {
        report = survey_sections(survey).into_iter().fold(report, Report::section);
    }
    report = report.section(trials_section(outcome));
    made_with(report, &manifest::manifest(&outcome.results, finishing.program))
}

/// What came out, in two sentences.
fn answer<S: Tallied>(outcome: &Outcome<S>) -> String {
    let rows = &outcome.results.scenario.rows;
    let (converged, trials) = outcome.tallies.iter().fold((0, 0), |(a, b), it| (a + it.converged, b + it.trials));
    let expected = verdict::in_words(&outcome.verdicts);
    format!("{converged} of {trials} trials of {} rows converge.{expected}", rows.len())
}

fn comparisons_section<S: Tallied>(outcome: &Outcome<S>) -> Section {
    let heads = ["learner", "start", "against", "robot", "landmarks", "quantity", "logs", "median difference", "p"];
    let table = Table::new("Paired comparisons", &heads).caption(
        "The same logs, one learner against the published one from the same start: median of the differences (negative: \
         the first errs less) and the two-sided p of Wilcoxon's signed-rank test. Fewer than six logs tell nothing.",
    );
    let id = |id: Option<u16>| id.map_or_else(String::new, |id| id.to_string());
    let rows = &outcome.results.scenario.rows;
    Section::new("Paired comparisons").folded().table(outcome.comparisons.iter().fold(table, |table, it| {
        let p = if it.p < 1e-3 { format!("{:.0e}", it.p) } else { format!("{:.3}", it.p) };
        let row = &rows[it.row];
        let cells: [Cell; 9] = [
            row.label.as_str().into(),
            row.start.map_or("", Start::name).into(),
            rows[it.against].label.as_str().into(),
            id(it.group.robot).into(),
            id(it.group.landmarks).into(),
            S::names()[it.quantity].into(),
            Cell::number(it.pairs as f64, 0),
            Cell::number(it.median_difference, 4),
            Cell { text: p, value: Some(it.p), ..Cell::default() },
        ];
        table.row(RowKind::Ours, cells)
    }))
}

fn trials_section<S: Tallied>(outcome: &Outcome<S>) -> Section {
    let heads = ["learner", "start", "era", "log", "iterations", "ended", "why", "what the log lacks"];
    let table = Table::new("Every trial", &heads)
        .caption("One row for each trial; its numbers are in `trials.csv`, what it learned under `models/`.");
    let table = outcome.results.trials().fold(table, |table, (record, trial)| {
        let row = &outcome.results.scenario.rows[trial.row];
        let kind = if trial.ending == Ending::Converged { RowKind::Ours } else { RowKind::Reference };
        let cells: [Cell; 8] = [
            row.label.as_str().into(),
            row.start.map_or("", Start::name).into(),
            if row.era == Era::After { "after" } else { "" }.into(),
            record.case.name().into(),
            Cell::number(trial.iterations.map_or(f64::NAN, f64::from), 0),
            trial.ending.name().into(),
            trial.reason.as_str().into(),
            trial.lacks.join("; ").into(),
        ];
        table.row(kind, cells)
    });
    Section::new("Every trial").folded().table(table)
}
