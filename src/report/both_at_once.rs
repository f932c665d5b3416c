//! Section 3.3.2 of Stronger (2008) on a sweep's results: both models from each other, for Figures 3.7
//! to 3.9.

use asami_dataset::{Models, SensorModel, Survey, store};
use asami_math::statistics;

use crate::draw::Figure;
use crate::draw::chapter3::{self, Learning};
use crate::scorer::line::Scores;
use crate::sweep;
use crate::sweep::line::{Chapter3, rows};
use crate::trial;

type Results = sweep::Results<Chapter3>;
type Trial = trial::Trial<Scores>;

/// The trial of the first log that Figures 3.7 and 3.8 show: Algorithm 1's, in the scenario's first row of it.
#[must_use]
pub fn shown(results: &Results) -> Option<&Trial> {
    let row = results.scenario.rows.iter().position(|row| row.learner == "algorithm1")?;
    results.records.first()?.trials.get(row).filter(|trial| trace(trial, "w_s").is_some())
}

/// Figures 3.7 to 3.9 of the row of [`shown`].
#[must_use]
pub fn figures(results: &Results) -> Vec<Figure> {
    let Some(trial) = shown(results) else { return Vec::new() };
    let mut figures = Vec::new();
    if let (Some(w_a), Some(w_s)) = (trace(trial, "w_a"), trace(trial, "w_s")) {
        figures.push(chapter3::figure_3_7(w_a, w_s));
    }
    let models = trial.models.clone().and_then(|text| store::parse_models(text).ok()).map(|(_, models)| models);
    if let (Some(models), Some(survey)) = (models, &results.survey) {
        figures.extend(learned_action(trial, &models, survey));
        figures.extend(learned_sensor(trial, &models, survey));
    }
    let trials = || results.counted().filter_map(|record| record.trials.get(trial.row));
    let floor = |error: fn(&Scores) -> Option<f64>| {
        statistics::mean(&results.counted().filter_map(|record| error(&rows::floor(record))).collect::<Vec<_>>())
    };
    let curves = |error: fn(&Scores) -> Option<f64>| -> Vec<Vec<[f64; 2]>> {
        let points = |trial: &Trial| {
            let start_s = trial.case.start_s();
            trial.curve.iter().filter_map(|point| Some([point.t_s? - start_s, error(&point.scores)?])).collect()
        };
        trials().map(points).filter(|curve: &Vec<[f64; 2]>| !curve.is_empty()).collect()
    };
    let sensor = chapter3::figure_3_9(Learning::Sensor, &curves(|it| it.sensor_rmse_m), floor(|it| it.sensor_rmse_m));
    let action = chapter3::figure_3_9(
        Learning::Action,
        &curves(|it| it.action_rmse_m_per_s),
        floor(|it| it.action_rmse_m_per_s),
    );
    figures.extend([sensor, action]);
    figures
}

fn trace<'a>(trial: &'a Trial, name: &str) -> Option<&'a [[f64; 2]]> {
    trial.traces.iter().find(|(found, points)| found == name && !points.is_empty()).map(|(_, points)| points.as_slice())
}

fn learned_action(trial: &Trial, models: &Models, survey: &Survey) -> Option<Figure> {
    let (action, k) = (models.action.as_ref()?, trial.scores.action_scale?);
    if survey.speed_by_command.is_empty() {
        return None;
    }
    Some(chapter3::figure_3_8a(&survey.speed_by_command, |c| action.forward_at(c).map_or(f64::NAN, |v| k * v)))
}

fn learned_sensor(trial: &Trial, models: &Models, survey: &Survey) -> Option<Figure> {
    let Some(SensorModel::DistanceOfHeight(curve)) = &models.sensor else { return None };
    if survey.height_by_distance.is_empty() {
        return None;
    }
    let (a, b) = (trial.scores.sensor_offset_m?, trial.scores.sensor_scale?);
    Some(chapter3::figure_3_8b(&survey.height_by_distance, |o| a + b * curve.polynomial.at(o)))
}
