//! The true sensor model: which beacons are seen, how tall and where.

use std::f64::consts::{FRAC_PI_2, TAU};

use asami_dataset::{Beacon, Rng, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin, tan};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::config::Sight;
use crate::knobs::EyeKnobs;

impl Sight {
    /// Mean height in the middle of the image of a beacon `distance_m` from the body's centre.
    #[must_use]
    pub fn height_px(&self, distance_m: f64, eye: &EyeKnobs) -> f64 {
        self.height_off_axis_px(distance_m, 0.0, eye)
    }

    /// The same at a tangent off the camera's axis whose square is `r2`.
    fn height_off_axis_px(&self, distance_m: f64, r2: f64, eye: &EyeKnobs) -> f64 {
        self.height_px_m / (distance_m - self.camera_ahead_m) * eye.magnification(r2) - self.lost_px + eye.bloom_px
    }

    /// Heights between which beacons are recognised, least first.
    #[must_use]
    pub fn heights_px(&self) -> [f64; 2] {
        let eye = EyeKnobs::default();
        [self.height_px(self.far_m, &eye), self.height_px(self.near_m, &eye)]
    }

    /// Where the head looks at `t_s`, counter-clockwise from straight ahead.
    #[must_use]
    pub fn head_pan_rad(&self, t_s: f64) -> f64 {
        self.scan_amplitude_rad * sin(TAU * t_s / self.scan_period_s)
    }

    /// What is reported at `t_s` of `beacons` as they were to be seen from `pose`, at its time, by a head that is said
    /// to pan to `pan_reading_rad`.
    ///
    /// Every beacon draws its noise whether it is seen or not, so that a log in which more is seen differs in
    /// nothing else.
    pub(super) fn look(
        &self,
        (t_s, pan_reading_rad): (f64, f64),
        pose: &TruePose,
        beacons: &[Beacon],
        eye: &EyeKnobs,
        rng: &mut Rng,
    ) -> Vec<Sighting> {
        let pan_rad = self.head_pan_rad(pose.t_s);
        let turned_rad = pan_reading_rad - pan_rad;
        let sightings = beacons.iter().filter_map(|beacon| {
            let height_noise: f64 = StandardNormal.sample(rng);
            let bearing_noise: f64 = StandardNormal.sample(rng);
            let recognised = rng.random::<f64>() < self.recognised;

            let (distance_m, bearing_rad) = seen_from(pose, beacon);
            let off_centre_rad = wrap_rad(bearing_rad - pan_rad);
            let bent_rad = bent_rad(off_centre_rad, eye);
            let in_view = (off_centre_rad + bent_rad).abs() <= 0.5 * self.view_rad;
            let r = tan(off_centre_rad);
            let height_px = self.height_off_axis_px(distance_m, r * r, eye);
            let in_range = (self.near_m..=self.far_m).contains(&distance_m);
            (recognised && in_view && in_range).then(|| Sighting {
                t_s,
                landmark: beacon.id,
                size: Size::HeightPx(height_px + self.sigma1_px * eye.noise_ratio * height_noise),
                bearing_rad: wrap_rad(
                    bearing_rad + self.sigma2_rad * eye.noise_ratio * bearing_noise + turned_rad + bent_rad,
                ),
            })
        });
        sightings.filter(|sighting| sighting.size.value() > 0.0).collect()
    }
}

/// By how much the image puts something off the axis farther out than it is.
fn bent_rad(off_centre_rad: f64, eye: &EyeKnobs) -> f64 {
    let r = tan(off_centre_rad);
    let magnification = eye.magnification(r * r);
    if magnification == 1.0 || off_centre_rad.abs() >= FRAC_PI_2 {
        return 0.0;
    }
    atan2(magnification * r, 1.0) - off_centre_rad
}

/// Distance of a beacon from the body's centre, and its bearing from straight ahead, counter-clockwise.
fn seen_from(pose: &TruePose, beacon: &Beacon) -> (f64, f64) {
    let (right_m, ahead_m) = (beacon.x_m - pose.x_m, beacon.y_m - pose.y_m);
    (hypot(right_m, ahead_m), wrap_rad(atan2(-right_m, ahead_m) - pose.theta_rad))
}
