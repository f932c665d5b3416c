//! The report of a sweep: the table first, then how the numbers came about, then what made them.

use std::path::Path;

use asami_dataset::{Models, SensorModel, store};

use super::exhibits::Exhibits;
use super::{Cell, Plate, Report, RowKind, Section, Table};
use crate::draw::Figure;
use crate::draw::chapter3::{self, Learning};
use crate::scenario::Start;
use crate::sweep::CannotSweep;
use crate::sweep::cases::write_whole;
use crate::sweep::manifest::{self, Manifest};
use crate::sweep::summary::Spread;
use crate::sweep::table::{Line, MeanSd, Whose};
use crate::sweep::verb::Outcome;
use crate::trial::{Ending, Trial};

/// Writes `report.html` and `figures/*.svg` under `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(outcome: &Outcome, exhibits: &Exhibits, program: &str, out: &Path) -> Result<(), CannotSweep> {
    let manifest = manifest::manifest(&outcome.results, program);
    let (report, figures) = report(outcome, &manifest, exhibits);
    write_whole(&out.join("report.html"), report.html().as_bytes())?;
    let folder = out.join("figures");
    std::fs::create_dir_all(&folder).map_err(CannotSweep::file("make", &folder))?;
    for figure in figures {
        let name = figure.name.to_lowercase().replace(", ", "_").replace([' ', '.'], "_");
        write_whole(&folder.join(format!("{name}.svg")), figure.svg().as_bytes())?;
    }
    Ok(())
}

/// The report, and the figures in it that are worth files of their own.
#[must_use]
pub fn report(outcome: &Outcome, manifest: &Manifest, exhibits: &Exhibits) -> (Report, Vec<Figure>) {
    let scenario = &outcome.results.scenario;
    let both = both_at_once(outcome);
    let mut report =
        Report::new(&scenario.name, &scenario.about).answer(answer(outcome)).section(table_section(outcome));
    if !outcome.verdicts.is_empty() {
        report = report.section(verdicts_section(outcome));
    }
    if !exhibits.walk.is_empty() {
        report = report.section(walk_section(outcome, exhibits));
    }
    if !exhibits.single.is_empty() {
        report = report.section(single_section(&exhibits.single));
    }
    if !both.is_empty() {
        report = report.section(both_section(&both));
    }
    if !outcome.comparisons.is_empty() {
        report = report.section(comparisons_section(outcome));
    }
    report = report.section(trials_section(outcome)).footnote(
        "Errors are root mean squares after the published scaling (Stronger 2008, section 3.3.2): action models as \
         k A(c) with the best k, sensor models as a + b S(o) with the best a and b.",
    );
    let figures = exhibits.single.iter().chain(&both).cloned().chain(speed_figure(outcome)).collect();
    (made_with(report, manifest), figures)
}

/// What came out, in two sentences.
fn answer(outcome: &Outcome) -> String {
    let holding = outcome.verdicts.iter().filter(|verdict| verdict.holds).count();
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
    let expected = match outcome.verdicts.len() {
        0 => String::new(),
        all if holding == all => format!(" All {all} expected answers came out."),
        all => format!(" {holding} of {all} expected answers came out; the others are below."),
    };
    format!("{}{expected}", found.unwrap_or_default())
}

fn in_words(start: Start) -> &'static str {
    match start {
        Start::C => "A0(c) = c",
        Start::Sgn => "A0(c) = Sgn(c)",
        Start::One => "A0(c) = 1",
        Start::ReferenceQuartic => "the best quartic",
        Start::ReferenceCubic => "the best cubic",
    }
}

fn mean_sd_cell(value: Option<MeanSd>) -> Cell {
    value.map_or_else(Cell::default, |(mean, sd)| Cell::mean_sd(mean, sd.unwrap_or(f64::NAN), 1))
}

fn table_section(outcome: &Outcome) -> Section {
    let heads =
        ["source", "learner", "starting model", "time (s)", "sensor error (mm)", "action error (mm/s)", "converged"];
    let table = Table::new("Table 3.1", &heads).caption(
        "Mean \u{b1} standard deviation over the trials that converged, the dissertation's rows under ours. Rows marked \
         `reference` need the truth: `floor` is the best polynomial of the same degree, `unlearned` a starting model as \
         it is. Good: close to the floor, and far below the unlearned model. Point at an error for median, \
         interquartile mean and a bootstrap interval; click on a head to sort.",
    );
    Section::new("Table 3.1").table(outcome.lines.iter().fold(table, |table, line| {
        let kind = match line.whose {
            Whose::Asami => RowKind::Ours,
            Whose::Reference => RowKind::Reference,
            Whose::Dissertation => RowKind::Published,
        };
        table.row(kind, cells(line))
    }))
}

fn cells(line: &Line) -> [Cell; 7] {
    let spread = |pick: fn(&crate::sweep::summary::Summary) -> Option<&Spread>| line.summary.as_ref().and_then(pick);
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
        line.start.map_or("", in_words).into(),
        line.duration_s.map_or_else(Cell::default, |duration_s| Cell::number(duration_s, 0)),
        mean_sd_cell(line.sensor_rmse_mm).hint(hint(spread(|it| it.sensor_rmse_m.as_ref()))),
        mean_sd_cell(line.action_rmse_mm_per_s).hint(hint(spread(|it| it.action_rmse_m_per_s.as_ref()))),
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

fn verdicts_section(outcome: &Outcome) -> Section {
    let table = Table::new("Expected answers", &["claim", "came out"])
        .caption("What the scenario file expects of its rows, and what was found. A `no` is a finding, or a bug.");
    Section::new("Expected answers").table(outcome.verdicts.iter().fold(table, |table, verdict| {
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

fn both_section(figures: &[Figure]) -> Section {
    let section = Section::new("Both models from each other").text(
        "Algorithm 1 on the scenario's first log, started from its first row's model, and its learning curves over all \
         logs.",
    );
    arranged(section, figures.iter().map(Plate::from))
}

/// Wide figures alone, the others in pairs.
fn arranged(mut section: Section, plates: impl IntoIterator<Item = Plate>) -> Section {
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

/// Figures 3.7 to 3.9, of the first row that leaves curves behind.
fn both_at_once(outcome: &Outcome) -> Vec<Figure> {
    let results = &outcome.results;
    let traced = results
        .records
        .first()
        .into_iter()
        .flat_map(|record| &record.trials)
        .find(|trial| trace(trial, "w_s").is_some());
    let Some(trial) = traced else { return Vec::new() };
    let mut figures = Vec::new();
    if let (Some(w_a), Some(w_s)) = (trace(trial, "w_a"), trace(trial, "w_s")) {
        figures.push(chapter3::figure_3_7(w_a, w_s));
    }
    let models = trial.models.clone().and_then(|text| store::parse_models(text).ok()).map(|(_, models)| models);
    if let (Some(models), Some(survey)) = (models, &results.survey) {
        figures.extend(learned_action(trial, &models, survey));
        figures.extend(learned_sensor(trial, &models, survey));
    }
    let floor = results.records.first().map(crate::sweep::rows::floor).unwrap_or_default();
    let trials = || results.records.iter().filter_map(|record| record.trials.get(trial.row));
    let curves = |error: fn(&crate::trial::CurvePoint) -> Option<f64>| -> Vec<Vec<[f64; 2]>> {
        let points = |trial: &Trial| {
            trial.curve.iter().filter_map(|point| Some([point.t_s - trial.case.start_s(), error(point)?])).collect()
        };
        trials().map(points).filter(|curve: &Vec<[f64; 2]>| !curve.is_empty()).collect()
    };
    let sensor = chapter3::figure_3_9(Learning::Sensor, &curves(|point| point.sensor_rmse_m), floor.sensor_rmse_m);
    let action =
        chapter3::figure_3_9(Learning::Action, &curves(|point| point.action_rmse_m_per_s), floor.action_rmse_m_per_s);
    figures.extend([sensor, action]);
    figures
}

fn trace<'a>(trial: &'a Trial, name: &str) -> Option<&'a [[f64; 2]]> {
    trial.traces.iter().find(|(found, points)| found == name && !points.is_empty()).map(|(_, points)| points.as_slice())
}

fn learned_action(trial: &Trial, models: &Models, survey: &asami_dataset::Survey) -> Option<Figure> {
    let (action, k) = (models.action.as_ref()?, trial.scores.action_scale?);
    if survey.speed_by_command.is_empty() {
        return None;
    }
    Some(chapter3::figure_3_8a(&survey.speed_by_command, |c| action.forward_at(c).map_or(f64::NAN, |v| k * v)))
}

fn learned_sensor(trial: &Trial, models: &Models, survey: &asami_dataset::Survey) -> Option<Figure> {
    let Some(SensorModel::DistanceOfHeight(curve)) = &models.sensor else { return None };
    if survey.height_by_distance.is_empty() {
        return None;
    }
    let (a, b) = (trial.scores.sensor_offset_m?, trial.scores.sensor_scale?);
    Some(chapter3::figure_3_8b(&survey.height_by_distance, |o| a + b * curve.polynomial.at(o)))
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
        let p = Cell { text: format!("{:.1e}", it.p), value: Some(it.p), ..Cell::default() };
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

fn trials_section(outcome: &Outcome) -> Section {
    let heads =
        ["learner", "starting model", "time (s)", "log", "sensor error (mm)", "action error (mm/s)", "ended", "why"];
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
                row.start.map_or("", in_words).into(),
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

fn made_with(report: Report, manifest: &Manifest) -> Report {
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
