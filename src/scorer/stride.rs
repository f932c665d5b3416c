//! How far the models of section 4.4.3 of Stronger (2008) are from the truth.
//!
//! Along a line the learner's unit of length is its own. The action model is scored as `k A(c)` with the
//! `k` that fits the true speeds best, the sensor model as `f(a + b d)` with the `a` and `b` that fit the
//! mean heights at the true distances best; the two agree on the unit if `|k| |b|` is 1.

use asami_dataset::{ActionModel, Models, SensorModel, Survey};
use asami_math::polynomial::Polynomial;
use asami_math::regression::least_squares;
use serde::{Deserialize, Serialize};

use super::{finite, mean, range, rmse_and_r2, square};

/// Errors of learned models after scaling, and the scales. What does not exist is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Root mean square of `k A(c) - v`.
    pub action_rmse_m_per_s: Option<f64>,
    /// Share of the speeds' variance that `k A(c)` explains.
    pub action_r2: Option<f64>,
    /// `k`: metres to a unit of the learner's.
    pub action_scale: Option<f64>,
    /// Root mean square of `f(a + b d)` less the mean height at `d`.
    pub sensor_rmse_px: Option<f64>,
    /// Share of the mean heights' variance that `f(a + b d)` explains.
    pub sensor_r2: Option<f64>,
    /// `a`, in units of the learner's.
    pub sensor_offset: Option<f64>,
    /// `b`: units of the learner's to a metre.
    pub sensor_scale: Option<f64>,
}

impl Scores {
    /// `|k| |b|`: 1 if both models have one unit of length.
    #[must_use]
    pub fn scale_ratio(&self) -> Option<f64> {
        finite((self.action_scale? * self.sensor_scale?).abs())
    }
}

/// Truth of one era.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Yardstick {
    /// Ids of the strides and their true speeds.
    pub speeds: Vec<(u16, f64)>,
    /// Distances in metres and mean heights in pixels.
    pub heights: Vec<[f64; 2]>,
}

/// Speeds this near to each other are of the same command.
const SAME_M_PER_S: f64 = 1e-6;

impl Yardstick {
    /// The surveyed heights, and the surveyed speeds of `strides`: ids and commanded speeds.
    #[must_use]
    pub fn surveyed(survey: &Survey, strides: &[(u16, f64)]) -> Self {
        let speed = |(id, command_m_per_s): &(u16, f64)| {
            let surveyed = survey.speed_by_command.iter();
            let mut same = surveyed.filter(|speed| (speed.command_m_per_s - command_m_per_s).abs() < SAME_M_PER_S);
            same.next().map(|speed| (*id, speed.speed_m_per_s))
        };
        Self {
            speeds: strides.iter().filter_map(speed).collect(),
            heights: survey.height_by_distance.iter().map(|height| [height.distance_m, height.height_px]).collect(),
        }
    }

    /// Greatest less least true speed: what an error is a percentage of.
    #[must_use]
    pub fn speed_range_m_per_s(&self) -> Option<f64> {
        range(self.speeds.iter().map(|(_, speed)| *speed))
    }

    /// Greatest less least mean height.
    #[must_use]
    pub fn height_range_px(&self) -> Option<f64> {
        range(self.heights.iter().map(|[_, height]| *height))
    }

    /// Scores models.
    #[must_use]
    pub fn score(&self, models: &Models) -> Scores {
        let mut scores = Scores::default();
        if let Some(action @ ActionModel::Table(_)) = &models.action {
            self.score_action(action, &mut scores);
        }
        if let Some(SensorModel::HeightOfDistance(curve)) = &models.sensor {
            self.score_sensor(&curve.polynomial, &mut scores);
        }
        scores
    }

    fn score_action(&self, model: &ActionModel, scores: &mut Scores) {
        let ActionModel::Table(entries) = model else { return };
        let learned = |id: u16| entries.iter().find(|entry| entry.action == id).map_or(0.0, |entry| entry.vy_m_per_s);
        let points: Vec<[f64; 2]> = self.speeds.iter().map(|(id, v)| [learned(*id), *v]).collect();
        let k = mean(points.iter().map(|[a, v]| a * v)) / mean(points.iter().map(|[a, _]| a * a));
        let scaled: Vec<[f64; 2]> = points.iter().map(|[a, v]| [k * a, *v]).collect();
        if let Some((rmse, r2)) = rmse_and_r2(&scaled) {
            (scores.action_rmse_m_per_s, scores.action_r2, scores.action_scale) = (Some(rmse), r2, finite(k));
        }
    }

    fn score_sensor(&self, f: &Polynomial, scores: &mut Scores) {
        let Some([a, b]) = alignment(f, &self.heights) else { return };
        let pairs: Vec<[f64; 2]> = self.heights.iter().map(|[d, height]| [f.at(a + b * d), *height]).collect();
        if let Some((rmse, r2)) = rmse_and_r2(&pairs) {
            (scores.sensor_rmse_px, scores.sensor_r2) = (Some(rmse), r2);
            (scores.sensor_offset, scores.sensor_scale) = (finite(a), finite(b));
        }
    }

    /// The rules of divergence that `models` with `scores` break.
    #[must_use]
    pub fn faults(&self, models: &Models, scores: &Scores, r2_min: f64) -> Vec<String> {
        let parts = [
            ("action", models.action.is_some() && !self.speeds.is_empty(), scores.action_r2),
            ("sensor", models.sensor.is_some() && !self.heights.is_empty(), scores.sensor_r2),
        ];
        let fault = |(name, is_measured, r2): (&str, bool, Option<f64>)| match r2 {
            Some(r2) if r2 < r2_min => Some(format!("{name} R^2 {r2:.3} < {r2_min}")),
            None if is_measured => Some(format!("{name} model is not finite or does not vary")),
            _ => None,
        };
        parts.into_iter().filter_map(fault).collect()
    }

    /// The polynomial of the distance that fits the mean heights best.
    #[must_use]
    pub fn best_sensor(&self, degree: usize) -> Option<SensorModel> {
        if self.heights.len() <= degree {
            return None;
        }
        let points = self.heights.iter().map(|[d, height]| (*d, *height));
        Polynomial::fit(points, degree, 2.4, 1.2).map(|(f, _)| SensorModel::HeightOfDistance(f.into()))
    }
}

/// `a` and `b` of the `f(a + b d)` that is nearest to the heights, by Gauss and Newton from several
/// starts: f is a polynomial and may turn.
fn alignment(f: &Polynomial, heights: &[[f64; 2]]) -> Option<[f64; 2]> {
    let [first, last] = [heights.first()?[0], heights.last()?[0]];
    let loss = |[a, b]: [f64; 2]| mean(heights.iter().map(|[d, height]| square(f.at(a + b * d) - height)));
    // The learner's unit is some metres, either way round.
    let scales = [1.0, 0.5, 2.0, 0.25, 4.0, 0.1, 10.0, -1.0, -0.5, -2.0];
    let centre = f.centre;
    let starts = scales.into_iter().flat_map(|b| [[0.0, b], [centre - b * 0.5 * (first + last), b]]);
    let settled = starts.map(|start| settle(f, heights, start, &loss)).filter(|at| loss(*at).is_finite());
    settled.min_by(|one, other| loss(*one).total_cmp(&loss(*other)))
}

/// Gauss and Newton's steps, halved as long as they lead up.
fn settle(f: &Polynomial, heights: &[[f64; 2]], start: [f64; 2], loss: &impl Fn([f64; 2]) -> f64) -> [f64; 2] {
    let mut at = start;
    for _ in 0..100 {
        let rows = heights.iter().map(|[d, height]| {
            let x = at[0] + at[1] * d;
            let slope = f.slope_at(x);
            (vec![slope, slope * d], height - f.at(x))
        });
        let Some(step) = least_squares(2, rows).solve().map(|fit| fit.coefficients) else { break };
        let along = |share: f64| [at[0] + share * step[0], at[1] + share * step[1]];
        let shares = std::iter::successors(Some(1.0), |share| Some(0.5 * share)).take(30);
        let Some(next) = shares.map(along).find(|next| loss(*next) < loss(at)) else { break };
        let moved = (next[0] - at[0]).abs() + (next[1] - at[1]).abs();
        at = next;
        if moved < 1e-12 {
            break;
        }
    }
    at
}

#[cfg(test)]
mod tests;
