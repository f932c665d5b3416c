//! Truth about the models of chapter 4 out of a true track.

use std::collections::BTreeMap;

use asami_dataset::truth::pose_at;
use asami_dataset::{Log, Sighting, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};
use asami_math::statistics::median;

use super::super::{finite, mean, square};

/// Distances are sorted into so many classes of equal width.
const CLASSES: usize = 30;

/// A class with fewer sightings has no mean.
const LEAST_SIGHTINGS: usize = 20;

/// Rounds in which they are told.
const ROUNDS: usize = 5;

/// A sighting whose size is off its class's line by more than so many times the usual is of another landmark.
const MISREAD: f64 = 6.0;

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

/// Every sighting that the track covers and that is not misread, held against the true distance and bearing from the sensor.
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
    let mut classes: BTreeMap<usize, Vec<[f64; 3]>> = BTreeMap::new();
    for row in &seen {
        let class = (CLASSES as f64 * (row[0] - least) / (greatest - least)) as usize;
        classes.entry(class.min(CLASSES - 1)).or_default().push(*row);
    }
    classes.values_mut().for_each(leave_out_misread);
    let right: Vec<[f64; 3]> = classes.values().flatten().copied().collect();
    classes.retain(|_, rows| rows.len() >= LEAST_SIGHTINGS);
    let about_lines: Vec<f64> = classes.values().flat_map(|rows| off_their_line(rows)).collect();
    let middle_rad = mean(right.iter().map(|row| row[2]));
    Sensor {
        means: classes.values().map(|rows| [0, 1].map(|i| mean(rows.iter().map(|row| row[i])))).collect(),
        sigma1: finite(mean(about_lines.iter().map(|off| square(*off))).sqrt()),
        sigma2_rad: finite(mean(right.iter().map(|row| square(row[2] - middle_rad))).sqrt()),
    }
}

/// Keeps those of a class that are about where the others are: the mean of a class would be moved by centimetres by one mark that was
/// read for another's, metres off.
fn leave_out_misread(rows: &mut Vec<[f64; 3]>) {
    if rows.len() < LEAST_SIGHTINGS {
        return;
    }
    let mut kept = rows.clone();
    for _ in 0..ROUNDS {
        let line = Line::through(&kept);
        let off: Vec<f64> = rows.iter().map(|row| line.off(row).abs()).collect();
        let usual = median(&off).unwrap_or_default();
        let right = rows.iter().zip(off).filter(|(_, off)| usual == 0.0 || *off <= MISREAD * usual);
        kept = right.map(|(row, _)| *row).collect();
    }
    *rows = kept;
}

/// The best line of sizes over distances.
struct Line {
    middle: [f64; 2],
    slope: f64,
}

impl Line {
    fn through(rows: &[[f64; 3]]) -> Self {
        let [x, y] = [0, 1].map(|i| mean(rows.iter().map(|row| row[i])));
        let slope =
            mean(rows.iter().map(|row| (row[0] - x) * (row[1] - y))) / mean(rows.iter().map(|row| square(row[0] - x)));
        Self { middle: [x, y], slope: if slope.is_finite() { slope } else { 0.0 } }
    }

    fn off(&self, row: &[f64; 3]) -> f64 {
        row[1] - self.middle[1] - self.slope * (row[0] - self.middle[0])
    }
}

fn off_their_line(rows: &[[f64; 3]]) -> Vec<f64> {
    let line = Line::through(rows);
    rows.iter().map(|row| line.off(row)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three barcodes that are read for others', 3 m off, leave classes and spreads what they are without them; where a class is mostly of one
    /// distance, those at its others stay.
    #[test]
    fn what_is_misread_moves_no_mean() {
        let row = |i: u32| {
            let distance_m = 2.0 + if i.is_multiple_of(5) { 0.02 * f64::from(i % 7) } else { 0.0 };
            [distance_m, 1.02 * distance_m + 0.01 * (f64::from(i * 37 % 100) / 50.0 - 1.0), 0.0]
        };
        let all: Vec<[f64; 3]> = (0..200).map(row).collect();
        let mut clean = all.clone();
        leave_out_misread(&mut clean);
        assert_eq!(clean, all);
        let mut misread = all.clone();
        misread.extend([[2.01, 5.0, 0.4], [2.05, 5.1, 0.5], [2.1, 0.3, -0.4]]);
        leave_out_misread(&mut misread);
        assert_eq!(misread, all);
    }
}
