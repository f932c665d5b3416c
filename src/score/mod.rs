//! Learned models against a data set's truth, as a small table.

mod line;
mod plane;
mod stride;

use asami_dataset::{Action, ActionModel, Dataset, Log, Models, SensorModel};

/// A data set without truth about either model.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct NotScored(String);

/// The score of `models` on `log`, a part of `dataset`'s, as text: after chapter 3's scaling; or as they are,
/// of chapter 4's models in the plane; or after section 4.4.3's scaling, where the data set's robot was surveyed
/// along a line.
///
/// # Errors
/// [`NotScored`] where the data set has no truth about the models, or the models are of kinds that its
/// truth does not measure.
pub fn table(learner: &str, models: &Models, log: &Log, dataset: &Dataset) -> Result<String, NotScored> {
    let of_chapter_4 = matches!(models.action, Some(ActionModel::Table(_)))
        || matches!(models.sensor, Some(SensorModel::HeightOfDistance(_) | SensorModel::RangeOfDistance(_)));
    let survey = dataset.truth.survey.as_ref();
    let along_a_line = survey.is_some_and(|it| it.velocity_by_action.is_empty() && !it.speed_by_command.is_empty());
    match (of_chapter_4, along_a_line) {
        (false, _) => line::table(learner, models, log, dataset),
        (true, false) => plane::table(learner, models, log, dataset),
        (true, true) => stride::table(learner, models, &strides(log), dataset),
    }
}

/// Ids and forward speeds of the actions that were commanded.
fn strides(log: &Log) -> Vec<(u16, f64)> {
    let id = |action: &Action| match *action {
        Action::Legs { id, .. } | Action::Wheels { id, .. } => id,
        Action::Pedals { .. } => None,
    };
    let mut strides: Vec<(u16, f64)> = Vec::new();
    for command in log.commands.iter() {
        let Some(stride) = id(&command.action).zip(command.action.forward_m_per_s()) else { continue };
        if !strides.iter().any(|(id, _)| *id == stride.0) {
            strides.push(stride);
        }
    }
    strides
}

/// A line of a table: name, error with so many digits, unit, range and R^2; nothing without an error.
fn row(name: &str, error: Option<f64>, digits: usize, unit: &str, range: Option<f64>, r2: Option<f64>) -> String {
    if error.is_none() {
        return String::new();
    }
    let shown = |value: Option<f64>, digits: usize| value.map_or(String::new(), |value| format!("{value:.digits$}"));
    let percent = error.zip(range).map(|(error, range)| 100.0 * error / range);
    let (error, percent, r2) = (shown(error, digits), shown(percent, 2), shown(r2, 4));
    format!("{name:<10}{error:>10}  {unit:<6}{percent:>11}{r2:>9}\n")
}

const HEADS: &str = "model           RMSE          % of range      R^2\n";

fn verdict(learner: &str, faults: &[String]) -> String {
    match faults {
        [] => format!("{learner}: converged\n"),
        _ => format!("{learner}: diverged: {}\n", faults.join("; ")),
    }
}
