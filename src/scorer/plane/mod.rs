//! How far the models of chapter 4 are from the truth, as Stronger (2008), sections 4.4.1 and 4.4.2,
//! measures it: as they are, without scaling, since landmarks stand at known places.

pub mod bound;
mod tracked;

use asami_dataset::survey::{Height, Velocity};
use asami_dataset::{ActionModel, Log, Models, Noise, SensorModel, Survey, TruePose, Truth};
use asami_learners::line::Unit;
use asami_math::elementary::hypot;
use asami_math::polynomial::Polynomial;
use serde::{Deserialize, Serialize};

use super::{finite, mean, range, rmse_and_r2, square};
use crate::binning;
use asami_dataset::truth::pose_at;

/// Errors of learned models. What does not exist is `None`. Sizes are in pixels or in metres, as the
/// yardstick's [`unit`](Yardstick::unit) says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Root mean squares over the actions, each counting alike: right and forward in m/s, turn in rad/s.
    pub velocity_rmse: Option<[f64; 3]>,
    /// Share of each direction's variance over the actions that the learned velocities explain.
    pub velocity_r2: Option<[f64; 3]>,
    /// Root mean square of `f(d)` less the mean size at the surveyed distances, each counting alike.
    pub sensor_rmse: Option<f64>,
    /// Share of the mean sizes' variance that `f(d)` explains.
    pub sensor_r2: Option<f64>,
    /// Learned standard deviation of sizes.
    pub sigma1: Option<f64>,
    /// Learned standard deviation of bearings.
    pub sigma2_rad: Option<f64>,
    /// Learned standard deviations of a step's motion: right, forward, turn.
    pub motion_sd: Option<[f64; 3]>,
    /// Velocities with a standard error that lie within 1.96 of them of the truth, and velocities with one.
    pub covered: Option<[u32; 2]>,
    /// Mean normalised innovation squared of a filter with the learned models, by its degrees of freedom: 1
    /// if the models know their own noise.
    pub nis: Option<f64>,
}

/// Truth to score against.
#[derive(Clone, Debug, PartialEq)]
pub struct Yardstick {
    /// What sizes are: heights in pixels or ranges in metres.
    pub unit: Unit,
    /// True velocities, in order of action.
    pub velocities: Vec<Velocity>,
    /// Distance from the body's centre (from the sensor, of ranges) in metres, and mean size there.
    pub sensor: Vec<[f64; 2]>,
    /// True standard deviation of sizes: the distances' variances, weighted by how often each occurred in
    /// the log (section 4.4.1).
    pub sigma1: Option<f64>,
    /// True standard deviation of bearings, likewise.
    pub sigma2_rad: Option<f64>,
    /// The least that an unbiased learner of the velocities can err with this log, where that is worked out
    /// ([`bound::bound`]): right and forward in m/s, turn in rad/s.
    pub bound: Option<[f64; 3]>,
}

impl Yardstick {
    /// The survey, as far as it goes; what it does not measure, from the true track under the log.
    #[must_use]
    pub fn of(log: &Log, truth: &Truth) -> Self {
        let unit = match log.sightings.first().map(|sighting| sighting.size) {
            Some(asami_dataset::Size::RangeM(_)) => Unit::RangeM,
            _ => Unit::HeightPx,
        };
        let surveyed = truth.survey.clone().unwrap_or_default();
        let velocities = match surveyed.velocity_by_action.is_empty() {
            true => binning::velocities(log, &truth.track, 0.0),
            false => surveyed.velocity_by_action.clone(),
        };
        if unit == Unit::HeightPx && !surveyed.height_by_distance.is_empty() {
            let sensor = surveyed.height_by_distance.iter().map(|height| [height.distance_m, height.height_px]);
            let [sigma1, sigma2_rad] = weighted_sds(log, &truth.track, &surveyed);
            let sensor = sensor.collect();
            return Self { unit, velocities, sensor, sigma1, sigma2_rad, bound: None };
        }
        let sensor = tracked::sensor(log, &truth.track);
        let sigma1 = sensor.sigma1.or(match unit {
            Unit::HeightPx => surveyed.sigma1_px,
            Unit::RangeM => surveyed.sigma1_m,
        });
        let sigma2_rad = sensor.sigma2_rad.or(surveyed.sigma2_rad);
        Self { unit, velocities, sensor: sensor.means, sigma1, sigma2_rad, bound: None }
    }

    /// Whether there is truth about anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.velocities.is_empty() && self.sensor.is_empty()
    }

    /// Greatest less least true velocity in each direction: what an error is a percentage of.
    #[must_use]
    pub fn velocity_ranges(&self) -> Option<[f64; 3]> {
        let of = |i: usize| range(self.velocities.iter().map(|velocity| three(velocity)[i]));
        Some([of(0)?, of(1)?, of(2)?])
    }

    /// Greatest less least mean size.
    #[must_use]
    pub fn size_range(&self) -> Option<f64> {
        range(self.sensor.iter().map(|[_, size]| *size))
    }

    /// Scores models; a model of a kind that this yardstick does not measure is passed over. An action
    /// without an entry counts as having no effect.
    #[must_use]
    pub fn score(&self, models: &Models) -> Scores {
        let mut scores = Scores { sigma2_rad: models.noise.sigma2_rad, ..Scores::default() };
        scores.motion_sd = models.noise.motion_sd;
        scores.sigma1 = self.sigma1_of(&models.noise);
        if let Some(ActionModel::Table(entries)) = &models.action {
            let entry = |velocity: &Velocity| entries.iter().find(|entry| entry.action == velocity.action);
            let learned = |velocity: &Velocity| {
                entry(velocity).map_or([0.0; 3], |it| [it.vx_m_per_s, it.vy_m_per_s, it.vtheta_rad_per_s])
            };
            let rows: Vec<_> = self.velocities.iter().map(|velocity| (learned(velocity), three(velocity))).collect();
            let of =
                |i: usize| rmse_and_r2(&rows.iter().map(|(model, truth)| [model[i], truth[i]]).collect::<Vec<_>>());
            if let [Some(x), Some(y), Some(theta)] = [of(0), of(1), of(2)] {
                scores.velocity_rmse = Some([x.0, y.0, theta.0]);
                scores.velocity_r2 = x.1.zip(y.1).zip(theta.1).map(|((x, y), theta)| [x, y, theta]);
            }
            let errors = self.velocities.iter().zip(&rows).filter_map(|(velocity, (model, truth))| {
                let se = entry(velocity)?.se?;
                Some((0..3).map(move |i| (model[i] - truth[i]).abs() <= 1.96 * se[i]).collect::<Vec<_>>())
            });
            let inside: Vec<bool> = errors.flatten().collect();
            if !inside.is_empty() {
                let count = inside.iter().filter(|is_inside| **is_inside).count();
                scores.covered = Some([count as u32, inside.len() as u32]);
            }
        }
        if let Some(f) = self.sensor_of(models) {
            let pairs: Vec<[f64; 2]> = self.sensor.iter().map(|[d, size]| [f.at(*d), *size]).collect();
            if let Some((rmse, r2)) = rmse_and_r2(&pairs) {
                (scores.sensor_rmse, scores.sensor_r2) = (Some(rmse), r2);
            }
        }
        scores
    }

    /// The learned f, if it is of this yardstick's kind.
    fn sensor_of<'a>(&self, models: &'a Models) -> Option<&'a Polynomial> {
        match (&models.sensor, self.unit) {
            (Some(SensorModel::HeightOfDistance(curve)), Unit::HeightPx)
            | (Some(SensorModel::RangeOfDistance(curve)), Unit::RangeM) => Some(&curve.polynomial),
            _ => None,
        }
    }

    fn sigma1_of(&self, noise: &Noise) -> Option<f64> {
        match self.unit {
            Unit::HeightPx => noise.sigma1_px,
            Unit::RangeM => noise.sigma1_m,
        }
    }

    /// The rules of divergence that `models` with `scores` break, the same for every learner: an R^2
    /// below `r2_min`, or none though there is truth about the model. Errors of `v_x` and `v_y` are both held
    /// against the greater variance of the two.
    #[must_use]
    pub fn faults(&self, models: &Models, scores: &Scores, r2_min: f64) -> Vec<String> {
        let mut faults = Vec::new();
        let mut rule = |name: &str, r2: Option<f64>| match r2 {
            Some(r2) if r2 >= r2_min => {}
            Some(r2) => faults.push(format!("{name} R^2 {r2:.3} < {r2_min}")),
            None => faults.push(format!("{name} is not finite")),
        };
        if models.action.is_some() && !self.velocities.is_empty() {
            let variance = |i: usize| {
                let centre = mean(self.velocities.iter().map(|velocity| three(velocity)[i]));
                mean(self.velocities.iter().map(|velocity| square(three(velocity)[i] - centre)))
            };
            // A robot on wheels hardly moves sideways: there is next to no variance of v_x to explain.
            let moved = variance(0).max(variance(1));
            for (i, (name, against)) in
                [("v_x", moved), ("v_y", moved), ("v_theta", variance(2))].into_iter().enumerate()
            {
                rule(name, scores.velocity_rmse.and_then(|rmse| finite(1.0 - square(rmse[i]) / against)));
            }
        }
        if models.sensor.is_some() && !self.sensor.is_empty() {
            rule("f", scores.sensor_r2);
        }
        faults
    }

    /// The polynomial of the distance that fits the mean sizes best.
    #[must_use]
    pub fn best_sensor(&self, degree: usize) -> Option<SensorModel> {
        let span = range(self.sensor.iter().map(|[d, _]| *d)).filter(|span| *span > 0.0)?;
        let least = self.sensor.iter().map(|[d, _]| *d).fold(f64::INFINITY, f64::min);
        if self.sensor.len() <= degree {
            return None;
        }
        let points = self.sensor.iter().map(|[d, size]| (*d, *size));
        let (polynomial, _) = Polynomial::fit(points, degree, least + 0.5 * span, 0.5 * span)?;
        Some(match self.unit {
            Unit::HeightPx => SensorModel::HeightOfDistance(polynomial.into()),
            Unit::RangeM => SensorModel::RangeOfDistance(polynomial.into()),
        })
    }
}

fn three(velocity: &Velocity) -> [f64; 3] {
    [velocity.vx_m_per_s, velocity.vy_m_per_s, velocity.vtheta_rad_per_s]
}

/// Of heights and of bearings: the variances at the surveyed distances, "each weighted by the frequency
/// with which that beacon distance occurred during the learning" (section 4.4.1).
fn weighted_sds(log: &Log, track: &[TruePose], survey: &Survey) -> [Option<f64>; 2] {
    let heights = &survey.height_by_distance;
    let mut counts = vec![0.0; heights.len()];
    for sighting in log.sightings.iter() {
        let landmark = log.known.landmarks.iter().find(|landmark| landmark.id == sighting.landmark);
        let Some((landmark, pose)) = landmark.zip(pose_at(track, sighting.t_s)) else { continue };
        let distance_m = hypot(landmark.x_m - pose.x_m, landmark.y_m - pose.y_m);
        let off = |height: &Height| (height.distance_m - distance_m).abs();
        let nearest = (0..heights.len()).min_by(|a, b| off(&heights[*a]).total_cmp(&off(&heights[*b])));
        if let Some(nearest) = nearest {
            counts[nearest] += 1.0;
        }
    }
    let total: f64 = counts.iter().sum();
    if total == 0.0 {
        return [survey.sigma1_px, survey.sigma2_rad];
    }
    let sd = |sd_of: fn(&Height) -> f64| {
        let sum: f64 = heights.iter().zip(&counts).map(|(height, count)| count * square(sd_of(height))).sum();
        finite((sum / total).sqrt())
    };
    [sd(|height| height.sd_px), sd(|height| height.bearing_sd_rad)]
}

#[cfg(test)]
mod tests;
