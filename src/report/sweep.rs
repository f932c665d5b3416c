//! The report of a sweep: the table first, then how the numbers came about, then what made them.

use std::path::Path;

use asami_dataset::Survey;

use super::both_at_once;
use super::exhibits::Exhibits;
use super::{CannotWrite, Cell, Plate, Report, RowKind, Section, Table};
use crate::draw::Figure;
use crate::draw::chapter3;
use crate::scenario::{Origin, Start};
use crate::sweep::cases::write_whole;
use crate::sweep::line::Outcome;
use crate::sweep::line::table::{self, Line, MeanSd};
use crate::sweep::manifest::{self, Manifest};
use crate::sweep::spread::Spread;
use crate::sweep::verdict::{self, Verdict};
use crate::sweep::{CannotSweep, Whose};
use crate::trial::Ending;

/// Writes `report.html` and `figures/*.svg` under `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(outcome: &Outcome, exhibits: &Exhibits, program: &str, out: &Path) -> Result<(), CannotSweep> {
    let manifest = manifest::manifest(&outcome.results, program);
    let (report, figures) = report(outcome, &manifest, exhibits);
    let failed = |error: CannotWrite| CannotSweep::file("write", &error.path)(error.source);
    report.write(&out.join("report.html")).map_err(failed)?;
    write_plates(figures.iter().map(Plate::from).chain(exhibits.walk.iter().cloned()), out)
}

/// Writes what is worth files of its own as `figures/*.svg` under `out`.
pub(super) fn write_plates(plates: impl Iterator<Item = Plate>, out: &Path) -> Result<(), CannotSweep> {
    let folder = out.join("figures");
    std::fs::create_dir_all(&folder).map_err(CannotSweep::file("make", &folder))?;
    for plate in plates {
        let name = plate.name.to_lowercase().replace(", ", "_").replace([' ', '.'], "_");
        write_whole(&folder.join(format!("{name}.svg")), plate.svg().as_bytes())?;
    }
    Ok(())
}

/// The report, and the figures in it that are worth files of their own.
#[must_use]
pub fn report(outcome: &Outcome, manifest: &Manifest, exhibits: &Exhibits) -> (Report, Vec<Figure>) {
    let scenario = &outcome.results.scenario;
    let both = both_at_once::figures(&outcome.results);
    let mut report = Report::new(&scenario.name, &scenario.about)
        .answer(answer(outcome))
        .as_expected(verdict::all_hold(&outcome.verdicts))
        .section(table_section(outcome));
    if !outcome.verdicts.is_empty() {
        report = report.section(verdicts_section(&outcome.verdicts));
    }
    if !exhibits.walk.is_empty() {
        report = report.section(walk_section(outcome, exhibits));
    }
    if !exhibits.single.is_empty() {
        report = report.section(single_section(&exhibits.single));
    }
    if !both.is_empty() {
        report = report.section(both_section(outcome, &both));
    }
    if !outcome.comparisons.is_empty() {
        report = report.section(comparisons_section(outcome));
    }
    if let Some(survey) = &outcome.results.survey {
        report = survey_sections(survey).into_iter().fold(report, Report::section);
    }
    report = report.section(trials_section(outcome)).footnote(
        "Errors are root mean squares after the published scaling (Stronger 2008, section 3.3.2): action models as \
         k A(c) with the best k, sensor models as a + b S(o) with the best a and b. The scale difference is how far \
         `|k| / |b|` is from 1: 0 if both models are in one unit of length.",
    );
    let figures = exhibits.single.iter().chain(&both).cloned().chain(speed_figure(outcome)).collect();
    (made_with(report, manifest), figures)
}

/// What came out, in two sentences.
fn answer(outcome: &Outcome) -> String {
    let first = outcome.lines.iter().find(|line| line.whose == Whose::Asami);
    let found = first.map(|line| {
        let start = line.start.map_or_else(String::new, |start| format!(" from {}", in_words(start)));
        let count = match (line.converged, line.trials) {
            (Some(converged), Some(trials)) => format!("converges in {converged} of {trials} trials"),
            _ => "was tried".to_owned(),
        };
        let errors = [(line.sensor_rmse_mm, "mm (sensor)"), (line.action_rmse_mm_per_s, "mm/s (action)")];
        let errors: Vec<String> = (errors.into_iter())
            .filter_map(|(value, unit)| value.map(|value| format!("{} {unit}", mean_sd_cell(Some(value)).text)))
            .collect();
        let errors =
            if errors.is_empty() { String::new() } else { format!(", with errors of {}", errors.join(" and ")) };
        format!("`{}`{start} {count}{errors}.", line.learner)
    });
    format!("{}{}", found.unwrap_or_default(), verdict::in_words(&outcome.verdicts))
}

fn in_words(start: Start) -> String {
    match start {
        Start::C | Start::Sgn | Start::One => format!("A0(c) = {}", in_a_cell(start)),
        _ => format!("the {}", in_a_cell(start)),
    }
}

fn in_a_cell(start: Start) -> &'static str {
    match start {
        Start::C => "c",
        Start::Sgn => "Sgn(c)",
        Start::One => "1",
        Start::ReferenceQuartic => "best quartic",
        Start::ReferenceCubic => "best cubic",
        of_chapter_4 => of_chapter_4.name(),
    }
}

fn mean_sd_cell(value: Option<MeanSd>) -> Cell {
    value.map_or_else(Cell::default, |(mean, sd)| Cell::mean_sd(mean, sd.unwrap_or(f64::NAN), 1))
}

fn table_section(outcome: &Outcome) -> Section {
    let heads = [
        "source",
        "learner",
        "A0(c)",
        "time (s)",
        "sensor error (mm)",
        "action error (mm/s)",
        "scale difference",
        "converged",
    ];
    let table = Table::new("Table 3.1", &heads).caption(
        "Mean \u{b1} standard deviation over the trials that converged, the dissertation's rows under ours. A0(c) is \
         the model that a learner starts from. Rows marked `reference` need the truth: `floor` is the best polynomial \
         of the same degree, `unlearned` a starting model as it is. Good: close to the floor, and far below the \
         unlearned model. Point at an error for median, interquartile mean and a bootstrap interval; click on a head \
         to sort.",
    );
    let section = match outcome.results.scenario.origin {
        Origin::Simulated(_) => Section::new("Table 3.1"),
        Origin::Recorded(_) => Section::new("Table 3.1, on a recorded log")
            .text("The dissertation's rows are of its Aibo: another robot, on another range of distances and speeds."),
    };
    let section = section.table(outcome.lines.iter().fold(table, |table, line| {
        let kind = match line.whose {
            Whose::Asami => RowKind::Ours,
            Whose::Reference => RowKind::Reference,
            Whose::Dissertation => RowKind::Published,
        };
        table.row(kind, cells(line))
    }));
    let remarks = table::remarks(&outcome.results, &outcome.summaries);
    remarks.into_iter().fold(section, Section::text)
}

fn cells(line: &Line) -> [Cell; 8] {
    let spread =
        |pick: fn(&crate::sweep::line::summary::Summary) -> Option<&Spread>| line.summary.as_ref().and_then(pick);
    let converged = match (line.converged, line.trials) {
        (Some(converged), Some(trials)) => Cell {
            text: format!("{converged}/{trials}"),
            value: Some(converged as f64 / trials.max(1) as f64),
            ..Cell::default()
        },
        _ => Cell::default(),
    };
    [
        line.whose.name().into(),
        line.learner.as_str().into(),
        line.start.map_or("", in_a_cell).into(),
        line.duration_s.map_or_else(Cell::default, |duration_s| Cell::number(duration_s, 0)),
        mean_sd_cell(line.sensor_rmse_mm).hint(hint(spread(|it| it.sensor_rmse_m.as_ref()))),
        mean_sd_cell(line.action_rmse_mm_per_s).hint(hint(spread(|it| it.action_rmse_m_per_s.as_ref()))),
        spread(|it| it.scale_difference.as_ref())
            .map_or_else(Cell::default, |it| Cell::mean_sd(it.mean, it.sd.unwrap_or(f64::NAN), 2)),
        converged,
    ]
}

fn hint(spread: Option<&Spread>) -> String {
    let Some(spread) = spread else { return String::new() };
    let interval =
        spread.interval.map(|[low, high]| format!("\n95 % of the mean {:.1} to {:.1}", 1e3 * low, 1e3 * high));
    let (median, middle) = (1e3 * spread.median, 1e3 * spread.interquartile_mean);
    format!("median {median:.1}\ninterquartile mean {middle:.1}{}", interval.unwrap_or_default())
}

pub(super) fn verdicts_section(verdicts: &[Verdict]) -> Section {
    let table = Table::new("Expected answers", &["claim", "came out"]).caption(
        "What the scenario file expects of its rows, and what was found. A `no` is a finding, or a bug; or it is for \
             want of logs: no paired test can hold on fewer than six.",
    );
    Section::new("Expected answers").table(verdicts.iter().fold(table, |table, verdict| {
        table.row(RowKind::Ours, [verdict.claim.clone().into(), if verdict.holds { "yes" } else { "no" }.into()])
    }))
}

fn walk_section(outcome: &Outcome, exhibits: &Exhibits) -> Section {
    let section = Section::new("The walk").text(
        "One walk towards the beacon, simulated again for this page. Nothing here was given to a learner but the \
         beacon's heights and bearings, found in images like the one below.",
    );
    arranged(section, exhibits.walk.iter().cloned().chain(speed_figure(outcome).iter().map(Plate::from)))
}

/// Speed over command, where speeds were surveyed.
fn speed_figure(outcome: &Outcome) -> Option<Figure> {
    let speeds = &outcome.results.survey.as_ref()?.speed_by_command;
    (!speeds.is_empty()).then(|| chapter3::speed_over_command(speeds))
}

fn single_section(figures: &[Figure]) -> Section {
    let section = Section::new("One model from the other").text(
        "Section 3.2: with one model given, the other is a regression. Qualitative in the dissertation, as here.",
    );
    arranged(section, figures.iter().map(Plate::from))
}

fn both_section(outcome: &Outcome, figures: &[Figure]) -> Section {
    let row = both_at_once::shown(&outcome.results).map(|trial| &outcome.results.scenario.rows[trial.row]);
    let who = row.map_or_else(String::new, |row| {
        let start = row.start.map_or_else(String::new, |start| format!(" started from {}", in_words(start)));
        format!(
            "`{}`{start}, {} s: one run on the first log, and learning curves over all logs.",
            row.label, row.duration_s
        )
    });
    arranged(Section::new("Both models from each other").text(who), figures.iter().map(Plate::from))
}

/// Wide figures alone, the others in pairs.
pub(super) fn arranged(mut section: Section, plates: impl IntoIterator<Item = Plate>) -> Section {
    let mut pair: Vec<Plate> = Vec::new();
    for plate in plates {
        if plate.is_wide() {
            section = section.figures(std::mem::take(&mut pair)).figure(plate);
        } else {
            pair.push(plate);
            if pair.len() == 2 {
                section = section.figures(std::mem::take(&mut pair));
            }
        }
    }
    section.figures(pair)
}

fn comparisons_section(outcome: &Outcome) -> Section {
    let heads = ["learner", "against", "time (s)", "quantity", "logs", "median difference (mm, mm/s)", "p"];
    let table = Table::new("Paired comparisons", &heads).caption(
        "The same logs, one learner against another: median of the differences (negative: the first errs less) and the \
         two-sided p of Wilcoxon's signed-rank test.",
    );
    let name = |row: usize| {
        let row = &outcome.results.scenario.rows[row];
        row.start.map_or_else(|| row.label.clone(), |start| format!("{}, {}", row.label, in_words(start)))
    };
    Section::new("Paired comparisons").table(outcome.comparisons.iter().fold(table, |table, it| {
        let p = if it.p < 1e-3 { format!("{:.0e}", it.p) } else { format!("{:.3}", it.p) };
        let p = Cell { text: p, value: Some(it.p), ..Cell::default() };
        let duration_s = outcome.results.scenario.rows[it.row].duration_s;
        table.row(
            RowKind::Ours,
            [
                name(it.row).into(),
                name(it.against).into(),
                Cell::number(duration_s, 0),
                it.quantity.into(),
                Cell::number(it.pairs as f64, 0),
                Cell::number(1e3 * it.median_difference, 1),
                p,
            ],
        )
    }))
}

/// The measured models, where there are any.
pub(super) fn survey_sections(survey: &Survey) -> Option<Section> {
    let speeds = Table::new("Speeds", &["command (mm/s)", "speed (mm/s)", "sd (mm/s)", "timings"]).caption(
        "Timed between two lines (section 3.3.2). The dissertation's standard deviations never exceeded 7 mm/s.",
    );
    let speeds = survey.speed_by_command.iter().fold(speeds, |table, it| {
        let mm = [it.command_m_per_s, it.speed_m_per_s, it.sd_m_per_s].map(|value| Cell::number(1e3 * value, 1));
        table.row(RowKind::Ours, mm.into_iter().chain([Cell::number(f64::from(it.timings), 0)]))
    });
    let heights = Table::new("Heights", &["distance (mm)", "height (px)", "sd (px)", "readings"]).caption(
        "Beacon heights seen while standing at measured distances. The dissertation's standard deviations did not \
         exceed 1.1 px.",
    );
    let heights = survey.height_by_distance.iter().fold(heights, |table, it| {
        let px = [it.height_px, it.sd_px].map(|value| Cell::number(value, 2));
        let readings = Cell::number(f64::from(it.readings), 0);
        table.row(RowKind::Ours, [Cell::number(1e3 * it.distance_m, 0)].into_iter().chain(px).chain([readings]))
    });
    let section = Section::new("The survey").folded().table(speeds).table(heights);
    (!survey.speed_by_command.is_empty() || !survey.height_by_distance.is_empty()).then_some(section)
}

fn trials_section(outcome: &Outcome) -> Section {
    let heads = ["learner", "A0(c)", "time (s)", "log", "sensor error (mm)", "action error (mm/s)", "ended", "why"];
    let table = Table::new("Every trial", &heads).caption(
        "One row for each trial, as in `trials.csv`, where all digits are. Sort by an error to find the odd ones.",
    );
    let number = |value: Option<f64>| Cell::number(value.map_or(f64::NAN, |value| 1e3 * value), 1);
    let table = outcome.results.trials().fold(table, |table, (record, trial)| {
        let row = &outcome.results.scenario.rows[trial.row];
        let kind = if trial.ending == Ending::Converged { RowKind::Ours } else { RowKind::Reference };
        table.row(
            kind,
            [
                row.label.as_str().into(),
                row.start.map_or("", in_a_cell).into(),
                Cell::number(row.duration_s, 0),
                record.case.name().into(),
                number(trial.scores.sensor_rmse_m),
                number(trial.scores.action_rmse_m_per_s),
                trial.ending.name().into(),
                trial.reason.as_str().into(),
            ],
        )
    });
    Section::new("Every trial").folded().table(table)
}

pub(crate) fn made_with(report: Report, manifest: &Manifest) -> Report {
    let commit = manifest.commit.clone().unwrap_or_else(|| "unknown".to_owned());
    let dirty = if manifest.dirty == Some(true) { ", with changes" } else { "" };
    report
        .made_with("command", format!("cargo run --bin sweep scenarios/{}.toml", manifest.scenario))
        .made_with("scenario", manifest.scenario_hash.clone())
        .made_with("asami", format!("{} at {commit}{dirty}", manifest.version))
        .made_with("compiler", format!("{}, {}, {}", manifest.rustc, manifest.target, manifest.profile))
        .made_with("Cargo.lock", manifest.lock_hash.clone())
        .made_with("trials", format!("{} on {} logs", manifest.trials, manifest.cases))
}
