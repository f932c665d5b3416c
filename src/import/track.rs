//! Where a car was, of a log that says how it moved.

use asami_dataset::TruePose;
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;

/// How a car moved at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// When.
    pub t_s: f64,
    /// Forward speed.
    pub v_m_per_s: f64,
    /// Turning rate, counter-clockwise.
    pub omega_rad_per_s: f64,
}

/// Poses from the origin on, facing +y: speeds and turning rates added up by the trapezoidal rule.
#[must_use]
pub fn added_up(rows: &[Moving]) -> Vec<TruePose> {
    let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
    let mut before: Option<&Moving> = None;
    let mut track = Vec::with_capacity(rows.len());
    for now in rows {
        if let Some(before) = before {
            let dt_s = now.t_s - before.t_s;
            let way_m = dt_s * (now.v_m_per_s + before.v_m_per_s) / 2.0;
            let turned_rad = dt_s * (now.omega_rad_per_s + before.omega_rad_per_s) / 2.0;
            let (sin, cos) = sin_cos(pose.theta_rad + turned_rad / 2.0);
            pose.x_m -= way_m * sin;
            pose.y_m += way_m * cos;
            pose.theta_rad = wrap_rad(pose.theta_rad + turned_rad);
        }
        before = Some(now);
        track.push(TruePose { t_s: now.t_s, v_m_per_s: Some(now.v_m_per_s), ..pose });
    }
    track
}
