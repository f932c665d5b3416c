//! Sightings and where landmarks were.

use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};
use asami_math::regression::least_squares;
use asami_math::statistics::median;

use super::{Capture, LEAST, OUTLIER, ROUNDS};

/// What a range hangs on: an offset, the distance, what a depth lacks of it, how far a landmark lies to the left.
type Row = [f64; 4];

/// Ranges against distances, depths and what lies to the left, bearings against bearings from where ahead is.
pub(super) fn sightings(dataset: &Dataset, ahead_rad: f64, capture: &mut Capture) {
    let log = &dataset.log;
    let [right_m, ahead_m] = log.known.range_bearing.as_ref().map_or([0.0; 2], |it| it.sensor_origin_m);
    let rows: Vec<(Row, f64, f64)> = log
        .sightings
        .iter()
        .filter_map(|seen| {
            let Size::RangeM(range_m) = seen.size else { return None };
            let landmark = log.known.landmarks.iter().find(|it| it.id == seen.landmark)?;
            let pose = pose_at(&dataset.truth.track, seen.t_s)?;
            let theta_rad = pose.theta_rad + ahead_rad;
            let (sin, cos_theta) = sin_cos(theta_rad);
            let dx = landmark.x_m - pose.x_m - right_m * cos_theta + ahead_m * sin;
            let dy = landmark.y_m - pose.y_m - right_m * sin - ahead_m * cos_theta;
            let (distance_m, bearing_rad) = (hypot(dx, dy), wrap_rad(atan2(-dx, dy) - theta_rad));
            let (sin_bearing, cos_bearing) = sin_cos(bearing_rad);
            let shortened_m = distance_m * (1.0 - cos_bearing);
            let to_the_left_m = distance_m * sin_bearing;
            Some(([1.0, distance_m, -shortened_m, to_the_left_m], range_m, wrap_rad(seen.bearing_rad - bearing_rad)))
        })
        .collect();
    if rows.len() < LEAST {
        return;
    }
    let mut kept: Vec<&(Row, f64, f64)> = rows.iter().collect();
    let mut found = [0.0, 1.0, 0.0, 0.0];
    for _ in 0..ROUNDS {
        let counted = kept.iter().map(|row| (row.0.to_vec(), row.1));
        let solved = least_squares(found.len(), counted).solve().and_then(|fit| Row::try_from(fit.coefficients).ok());
        let Some(solved) = solved else { return };
        found = solved;
        let off = |row: &(Row, f64, f64)| (row.1 - row.0.iter().zip(found).fold(0.0, |sum, (x, k)| sum + k * x)).abs();
        let usual = median(&rows.iter().map(off).collect::<Vec<f64>>()).unwrap_or(0.0);
        kept = rows.iter().filter(|row| off(row) <= OUTLIER * usual).collect();
    }
    let offsets: Vec<f64> = kept.iter().map(|row| row.2).collect();
    let offset_rad = median(&offsets).unwrap_or(0.0);
    let values = [
        ("range_offset.offset_m", found[0]),
        ("range_scale.ratio", found[1]),
        ("depth_for_range.share", found[2] / found[1]),
        ("range_skew.share", found[3] / found[1]),
        ("pan_offset.offset_rad", offset_rad),
    ];
    capture.values.extend(values.map(|(name, value)| (name.to_owned(), value)));
}
