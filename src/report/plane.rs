//! Figures 4.2 to 4.5 of Stronger (2008) on a sweep's results, and learning curves of all learners.

use asami_dataset::{SensorModel, store};
use asami_learners::line::Unit;
use asami_math::polynomial::Polynomial;

use crate::draw::Figure;
use crate::draw::chapter4::{self, Sensors};
use crate::scenario::{Origin, Robot, Start};
use crate::scorer::plane::Scores;
use crate::sweep::Results;
use crate::sweep::plane::InPlane;
use crate::trial::{self, CurvePoint};

type Trial = trial::Trial<Scores>;

/// Height of a beacon of 200 mm times its distance, by the camera's data (section 2.5.1), px m.
const ANALYTIC_PX_M: f64 = 38.3887;

/// Names of the figures: of the dissertation's robot, or of its simulation.
struct Names {
    likelihood: &'static str,
    errors: &'static str,
    sensors: &'static str,
}

const WALKED: Names = Names { likelihood: "Figure 4.2", errors: "Velocity errors", sensors: "Figure 4.3" };
const SIMULATED: Names = Names { likelihood: "Figure 4.4a", errors: "Figure 4.4b", sensors: "Figure 4.5" };
const OTHERS: Names = Names { likelihood: "Log-likelihood", errors: "Velocity errors", sensors: "Sensor functions" };

/// The figures of the published learner on the first log, then the learning curves of all.
#[must_use]
pub fn figures(results: &Results<InPlane>) -> Vec<Figure> {
    let names = match &results.scenario.origin {
        Origin::Simulated(simulation) => match simulation.robot {
            Robot::Aibo => WALKED,
            Robot::Plain => SIMULATED,
            Robot::Create | Robot::Car => OTHERS,
        },
        Origin::Recorded(_) => OTHERS,
    };
    let mut figures = Vec::new();
    if let Some(trial) = first(results, "em_published") {
        figures.push(chapter4::likelihood(names.likelihood, &over(trial, |point| point.log_likelihood)));
        let error = |i: usize| over(trial, move |point| Some(point.scores.velocity_rmse?[i]));
        figures.push(chapter4::velocity_errors(names.errors, &error(0), &error(1)));
        figures.extend(sensors(results, trial, names.sensors));
    }
    figures.extend(curves(results));
    figures
}

/// The trial of a learner from the published start on the first log.
fn first<'a>(results: &'a Results<InPlane>, label: &str) -> Option<&'a Trial> {
    let rows = &results.scenario.rows;
    let row = rows.iter().position(|row| row.label == label && row.start == Some(Start::Published))?;
    results.records.first()?.trials.get(row).filter(|trial| !trial.curve.is_empty())
}

fn over(trial: &Trial, of: impl Fn(&CurvePoint<Scores>) -> Option<f64>) -> Vec<[f64; 2]> {
    trial.curve.iter().filter_map(|point| Some([point.step as f64, of(point)?])).collect()
}

fn polynomial(sensor: &SensorModel) -> Option<&Polynomial> {
    match sensor {
        SensorModel::HeightOfDistance(curve) | SensorModel::RangeOfDistance(curve) => Some(&curve.polynomial),
        _ => None,
    }
}

fn sensors(results: &Results<InPlane>, trial: &Trial, name: &str) -> Option<Figure> {
    let truth = &results.records.first()?.truth;
    let (unit, unit_name, factor) =
        if truth.in_metres { (Unit::RangeM, "mm", 1e3) } else { (Unit::HeightPx, "px", 1.0) };
    let starting = results.scenario.starting.sensor(Start::Published, unit);
    let starting = polynomial(&starting)?;
    let models = store::parse_models(trial.models.clone()?).ok()?.1;
    let learned = polynomial(models.sensor.as_ref()?)?;
    let heights = results.survey.iter().flat_map(|survey| &survey.height_by_distance);
    let measured: Vec<[f64; 2]> = heights.map(|height| [height.distance_m, height.height_px]).collect();
    let analytic: (_, &dyn Fn(f64) -> f64) = match unit {
        Unit::HeightPx => ("by the camera's data", &|d| ANALYTIC_PX_M / d),
        Unit::RangeM => ("true distance", &|d| 1e3 * d),
    };
    let of = Sensors {
        starting: &|d| factor * starting.at(d),
        learned: &|d| factor * learned.at(d),
        analytic,
        measured: &measured,
    };
    Some(chapter4::sensors(name, unit_name, &of))
}

/// Learning curves of every row that starts as published.
fn curves(results: &Results<InPlane>) -> Vec<Figure> {
    let mut labels: Vec<&str> = Vec::new();
    for row in results.scenario.rows.iter().filter(|row| row.start == Some(Start::Published)) {
        if !labels.contains(&&*row.label) {
            labels.push(&row.label);
        }
    }
    let all = |of: fn(&CurvePoint<Scores>) -> Option<f64>| -> Vec<(String, Vec<[f64; 2]>)> {
        let curve = |label: &&str| Some(((*label).to_owned(), over(first(results, label)?, of)));
        labels.iter().filter_map(curve).filter(|(_, points)| points.len() > 1).collect()
    };
    let figures = [
        (
            "Learning curves, v_x",
            "Error of v_x",
            "RMS error",
            "mm/s",
            all(|it| Some(1e3 * it.scores.velocity_rmse?[0])),
        ),
        (
            "Learning curves, v_y",
            "Error of v_y",
            "RMS error",
            "mm/s",
            all(|it| Some(1e3 * it.scores.velocity_rmse?[1])),
        ),
        (
            "Learning curves, v_theta",
            "Error of v_theta",
            "RMS error",
            "rad/s",
            all(|it| Some(it.scores.velocity_rmse?[2])),
        ),
    ];
    let figures = figures.into_iter().filter(|(.., curves)| !curves.is_empty());
    figures
        .map(|(name, title, label, unit, curves)| chapter4::learning_curves(name, title, (label, unit), &curves))
        .collect()
}
