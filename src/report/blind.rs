//! The report of a blind sweep, and all its files.

use std::path::Path;

use super::sweep::{arranged, made_with, verdicts_section, write_plates};
use super::{CannotWrite, Cell, Plate, Report, RowKind, Section, Table};
use crate::blind::rows;
use crate::blind::scenario::Measure;
use crate::blind::tables::{self, planted_alone};
use crate::blind::tally::{Asked, Share, asked, measure, power, reliability};
use crate::blind::walk::{Record, Results};
use crate::draw::{Figure, blind as curves};
use crate::sweep::cases::write_whole;
use crate::sweep::verdict::{self, Verdict};
use crate::sweep::{CannotSweep, Finished, manifest};

/// Writes `trials.csv`, `timings.csv`, `manifest.json`, tables, figures and `report.html` under `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(results: &Results, program: &str, out: &Path) -> Result<Finished, CannotSweep> {
    std::fs::create_dir_all(out).map_err(CannotSweep::file("make", out))?;
    let write = |name: &str, text: &str| write_whole(&out.join(name), text.as_bytes());
    write("trials.csv", &rows::trials(results))?;
    write("timings.csv", &rows::timings(results))?;
    let tables = tables::all(results);
    for (name, table) in &tables {
        write(&format!("{name}.csv"), &table.csv())?;
        write(&format!("{name}.md"), &table.markdown())?;
    }
    let cases = results.records.len();
    let counts = (cases, cases * results.question.diagnosers.len());
    let manifest = manifest::of((&results.question.name, results.question.hash.clone()), counts, program);
    manifest.write(out)?;

    let verdicts = tables::verdicts(results);
    let figures = figures(results);
    let mut report = Report::new(&results.question.name, &results.question.about)
        .answer(answer(results, &verdicts))
        .as_expected(verdict::all_hold(&verdicts));
    for (_, table) in tables.iter().filter(|(name, _)| !is_detail(name)) {
        report = report.section(Section::new(&table.name).table(table.clone()));
    }
    if !verdicts.is_empty() {
        report = report.section(verdicts_section(&verdicts));
    }
    report = report.section(arranged(Section::new("Curves"), figures.iter().map(Plate::from)));
    for (_, table) in tables.iter().filter(|(name, _)| is_detail(name)) {
        report = report.section(Section::new(&table.name).table(table.clone()));
    }
    report = report.section(every_case(results)).footnote(
        "D_sep: log-likelihood of the log in the true world less that of the best hypothesis outside the truth's group, each \
         less half k log n, by the referee's likelihood, which is the same for all diagnosers. An effect is of the \
         truth's group where the scenario says so, or where predictions under the two part by less than 3 nats in that log. \
         What a diagnosis closes is measured by the referee on the whole log.",
    );
    let failed = |error: CannotWrite| CannotSweep::file("write", &error.path)(error.source);
    made_with(report, &manifest).write(&out.join("report.html")).map_err(failed)?;
    write_plates(figures.iter().map(Plate::from), out)?;
    Ok(finished(results, &tables, &verdicts))
}

/// What stands below the curves, and in files.
fn is_detail(table: &str) -> bool {
    table.starts_with("confusion") || table == "power"
}

fn finished(results: &Results, tables: &[(String, Table)], verdicts: &[Verdict]) -> Finished {
    let broken: Vec<(&str, &Record)> = results.cases().filter(|(_, record)| record.is_broken()).collect();
    let shown = tables.iter().filter(|(name, _)| !is_detail(name)).map(|(_, table)| format!("\n{}", table.markdown()));
    let errors = broken.iter().map(|(scenario, record)| {
        let error = record.answers.iter().map(|answer| &answer.error).find(|error| !error.is_empty());
        format!("\nERROR: {scenario}, case {}: {}", record.number, error.unwrap_or(&record.error))
    });
    let text = format!(
        "{}\n{}{}{}\n",
        results.question.about,
        shown.collect::<String>(),
        verdict::text(verdicts),
        errors.collect::<String>()
    );
    Finished { text, has_errors: !broken.is_empty() }
}

/// What came out, in two sentences.
fn answer(results: &Results, verdicts: &[Verdict]) -> String {
    let Some(name) = results.question.diagnosers.first() else { return String::new() };
    let separated: Vec<Asked<'_>> =
        asked(results, 0).filter(|it| it.is_planted() && it.is_separated(10.0..f64::INFINITY)).collect();
    let right = measure(Measure::TopGroupRight, &separated).share.unwrap_or_default();
    let all: Vec<Asked<'_>> = asked(results, 0).collect();
    let none = measure(Measure::NoneCalledElse, &all).share.unwrap_or_default();
    let Share { count, of } = right;
    let expected = verdict::in_words(verdicts);
    let called = match none.of {
        0 => String::new(),
        of => format!(", and calls {} of {of} logs without an effect anything else", none.count),
    };
    format!(
        "`{name}` puts the true cause first in {count} of {of} cases that separate it by 10 nats and more{called}.{expected}"
    )
}

/// A share as a point with its interval.
fn bar(x: f64, share: Share) -> [f64; 4] {
    let [low, high] = share.interval().unwrap_or([f64::NAN; 2]);
    [x, share.value().unwrap_or(f64::NAN), low, high]
}

fn figures(results: &Results) -> Vec<Figure> {
    let diagnosers = || results.question.diagnosers.iter().enumerate();
    let curve = |i: usize| reliability(asked(results, i)).iter().map(|bin| bar(bin.probability, bin.right)).collect();
    let reliability: Vec<curves::Bars> = diagnosers().map(|(i, name)| (name.clone(), curve(i))).collect();
    let dots = |i: usize| {
        let planted = asked(results, i).filter(|it| it.is_planted());
        planted.filter_map(|it| Some([it.reference.d_sep?, it.answer.true_probability])).collect::<Vec<_>>()
    };
    let separation: Vec<_> = diagnosers().take(1).map(|(i, name)| (name.clone(), dots(i))).collect();
    let mut figures = vec![curves::reliability(&reliability), curves::separation(&separation)];
    for effect in planted_alone(results) {
        let references = results.records.iter().filter_map(|record| record.reference.as_ref());
        let Some(planted) = references.flat_map(|it| &it.effects).find(|it| it.name == effect) else { continue };
        let log10 = |size: f64| asami_math::elementary::ln(size) / std::f64::consts::LN_10;
        let points = |i: usize| {
            power(asked(results, i), &effect).iter().map(|point| bar(log10(point.size), point.right)).collect()
        };
        let series: Vec<curves::Bars> = diagnosers().map(|(i, name)| (name.clone(), points(i))).collect();
        let (least, greatest) = planted.sizes;
        figures.push(curves::power(&effect, &planted.parameter, (log10(least), log10(greatest)), &series));
    }
    figures
}

fn every_case(results: &Results) -> Section {
    let heads = ["case", "diagnoser", "planted", "D_sep", "verdict", "named", "P", "P of truth", "right", "error"];
    let mut table = Table::new("Every case", &heads).caption("Everything else is in `trials.csv`.");
    for (scenario, record) in results.cases() {
        let case: Cell = match results.is_pool() {
            true => format!("{scenario} {}", record.number).into(),
            false => Cell::number(record.number as f64, 0),
        };
        for (name, answer) in results.question.diagnosers.iter().zip(&record.answers) {
            let planted = if record.planted.is_empty() { "none".to_owned() } else { record.planted.join("+") };
            let d_sep = record.reference.as_ref().and_then(|reference| reference.d_sep).unwrap_or(f64::NAN);
            let error = if record.error.is_empty() { &answer.error } else { &record.error };
            let cells: [Cell; 10] = [
                case.clone(),
                name.as_str().into(),
                planted.into(),
                Cell::number(d_sep, 1),
                answer.verdict.as_str().into(),
                answer.named.join("+").into(),
                Cell::number(answer.probability, 3),
                Cell::number(answer.true_probability, 3),
                if answer.top_group_right { "yes" } else { "no" }.into(),
                error.as_str().into(),
            ];
            table = table.row(if answer.top_group_right { RowKind::Ours } else { RowKind::Reference }, cells);
        }
    }
    Section::new("Every case").folded().table(table)
}
