//! Sightings held against a motion capture: their noise, their mistakes and their clock, as found.

use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, Log, Sighting, Survey, TruePose, Truth};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};
use asami_math::regression::least_squares;

use super::Imported;

/// A bearing further off is of another landmark.
const MISTAKEN_RAD: f64 = 0.5;
/// A range further off is of another landmark.
const MISTAKEN_M: f64 = 1.0;
/// Half of the time over which the true bearing's rate is measured.
const RATE_HALF_S: f64 = 0.05;

/// What the motion capture says of a log's sightings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Standard deviation of the range about its line in the true distance, m.
    pub sigma1_m: f64,
    /// Standard deviation of the bearing about its mean error, rad.
    pub sigma2_rad: f64,
    /// The range's line in the true distance: range at distance 0, and slope.
    pub line: [f64; 2],
    /// Standard deviation about a line of the ranges that they would be if they were depths along the sensor's axis, m.
    pub sigma1_of_depths_m: f64,
    /// Mean error of the bearing, rad.
    pub bearing_bias_rad: f64,
    /// How long the bearings run ahead of the motion capture, s.
    pub lead_s: f64,
    /// Sightings that the track covers.
    pub covered: usize,
    /// Of these, those further off than 0.5 rad or 1 m, left out of all else.
    pub mistaken: usize,
}

/// The data set of a log and its track; what the two say of each other is noted and, of the noise, surveyed.
#[must_use]
pub fn agreed(log: Log, track: Vec<TruePose>, mut notes: Vec<String>) -> Imported {
    let agreement = Agreement::of(&log, &track);
    notes.extend(agreement.iter().flat_map(Agreement::notes));
    let survey = agreement.map(|found| Survey {
        sigma1_m: Some(found.sigma1_m),
        sigma2_rad: Some(found.sigma2_rad),
        ..Survey::default()
    });
    Imported { dataset: Dataset { log, truth: Truth { track: track.into(), survey }, provenance: None }, notes }
}

struct Residual {
    distance_m: f64,
    range_m: f64,
    bearing_rad: f64,
    /// Of the measured bearing.
    cos_bearing: f64,
    /// Of the true bearing.
    rate_rad_per_s: f64,
}

impl Agreement {
    /// Holds every sighting of a range against the track; `None` if it covers fewer than three.
    #[must_use]
    pub fn of(log: &Log, track: &[TruePose]) -> Option<Self> {
        let all: Vec<Residual> = log.sightings.iter().filter_map(|seen| residual(log, track, seen)).collect();
        let is_mistaken =
            |it: &Residual| it.bearing_rad.abs() > MISTAKEN_RAD || (it.range_m - it.distance_m).abs() > MISTAKEN_M;
        let kept: Vec<&Residual> = all.iter().filter(|it| !is_mistaken(it)).collect();
        if kept.len() < 3 {
            return None;
        }
        let mean = |of: &dyn Fn(&Residual) -> f64| kept.iter().map(|it| of(it)).sum::<f64>() / kept.len() as f64;
        let about_line = |of: &dyn Fn(&Residual) -> f64| {
            let line = least_squares(2, kept.iter().map(|it| (vec![1.0, it.distance_m], of(it)))).solve()?.coefficients;
            Some((mean(&|it| (of(it) - line[0] - line[1] * it.distance_m).powi(2)).sqrt(), line))
        };
        let (sigma1_m, line) = about_line(&|it| it.range_m)?;
        let (sigma1_of_depths_m, _) = about_line(&|it| it.range_m / it.cos_bearing)?;
        let bias = mean(&|it| it.bearing_rad);
        let rate = mean(&|it| it.rate_rad_per_s);
        let covariance = mean(&|it| (it.bearing_rad - bias) * (it.rate_rad_per_s - rate));
        let variance = mean(&|it| (it.rate_rad_per_s - rate).powi(2));
        Some(Self {
            sigma1_m,
            sigma1_of_depths_m,
            sigma2_rad: mean(&|it| (it.bearing_rad - bias).powi(2)).sqrt(),
            line: [line[0], line[1]],
            bearing_bias_rad: bias,
            lead_s: if variance > 0.0 { covariance / variance } else { 0.0 },
            covered: all.len(),
            mistaken: all.len() - kept.len(),
        })
    }

    /// What was found, a sentence each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let Self { sigma1_m, sigma2_rad, line: [offset_m, slope], bearing_bias_rad, lead_s, covered, mistaken, .. } =
            self;
        let mut notes = vec![
            format!("found: {covered} sightings while motion capture saw the robot, {mistaken} of them mistaken"),
            format!(
                "found: range = {offset_m:.4} m + {slope:.4} x distance, sd {sigma1_m:.4} m (survey.toml, sigma1_m)"
            ),
            format!("found: bearing {bearing_bias_rad:+.4} rad off, sd {sigma2_rad:.4} rad (survey.toml, sigma2_rad)"),
            format!("found: the bearings run ahead of the motion capture by {lead_s:.3} s; left as it is"),
        ];
        if self.sigma1_of_depths_m < 0.5 * sigma1_m {
            notes.push(format!(
                "hint: divided by the cosine of the bearing the ranges' sd would be {:.4} m: they look like depths along \
                 the sensor's axis; left as they are ([depths] in a scenario makes ranges of them)",
                self.sigma1_of_depths_m
            ));
        }
        notes
    }
}

fn residual(log: &Log, track: &[TruePose], seen: &Sighting) -> Option<Residual> {
    let landmark = log.known.landmarks.iter().find(|landmark| landmark.id == seen.landmark)?;
    let [right_m, forward_m] = log.known.range_bearing.map_or([0.0; 2], |sensor| sensor.sensor_origin_m);
    let expected = |t_s: f64| {
        let pose = pose_at(track, t_s)?;
        let (sin, cos) = sin_cos(pose.theta_rad);
        let x_m = landmark.x_m - pose.x_m - (cos * right_m - sin * forward_m);
        let y_m = landmark.y_m - pose.y_m - (sin * right_m + cos * forward_m);
        Some((hypot(x_m, y_m), wrap_rad(atan2(-x_m, y_m) - pose.theta_rad)))
    };
    let (distance_m, bearing_rad) = expected(seen.t_s)?;
    let (_, before_rad) = expected(seen.t_s - RATE_HALF_S)?;
    let (_, after_rad) = expected(seen.t_s + RATE_HALF_S)?;
    Some(Residual {
        distance_m,
        range_m: seen.size.value(),
        bearing_rad: wrap_rad(seen.bearing_rad - bearing_rad),
        cos_bearing: sin_cos(seen.bearing_rad).1,
        rate_rad_per_s: wrap_rad(after_rad - before_rad) / (2.0 * RATE_HALF_S),
    })
}
