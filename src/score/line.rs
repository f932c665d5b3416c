//! Chapter 3's models, after scaling.

use std::fmt::Write;

use asami_dataset::{ActionModel, Dataset, Log, Models, SensorModel};

use super::NotScored;
use crate::scenario::Divergence;
use crate::scorer::line::{Scores, Yardstick};

/// One part of the models with its score.
struct Line {
    name: &'static str,
    unit: &'static str,
    error: Option<f64>,
    range: Option<f64>,
    floor: Option<f64>,
    degree: Option<usize>,
    r2: Option<f64>,
    scale: Option<f64>,
}

/// As [`table`](super::table).
pub(super) fn table(learner: &str, models: &Models, log: &Log, dataset: &Dataset) -> Result<String, NotScored> {
    let yardstick = Yardstick::of(log, &dataset.truth);
    if yardstick.sensor.is_empty() && yardstick.action.is_empty() {
        let message = "the data set has no truth about the models: neither speeds and heights in survey.toml \
                       nor a truth.csv that covers the log";
        return Err(NotScored(message.to_owned()));
    }
    let scores = yardstick.score(models);
    let lines = [sensor(models, &yardstick, &scores), action(models, &yardstick, &scores)];
    if lines.iter().all(|line| line.error.is_none()) {
        let message = "nothing to score: models.toml has neither a sensor model of kind distance_of_height nor an \
                       action model of forward speed that the data set's truth measures";
        return Err(NotScored(message.to_owned()));
    }
    let faults = yardstick.faults(models, &scores, Divergence::default().r2_min);
    Ok(text(learner, &lines, &scores, &faults))
}

fn sensor(models: &Models, yardstick: &Yardstick, scores: &Scores) -> Line {
    let degree = match &models.sensor {
        Some(SensorModel::DistanceOfHeight(curve)) => Some(curve.polynomial.degree()),
        _ => None,
    };
    let best = Models { sensor: degree.and_then(|degree| yardstick.best_sensor(degree)), ..Models::default() };
    Line {
        name: "sensor",
        unit: "mm",
        error: scores.sensor_rmse_m,
        range: yardstick.distance_range_m(),
        floor: yardstick.score(&best).sensor_rmse_m,
        degree,
        r2: scores.sensor_r2,
        scale: scores.sensor_scale,
    }
}

fn action(models: &Models, yardstick: &Yardstick, scores: &Scores) -> Line {
    let degree = match &models.action {
        Some(ActionModel::Polynomial(curve)) => Some(curve.polynomial.degree()),
        _ => None,
    };
    let best = Models { action: degree.and_then(|degree| yardstick.best_action(degree)), ..Models::default() };
    Line {
        name: "action",
        unit: "mm/s",
        error: scores.action_rmse_m_per_s,
        range: yardstick.speed_range_m_per_s(),
        floor: yardstick.score(&best).action_rmse_m_per_s,
        degree,
        r2: scores.action_r2,
        scale: scores.action_scale,
    }
}

fn text(learner: &str, lines: &[Line], scores: &Scores, faults: &[String]) -> String {
    let shown = |value: Option<f64>, digits: usize| value.map_or(String::new(), |value| format!("{value:.digits$}"));
    let mut text = format!(
        "{:<8}{:>10}  {:<6}{:>11}{:>16}{:>9}{:>12}\n",
        "model", "RMSE", "", "% of range", "floor", "R^2", "scale"
    );
    for line in lines {
        let floor = line.floor.zip(line.degree);
        let floor = floor.map_or(String::new(), |(floor, degree)| format!("{:.1} (deg {degree})", floor * 1e3));
        let percent = line.error.zip(line.range).map(|(error, range)| 100.0 * error / range);
        let _ = writeln!(
            text,
            "{:<8}{:>10}  {:<6}{:>11}{:>16}{:>9}{:>12}",
            line.name,
            shown(line.error.map(|error| error * 1e3), 1),
            line.unit,
            shown(percent, 2),
            floor,
            shown(line.r2, 4),
            shown(line.scale, 5),
        );
    }
    let _ = writeln!(text, "scale ratio |k| / |b|: {}", shown(scores.scale_ratio(), 3));
    let verdict = if faults.is_empty() { "converged".to_owned() } else { format!("diverged: {}", faults.join("; ")) };
    let _ = writeln!(text, "{learner}: {verdict}");
    text
}
