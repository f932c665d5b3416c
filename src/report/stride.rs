//! Figures 4.6 and 4.7 of Stronger (2008) on a sweep's results.

use asami_dataset::{ActionModel, Models, SensorModel, Survey, store};

use crate::draw::Figure;
use crate::draw::chapter4;
use crate::scenario::{Era, Origin, Start};
use crate::scorer::stride::Scores;
use crate::sweep::Results;
use crate::sweep::stride::{ByEra, Strides};
use crate::trial;

type Trial = trial::Trial<ByEra<Scores>>;

/// The published learner's models of the first log, each against the truth of its own era.
#[must_use]
pub fn figures(results: &Results<Strides>) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (era, survey, name, when) in [
        (Era::Before, &results.survey, "Figure 4.6b", "as learned"),
        (Era::After, &results.changed, "Figure 4.7", "as relearned after the change"),
    ] {
        let Some((trial, survey)) = first(results, era).zip(survey.as_ref()) else { continue };
        let models = trial.models.clone().and_then(|text| store::parse_models(text).ok());
        let Some(((_, models), scores)) = models.zip(trial.scores.of(era)) else { continue };
        if era == Era::Before {
            figures.extend(sensor(&models, scores, survey));
        }
        figures.extend(actions(results, &models, scores, survey).map(|speeds| chapter4::strides(name, when, &speeds)));
    }
    figures
}

fn first(results: &Results<Strides>, era: Era) -> Option<&Trial> {
    let rows = &results.scenario.rows;
    let is_published = |row: &crate::scenario::Row| row.start == Some(Start::Published) && row.era == era;
    results.records.first()?.trials.get(rows.iter().position(is_published)?)
}

fn sensor(models: &Models, scores: &Scores, survey: &Survey) -> Option<Figure> {
    let Some(SensorModel::HeightOfDistance(curve)) = &models.sensor else { return None };
    let (a, b) = (scores.sensor_offset?, scores.sensor_scale?);
    let heights = survey.height_by_distance.iter();
    let measured: Vec<[f64; 2]> = heights.map(|height| [height.distance_m, height.height_px]).collect();
    Some(chapter4::figure_4_6a(&measured, |d| curve.polynomial.at(a + b * d)))
}

/// Command, true speed and learned speed of each stride.
fn actions(results: &Results<Strides>, models: &Models, scores: &Scores, survey: &Survey) -> Option<Vec<[f64; 3]>> {
    let Origin::Simulated(simulation) = &results.scenario.origin else { return None };
    let (Some(ActionModel::Table(entries)), Some(k)) = (&models.action, scores.action_scale) else { return None };
    let row = |(id, action): (u16, asami_dataset::Action)| {
        let command = action.forward_m_per_s()?;
        let speeds = survey.speed_by_command.iter();
        let truth = speeds
            .min_by(|a, b| (a.command_m_per_s - command).abs().total_cmp(&(b.command_m_per_s - command).abs()))?;
        let learned = entries.iter().find(|entry| entry.action == id)?;
        Some([command, truth.speed_m_per_s, k * learned.vy_m_per_s])
    };
    Some((0..).zip(simulation.suite.strides()).filter_map(row).collect())
}
