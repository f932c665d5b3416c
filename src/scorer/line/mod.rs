//! How far learned models are from the truth, as Stronger (2008), section 3.3.2, measures it.
//!
//! Learned models have units of their own. The action model is scored as `k A(c)` with the `k` that
//! fits the true speeds best, the sensor model as `a + b S(o)` with the `a` and `b` that fit the true
//! distances best; the two agree on the unit if `|k| / |b|` is 1.
//!
//! **Signs.** Chapter 3's `S(o)` is a place along the walk, on the axis on which a positive speed
//! leads forward (eq. 3.1: `S(o_t) = w_0 + sum A(c) dt`). Walking forward brings the robot nearer, so
//! in true units `k` and `b` have opposite signs. Where they have the same sign, one model takes for
//! towards the beacon what the other takes for away from it: [`Scores::are_opposed`].

mod track;

use asami_dataset::{ActionModel, Log, Models, SensorModel, Survey, TruePose, Truth};
use asami_math::polynomial::{Polynomial, powers};
use asami_math::regression::least_squares;
use serde::{Deserialize, Serialize};

use super::{finite, mean, range, square};

/// Errors of learned models after scaling, and the scales. What does not exist is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Root mean square of `a + b S(o) - d`.
    pub sensor_rmse_m: Option<f64>,
    /// Share of the distances' variance that `a + b S(o)` explains.
    pub sensor_r2: Option<f64>,
    /// `a`, in metres.
    pub sensor_offset_m: Option<f64>,
    /// `b`: metres to a unit of the learner's.
    pub sensor_scale: Option<f64>,
    /// Root mean square of `k A(c) - v`.
    pub action_rmse_m_per_s: Option<f64>,
    /// Share of the speeds' variance that `k A(c)` explains.
    pub action_r2: Option<f64>,
    /// `k`: metres to a unit of the learner's.
    pub action_scale: Option<f64>,
}

impl Scores {
    /// `|k| / |b|`: 1 if both models have one unit of length.
    #[must_use]
    pub fn scale_ratio(&self) -> Option<f64> {
        finite((self.action_scale? / self.sensor_scale?).abs())
    }

    /// Whether the models contradict each other: a positive speed is towards the beacon, so `k` and
    /// `b` agree where their signs do not.
    #[must_use]
    pub fn are_opposed(&self) -> bool {
        matches!((self.action_scale, self.sensor_scale), (Some(k), Some(b)) if k * b > 0.0)
    }
}

/// Truth to score against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Yardstick {
    /// Observations (px or m) and true distances in metres.
    pub sensor: Vec<[f64; 2]>,
    /// Commands and true forward speeds.
    pub action: Vec<Stretch>,
}

/// A stretch of time with its true mean forward speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Commanded forward speed in m/s, and for which share of the time.
    pub commands: Vec<[f64; 2]>,
    /// True mean forward speed.
    pub speed_m_per_s: f64,
}

impl Yardstick {
    /// The survey, as far as it goes; what it does not measure, from the true track under the log
    /// (see [`Yardstick::tracked`]).
    #[must_use]
    pub fn of(log: &Log, truth: &Truth) -> Self {
        let surveyed = truth.survey.as_ref().map(Self::surveyed).unwrap_or_default();
        let sensor = match surveyed.sensor.is_empty() {
            true => track::distances(log, &truth.track),
            false => surveyed.sensor,
        };
        let action = match surveyed.action.is_empty() {
            true => track::stretches(log, &truth.track),
            false => surveyed.action,
        };
        Self { sensor, action }
    }

    /// Truth out of where the robot was. Every sighting counts, with the true distance from the
    /// body's centre to the landmark at its time; and every whole stretch of 5 s, with the true mean
    /// forward speed over it and the commands that were in force. Stretches of that length keep the
    /// noise of commands that are themselves measured, and the clocks' disagreement, out of the score.
    #[must_use]
    pub fn tracked(log: &Log, track: &[TruePose]) -> Self {
        Self { sensor: track::distances(log, track), action: track::stretches(log, track) }
    }

    /// Every surveyed command and distance counts the same (section 3.3.2).
    #[must_use]
    pub fn surveyed(survey: &Survey) -> Self {
        let speed = |speed: &asami_dataset::survey::Speed| Stretch {
            commands: vec![[speed.command_m_per_s, 1.0]],
            speed_m_per_s: speed.speed_m_per_s,
        };
        Self {
            sensor: survey.height_by_distance.iter().map(|height| [height.height_px, height.distance_m]).collect(),
            action: survey.speed_by_command.iter().map(speed).collect(),
        }
    }

    /// Greatest less least true distance: what an error is a percentage of.
    #[must_use]
    pub fn distance_range_m(&self) -> Option<f64> {
        range(self.sensor.iter().map(|[_, d]| *d))
    }

    /// Greatest less least true speed: what an error is a percentage of.
    #[must_use]
    pub fn speed_range_m_per_s(&self) -> Option<f64> {
        range(self.action.iter().map(|stretch| stretch.speed_m_per_s))
    }

    /// Scores models; a model of a kind that this yardstick does not measure is passed over.
    #[must_use]
    pub fn score(&self, models: &Models) -> Scores {
        let mut scores = Scores::default();
        if let Some(SensorModel::DistanceOfHeight(curve)) = &models.sensor {
            self.score_sensor(&curve.polynomial, &mut scores);
        }
        if let Some(action) = &models.action {
            self.score_action(action, &mut scores);
        }
        scores
    }

    /// The rules of divergence that `models` with `scores` break, the same for every learner: a model's
    /// R^2 below `r2_min`, a model that has no score though there is truth about it, scales of opposite
    /// sense.
    #[must_use]
    pub fn faults(&self, models: &Models, scores: &Scores, r2_min: f64) -> Vec<String> {
        let parts = [
            ("sensor", models.sensor.is_some() && !self.sensor.is_empty(), scores.sensor_r2),
            ("action", models.action.is_some() && !self.action.is_empty(), scores.action_r2),
        ];
        let mut faults = Vec::new();
        for (name, is_measured, r2) in parts {
            match r2 {
                Some(r2) if r2 < r2_min => faults.push(format!("{name} R^2 {r2:.3} < {r2_min}")),
                None if is_measured => faults.push(format!("{name} model is not finite or does not vary")),
                _ => {}
            }
        }
        if scores.are_opposed() {
            let opposed = "one model takes for towards the beacon what the other takes for away from it \
                           (scales of opposite sign)";
            faults.push(opposed.to_owned());
        }
        faults
    }

    fn score_sensor(&self, distance_of: &Polynomial, scores: &mut Scores) {
        let points: Vec<[f64; 2]> = self.sensor.iter().map(|[o, d]| [distance_of.at(*o), *d]).collect();
        let Some(fit) = least_squares(2, points.iter().map(|[s, d]| (vec![1.0, *s], *d))).solve() else { return };
        let (a, b) = (fit.coefficients[0], fit.coefficients[1]);
        let mean_m = mean(points.iter().map(|[_, d]| *d));
        let rest = mean(points.iter().map(|[s, d]| square(a + b * s - d)));
        scores.sensor_rmse_m = finite(rest.sqrt());
        scores.sensor_r2 = finite(1.0 - rest / mean(points.iter().map(|[_, d]| square(d - mean_m))));
        scores.sensor_offset_m = finite(a);
        scores.sensor_scale = finite(b);
    }

    fn score_action(&self, model: &ActionModel, scores: &mut Scores) {
        let at = |stretch: &Stretch| -> Option<f64> {
            stretch.commands.iter().try_fold(0.0, |sum, [c, share]| Some(sum + share * model.forward_at(*c)?))
        };
        let points: Option<Vec<[f64; 2]>> =
            self.action.iter().map(|stretch| Some([at(stretch)?, stretch.speed_m_per_s])).collect();
        let Some(points) = points.filter(|points| !points.is_empty()) else { return };
        let k = mean(points.iter().map(|[a, v]| a * v)) / mean(points.iter().map(|[a, _]| a * a));
        let rest = mean(points.iter().map(|[a, v]| square(k * a - v)));
        scores.action_rmse_m_per_s = finite(rest.sqrt());
        let mean_m_per_s = mean(points.iter().map(|[_, v]| *v));
        scores.action_r2 = finite(1.0 - rest / mean(points.iter().map(|[_, v]| square(v - mean_m_per_s))));
        scores.action_scale = finite(k);
    }

    /// The polynomial of the observation that fits the true distances best.
    #[must_use]
    pub fn best_sensor(&self, degree: usize) -> Option<SensorModel> {
        let blank = spanning(degree, self.sensor.iter().map(|[o, _]| *o))?;
        let rows = self.sensor.iter().map(|[o, d]| (powers(blank.scaled(*o), degree), *d));
        let coefficients = least_squares(degree + 1, rows).solve()?.coefficients;
        Some(SensorModel::DistanceOfHeight(Polynomial { coefficients, ..blank }.into()))
    }

    /// The polynomial of the command that fits the true speeds best.
    #[must_use]
    pub fn best_action(&self, degree: usize) -> Option<ActionModel> {
        let blank = spanning(degree, self.action.iter().flat_map(|stretch| &stretch.commands).map(|[c, _]| *c))?;
        let rows = self.action.iter().map(|stretch| {
            let mut row = vec![0.0; degree + 1];
            for [c, share] in &stretch.commands {
                for (sum, power) in row.iter_mut().zip(powers(blank.scaled(*c), degree)) {
                    *sum += share * power;
                }
            }
            (row, stretch.speed_m_per_s)
        });
        let coefficients = least_squares(degree + 1, rows).solve()?.coefficients;
        Some(ActionModel::Polynomial(Polynomial { coefficients, ..blank }.into()))
    }
}

/// A polynomial without coefficients whose scaled argument spans -1 to 1; `None` if there are too
/// few distinct arguments for the degree to make sense.
fn spanning(degree: usize, arguments: impl Iterator<Item = f64> + Clone) -> Option<Polynomial> {
    let least = arguments.clone().fold(f64::INFINITY, f64::min);
    let greatest = arguments.clone().fold(f64::NEG_INFINITY, f64::max);
    let (centre, scale) = ((least + greatest) / 2.0, (greatest - least) / 2.0);
    (arguments.count() > degree && scale > 0.0).then(|| Polynomial { coefficients: Vec::new(), centre, scale })
}

#[cfg(test)]
mod tests;
