//! A landmark as a robot in the plane sees it.

use asami_math::elementary::{atan2, sin_cos};

/// A landmark as seen from a pose, with derivatives by x, y and heading.
pub(crate) struct View {
    pub(crate) distance_m: f64,
    pub(crate) bearing_rad: f64,
    pub(crate) distance_by: [f64; 3],
    pub(crate) bearing_by: [f64; 3],
}

impl View {
    pub(crate) fn of(w: &[f64; 3], landmark_m: [f64; 2], sensor_origin_m: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(w[2]);
        let (dx, dy) = (landmark_m[0] - w[0], landmark_m[1] - w[1]);
        let (body_right, body_forward) = (cos * dx + sin * dy, cos * dy - sin * dx);
        let (right, forward) = (body_right - sensor_origin_m[0], body_forward - sensor_origin_m[1]);
        // A landmark is never inside the robot.
        let distance_m = (right * right + forward * forward).sqrt().max(0.05);
        let (along, across) = (right / distance_m, forward / distance_m);
        // Derivatives of (right, forward) by x, y, heading.
        let right_by = [-cos, -sin, body_forward];
        let forward_by = [sin, -cos, -body_right];
        let per_m = 1.0 / distance_m;
        Self {
            distance_m,
            bearing_rad: atan2(-right, forward),
            distance_by: std::array::from_fn(|k| along * right_by[k] + across * forward_by[k]),
            bearing_by: std::array::from_fn(|k| per_m * (along * forward_by[k] - across * right_by[k])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_limits_of_differences() {
        let (w, landmark_m, origin_m, h) = ([0.4, -1.2, 2.1], [1.8, 2.7], [0.05, 0.2], 1e-6);
        let view = View::of(&w, landmark_m, origin_m);
        for k in 0..3 {
            let moved = |by: f64| {
                View::of(&std::array::from_fn(|i| w[i] + if i == k { by } else { 0.0 }), landmark_m, origin_m)
            };
            let (after, before) = (moved(h), moved(-h));
            assert!(((after.distance_m - before.distance_m) / (2.0 * h) - view.distance_by[k]).abs() < 1e-8, "{k}");
            assert!(((after.bearing_rad - before.bearing_rad) / (2.0 * h) - view.bearing_by[k]).abs() < 1e-8, "{k}");
        }
    }

    #[test]
    fn bearings_are_counter_clockwise_from_ahead() {
        // Facing +y, a landmark to the left is at +90 degrees.
        let view = View::of(&[1.0, 1.0, 0.0], [0.0, 1.0], [0.0; 2]);
        assert!(
            (view.bearing_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15 && (view.distance_m - 1.0).abs() < 1e-15
        );
    }
}
