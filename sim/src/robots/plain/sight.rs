//! The true sensor model: which beacons are seen, how tall and where.

use std::f64::consts::TAU;

use asami_dataset::{Beacon, Rng, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::config::Sight;

impl Sight {
    /// Mean height in the image of a beacon `distance_m` from the body's centre.
    #[must_use]
    pub fn height_px(&self, distance_m: f64) -> f64 {
        self.height_px_m / (distance_m - self.camera_ahead_m) - self.lost_px
    }

    /// Where the head looks at `t_s`, counter-clockwise from straight ahead.
    #[must_use]
    pub fn head_pan_rad(&self, t_s: f64) -> f64 {
        self.scan_amplitude_rad * sin(TAU * t_s / self.scan_period_s)
    }

    /// What is reported of `beacons` from `pose`.
    ///
    /// Every beacon draws its noise whether it is seen or not, so that a log in which more is seen differs in
    /// nothing else.
    pub(super) fn look(&self, pose: &TruePose, beacons: &[Beacon], rng: &mut Rng) -> Vec<Sighting> {
        let pan_rad = self.head_pan_rad(pose.t_s);
        let sightings = beacons.iter().filter_map(|beacon| {
            let height_noise: f64 = StandardNormal.sample(rng);
            let bearing_noise: f64 = StandardNormal.sample(rng);
            let recognised = rng.random::<f64>() < self.recognised;

            let (distance_m, bearing_rad) = seen_from(pose, beacon);
            let off_centre_rad = wrap_rad(bearing_rad - pan_rad);
            let in_view = off_centre_rad.abs() <= 0.5 * self.view_rad;
            let in_range = (self.near_m..=self.far_m).contains(&distance_m);
            (recognised && in_view && in_range).then(|| Sighting {
                t_s: pose.t_s,
                landmark: beacon.id,
                size: Size::HeightPx(self.height_px(distance_m) + self.sigma1_px * height_noise),
                bearing_rad: wrap_rad(bearing_rad + self.sigma2_rad * bearing_noise),
            })
        });
        sightings.filter(|sighting| sighting.size.value() > 0.0).collect()
    }
}

/// Distance of a beacon from the body's centre, and its bearing from straight ahead, counter-clockwise.
fn seen_from(pose: &TruePose, beacon: &Beacon) -> (f64, f64) {
    let (right_m, ahead_m) = (beacon.x_m - pose.x_m, beacon.y_m - pose.y_m);
    (hypot(right_m, ahead_m), wrap_rad(atan2(-right_m, ahead_m) - pose.theta_rad))
}
