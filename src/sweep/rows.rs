//! `trials.csv`, `timings.csv` and `models/`: every raw row, the same bytes whatever happened on the way.

use std::path::Path;

use asami_dataset::store::number;

use super::cases::write_whole;
use super::{CannotSweep, Record, Results};
use crate::scenario::{Origin, Row, Start};
use crate::scorer::Scores;
use crate::trial::{Ending, Trial};

/// Writes `trials.csv`, `timings.csv` and `models/` under `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(results: &Results, out: &Path) -> Result<(), CannotSweep> {
    write_whole(&out.join("trials.csv"), trials(results).as_bytes())?;
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
fn models_name(row: &Row, trial: &Trial, results: &Results) -> String {
    let earlier = &results.scenario.rows[..trial.row];
    let is_later = earlier.iter().any(|other| other.label == row.label && other.start == row.start);
    let duration = if is_later { format!("-{}s", row.duration_s) } else { String::new() };
    format!("{}-{}-{}{duration}.toml", row.label, row.start.map_or("none", Start::name), trial.case.name())
}

/// `trials.csv`.
#[must_use]
pub fn trials(results: &Results) -> String {
    let is_recorded = matches!(results.scenario.origin, Origin::Recorded(_));
    let mut text = String::from(
        "scenario,learner,starting_model,seed,duration_s,converged,sensor_rmse_mm,action_rmse_mm_per_s,scale_ratio",
    );
    if is_recorded {
        text.push_str(",window_start_s,overlapping");
    }
    text.push_str(
        ",floor_sensor_rmse_mm,floor_action_rmse_mm_per_s,sensor_r2,action_r2,sensor_scale,action_scale,sensor_degree,action_degree,\
         iterations,\
         verdict,reason\n",
    );
    for (record, trial) in results.trials() {
        let row = &results.scenario.rows[trial.row];
        let mut fields = vec![
            results.scenario.name.clone(),
            row.label.clone(),
            row.start.map_or("", Start::name).to_owned(),
            trial.case.seed.to_string(),
            number(row.duration_s),
            (trial.ending == Ending::Converged).to_string(),
        ];
        let scores = &trial.scores;
        fields.extend([millimetres(scores.sensor_rmse_m), millimetres(scores.action_rmse_m_per_s)]);
        fields.push(optional(scores.scale_ratio()));
        if is_recorded {
            fields.push(optional(trial.case.window.map(|window| window.start_s)));
            fields.push(trial.case.window.is_some_and(|window| window.overlapping).to_string());
        }
        let floor = floor(record);
        fields.extend([millimetres(floor.sensor_rmse_m), millimetres(floor.action_rmse_m_per_s)]);
        let rest = [scores.sensor_r2, scores.action_r2, scores.sensor_scale, scores.action_scale];
        fields.extend(rest.map(optional));
        fields
            .extend([trial.sensor_degree, trial.action_degree].map(|n| n.map_or_else(String::new, |n| n.to_string())));
        fields.push(trial.iterations.map_or_else(String::new, |n| n.to_string()));
        fields.extend([trial.ending.name().to_owned(), quoted(&trial.reason)]);
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}

/// Errors of the best models of the published degrees, of one case.
#[must_use]
pub fn floor(record: &Record) -> Scores {
    record.references.iter().find(|reference| reference.name == "floor").map_or_else(Scores::default, |it| it.scores)
}

/// `timings.csv`: wall-clock seconds, which no other file holds.
#[must_use]
pub fn timings(results: &Results) -> String {
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
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
