//! Figures 5.3 to 5.5 of Stronger (2008) on a sweep's results.

use asami_dataset::{SensorModel, store};
use asami_math::angle::wrap_rad;

use crate::draw::Figure;
use crate::draw::chapter5;
use crate::scorer::car::Scores;
use crate::sweep::Results;
use crate::sweep::car::{InTraffic, ROLLED};
use crate::trial;

type Trial = trial::Trial<Scores>;

/// Learners whose curves are drawn, if the sweep has them.
const DRAWN: [&str; 2] = ["car_published", "car_best"];

/// Of the first log: the angles that each drawn learner learned, and the motions of their action models.
#[must_use]
pub fn figures(results: &Results<InTraffic>) -> Vec<Figure> {
    let Some(record) = results.records.first() else { return Vec::new() };
    let truth = &record.truth;
    let label = |trial: &Trial| results.scenario.rows.get(trial.row).map_or("", |row| row.label.as_str());
    let drawn: Vec<&Trial> =
        DRAWN.iter().filter_map(|name| record.trials.iter().find(|trial| label(trial) == *name)).collect();
    let mut figures = Vec::new();
    for trial in &drawn {
        let Some(learned) = angles_deg(trial).filter(|learned| learned.len() == truth.angles_rad.len()) else {
            continue;
        };
        let truth_deg: Vec<f64> = truth.angles_rad.iter().map(|angle| wrap_rad(*angle).to_degrees()).collect();
        let name = if label(trial) == DRAWN[0] { "Figure 5.3".to_owned() } else { format!("Angles, {}", label(trial)) };
        figures.push(chapter5::angles(&name, &truth_deg, &learned));
    }
    let motions = [
        ("Figure 5.4", "Speed of the car", ("speed", "m/s"), 1),
        ("Figure 5.5", "Yaw rate of the car", ("yaw rate", "rad/s"), 2),
    ];
    for (name, title, axis, i) in motions {
        let reference: Vec<[f64; 2]> = truth.steps.iter().map(|step| [step[0], step[i]]).collect();
        let curve = |trial: &&Trial| {
            let (_, points) = trial.traces.iter().find(|(name, _)| name == ROLLED[i - 1])?;
            Some((label(trial).to_owned(), points.clone()))
        };
        let curves: Vec<_> = drawn.iter().filter_map(curve).collect();
        if !reference.is_empty() {
            figures.push(chapter5::rolled(name, title, axis, &reference, &curves));
        }
    }
    figures
}

fn angles_deg(trial: &Trial) -> Option<Vec<f64>> {
    let models = store::parse_models(trial.models.clone()?).ok()?.1;
    match models.sensor? {
        SensorModel::Angles { horizontal_angles_rad, .. } => {
            Some(horizontal_angles_rad.iter().map(|angle| wrap_rad(*angle).to_degrees()).collect())
        }
        _ => None,
    }
}
