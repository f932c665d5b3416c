//! Angles on the circle.

use std::f64::consts::{PI, TAU};

/// The representative of `angle_rad` in `[-pi, pi)`.
///
/// ```
/// use asami_math::angle::wrap_rad;
/// use std::f64::consts::PI;
/// assert_eq!(wrap_rad(PI), -PI);
/// assert!((wrap_rad(7.0) - (7.0 - 2.0 * PI)).abs() < 1e-15);
/// ```
#[must_use]
pub fn wrap_rad(angle_rad: f64) -> f64 {
    if (-PI..PI).contains(&angle_rad) {
        return angle_rad;
    }
    let turned = (angle_rad + PI).rem_euclid(TAU) - PI;
    // rem_euclid may round up to TAU itself for tiny negative inputs.
    if turned >= PI { turned - TAU } else { turned }
}
