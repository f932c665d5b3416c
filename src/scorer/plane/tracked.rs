//! Truth about the models of chapter 4 out of a true track.

use std::collections::BTreeMap;

use asami_dataset::truth::pose_at;
use asami_dataset::{Log, Sighting, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};

use super::super::{finite, mean, square};

/// Distances are sorted into so many classes of equal width.
const CLASSES: usize = 30;

/// A class with fewer sightings has no mean.
const LEAST_SIGHTINGS: usize = 20;

/// What sizes and bearings are at which distance.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sensor {
    /// Mean distance and mean size of each class of distances.
    pub means: Vec<[f64; 2]>,
    /// Spread of the sizes about their classes' lines.
    pub sigma1: Option<f64>,
    /// Spread of the bearings about their mean error.
    pub sigma2_rad: Option<f64>,
}

/// Every sighting that the track covers, held against the true distance and bearing from the sensor.
pub(super) fn sensor(log: &Log, track: &[TruePose]) -> Sensor {
    let origin_m = log.known.range_bearing.map_or([0.0; 2], |sensor| sensor.sensor_origin_m);
    let place = |sighting: &Sighting| {
        let landmark = log.known.landmarks.iter().find(|landmark| landmark.id == sighting.landmark)?;
        let pose = pose_at(track, sighting.t_s)?;
        let (sin, cos) = sin_cos(pose.theta_rad);
        let (x_m, y_m) = (landmark.x_m - pose.x_m, landmark.y_m - pose.y_m);
        let right_m = cos * x_m + sin * y_m - origin_m[0];
        let ahead_m = cos * y_m - sin * x_m - origin_m[1];
        let off_rad = wrap_rad(sighting.bearing_rad - atan2(-right_m, ahead_m));
        Some([hypot(right_m, ahead_m), sighting.size.value(), off_rad])
    };
    let seen: Vec<[f64; 3]> = log.sightings.iter().filter_map(place).collect();
    let least = seen.iter().map(|row| row[0]).fold(f64::INFINITY, f64::min);
    let greatest = seen.iter().map(|row| row[0]).fold(f64::NEG_INFINITY, f64::max);
    let mut classes: BTreeMap<usize, Vec<[f64; 2]>> = BTreeMap::new();
    for [distance_m, size, _] in &seen {
        let class = (CLASSES as f64 * (distance_m - least) / (greatest - least)) as usize;
        classes.entry(class.min(CLASSES - 1)).or_default().push([*distance_m, *size]);
    }
    classes.retain(|_, rows| rows.len() >= LEAST_SIGHTINGS);
    let about_lines: Vec<f64> = classes.values().flat_map(|rows| about_their_line(rows)).collect();
    let middle_rad = mean(seen.iter().map(|row| row[2]));
    Sensor {
        means: classes.values().map(|rows| [0, 1].map(|i| mean(rows.iter().map(|row| row[i])))).collect(),
        sigma1: finite(mean(about_lines.iter().map(|off| square(*off))).sqrt()),
        sigma2_rad: finite(mean(seen.iter().map(|row| square(row[2] - middle_rad))).sqrt()),
    }
}

/// What is left of `y` after the best line through `(x, y)`.
fn about_their_line(rows: &[[f64; 2]]) -> Vec<f64> {
    let [x, y] = [0, 1].map(|i| mean(rows.iter().map(|row| row[i])));
    let slope =
        mean(rows.iter().map(|row| (row[0] - x) * (row[1] - y))) / mean(rows.iter().map(|row| square(row[0] - x)));
    let slope = if slope.is_finite() { slope } else { 0.0 };
    rows.iter().map(|row| row[1] - y - slope * (row[0] - x)).collect()
}
