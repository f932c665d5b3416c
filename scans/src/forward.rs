//! Which way is forward: the way the car moves (end of section 5.2).

use asami_math::angle::wrap_rad;

/// An angle and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// The angle.
    pub angle_rad: f64,
    /// Its standard error: of a median of independent normal angles, their spread taken from the median distance.
    pub se_rad: f64,
}

/// More angles than this are thinned out: each is compared with each.
const MOST: usize = 4000;

/// The angle median: the one of the angles with the least total distance from all others, the first of several. `None` without angles.
#[must_use]
pub fn angle_median(angles_rad: &[f64]) -> Option<Direction> {
    let thin = angles_rad.len().div_ceil(MOST).max(1);
    let angles: Vec<f64> = angles_rad.iter().copied().filter(|angle| angle.is_finite()).step_by(thin).collect();
    let total = |from: f64| angles.iter().fold(0.0, |sum, angle| sum + wrap_rad(angle - from).abs());
    let mut best: Option<(f64, f64)> = None;
    for &angle in &angles {
        let distance = total(angle);
        if best.is_none_or(|(_, least)| distance < least) {
            best = Some((angle, distance));
        }
    }
    let (angle_rad, _) = best?;
    let mut distances: Vec<f64> = angles.iter().map(|angle| wrap_rad(angle - angle_rad).abs()).collect();
    distances.sort_by(f64::total_cmp);
    // Median distance to standard deviation, and that to the error of a median, of a normal distribution.
    let spread = 1.4826 * distances[distances.len() / 2];
    Some(Direction { angle_rad: wrap_rad(angle_rad), se_rad: 1.2533 * spread / (angles.len() as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_median_stands_against_outliers_and_across_the_seam() {
        let angles = [PI - 0.02, PI - 0.01, -PI, -PI + 0.01, -PI + 0.02, 0.4, -1.0];
        let found = angle_median(&angles).unwrap();
        assert!(wrap_rad(found.angle_rad - PI).abs() < 0.011, "{found:?}");
        assert_eq!(angle_median(&[f64::NAN]), None);
        assert_eq!(angle_median(&[]), None);
    }
}
