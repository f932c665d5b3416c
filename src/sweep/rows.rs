//! `timings.csv`, `models/` and what every `trials.csv` is written with: every raw row, the same bytes
//! whatever happened on the way.

use std::path::Path;

use asami_dataset::store::number;

use super::cases::write_whole;
use super::{CannotSweep, Results};
use crate::scenario::{Era, Row, Start};
use crate::study::Study;
use crate::trial::{Case, Trial};

/// Writes `trials.csv`, `timings.csv` and `models/` under `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write<S: Study>(results: &Results<S>, trials: &str, out: &Path) -> Result<(), CannotSweep> {
    write_whole(&out.join("trials.csv"), trials.as_bytes())?;
    write_whole(&out.join("timings.csv"), timings(results).as_bytes())?;
    let folder = out.join("models");
    std::fs::create_dir_all(&folder).map_err(CannotSweep::file("make", &folder))?;
    for (_, trial) in results.trials() {
        if let (Some(row), Some(models)) = (results.scenario.rows.get(trial.row), &trial.models) {
            write_whole(&folder.join(models_name(row, trial, results)), models.as_bytes())?;
        }
    }
    Ok(())
}

/// `<learner>-<start>-<case>.toml`; a later row of the same learner and start has its duration in the
/// name too.
fn models_name<S: Study>(row: &Row, trial: &Trial<S::Scores>, results: &Results<S>) -> String {
    let earlier = &results.scenario.rows[..trial.row];
    let is_later =
        earlier.iter().any(|other| (&other.label, other.start, other.era) == (&row.label, row.start, row.era));
    let duration = if is_later { format!("-{}s", row.duration_s) } else { String::new() };
    let era = if row.era == Era::After { "-after" } else { "" };
    format!("{}-{}-{}{era}{duration}.toml", row.label, row.start.map_or("none", Start::name), trial.case.name())
}

/// `timings.csv`: wall-clock seconds, which no other file holds.
#[must_use]
pub fn timings<S: Study>(results: &Results<S>) -> String {
    let mut text = String::from("scenario,case,learner,starting_model,duration_s,wall_s\n");
    let name = &results.scenario.name;
    for record in &results.records {
        let case = record.case.name();
        text.push_str(&format!("{name},{case},,,,{}\n", number(record.timing.log_s)));
        for (row, wall_s) in results.scenario.rows.iter().zip(&record.timing.trials_s) {
            let start = row.start.map_or("", Start::name);
            let duration = number(row.duration_s);
            text.push_str(&format!("{name},{case},{},{start},{duration},{}\n", row.label, number(*wall_s)));
        }
    }
    text
}

/// What every row of `trials.csv` begins with: scenario, learner, starting model and seed.
#[must_use]
pub fn head<S: Study>(results: &Results<S>, trial: &Trial<S::Scores>) -> Vec<String> {
    let row = &results.scenario.rows[trial.row];
    let (label, start) = (row.label.clone(), row.start.map_or("", Start::name).to_owned());
    vec![results.scenario.name.clone(), label, start, trial.case.seed.to_string()]
}

/// What every row of chapter 4 ends with: duration, what the log lacks, verdict and reason.
#[must_use]
pub fn tail<S: Study>(results: &Results<S>, trial: &Trial<S::Scores>) -> [String; 4] {
    let duration_s = number(results.scenario.rows[trial.row].duration_s);
    [duration_s, quoted(&trial.lacks.join("; ")), trial.ending.name().to_owned(), quoted(&trial.reason)]
}

/// Which part of a recording a trial learned from: when it begins, and whether it overlaps others.
#[must_use]
pub fn window(case: &Case) -> [String; 2] {
    let start_s = optional(case.window.map(|window| window.start_s));
    [start_s, case.window.is_some_and(|window| window.overlapping).to_string()]
}

/// Adds a row.
pub fn push(text: &mut String, fields: &[String]) {
    text.push_str(&fields.join(","));
    text.push('\n');
}

/// Metres, or metres a second, as the dissertation prints them; empty for what does not exist.
#[must_use]
pub fn millimetres(metres: Option<f64>) -> String {
    optional(metres.map(|metres| metres * 1000.0))
}

/// A number, or nothing.
#[must_use]
pub fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// A field of a CSV, in quotes where it needs them (RFC 4180).
#[must_use]
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
