//! What the sensor on the deck reports: ranges and bearings of landmarks.

use asami_dataset::{Beacon, Rng, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, cos, hypot, sin_cos, tan};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::config::Sight;
use crate::knobs::EyeKnobs;

impl Sight {
    /// What is reported at `t_s` of `beacons` as they were to be seen from `pose`.
    ///
    /// Every landmark draws its noise whether it is seen or not, so that a log in which more is seen differs in nothing
    /// else.
    pub(super) fn look(
        &self,
        t_s: f64,
        pose: &TruePose,
        beacons: &[Beacon],
        eye: &EyeKnobs,
        rng: &mut Rng,
    ) -> Vec<Sighting> {
        let (sin, cos_theta) = sin_cos(pose.theta_rad);
        let (x_m, y_m) = (pose.x_m - self.ahead_m * sin, pose.y_m + self.ahead_m * cos_theta);
        let sightings = beacons.iter().filter_map(|beacon| {
            let range_noise: f64 = StandardNormal.sample(rng);
            let bearing_noise: f64 = StandardNormal.sample(rng);
            let recognised = rng.random::<f64>() < self.recognised;

            let (right_m, ahead_m) = (beacon.x_m - x_m, beacon.y_m - y_m);
            let distance_m = hypot(right_m, ahead_m);
            let bearing_rad = wrap_rad(atan2(-right_m, ahead_m) - pose.theta_rad);
            let read_rad = bearing_rad + bent_rad(bearing_rad, eye);
            let seen = (self.near_m..=self.far_m).contains(&distance_m) && read_rad.abs() <= 0.5 * self.view_rad;
            (recognised && seen).then(|| {
                // From the sensor itself, or only along its axis.
                let measured_m = distance_m * (1.0 - eye.depth_share * (1.0 - cos(bearing_rad)));
                let range_m = measured_m * eye.range_ratio + eye.range_offset_m;
                Sighting {
                    t_s,
                    landmark: beacon.id,
                    size: Size::RangeM(range_m + self.sigma1_m * eye.noise_ratio * range_noise),
                    bearing_rad: wrap_rad(
                        read_rad + eye.pan_offset_rad + self.sigma2_rad * eye.noise_ratio * bearing_noise,
                    ),
                }
            })
        });
        sightings.filter(|sighting| sighting.size.value() > 0.0).collect()
    }
}

/// By how much the image puts something off the axis farther out than it is. Beyond a right angle no lens sees.
fn bent_rad(off_axis_rad: f64, eye: &EyeKnobs) -> f64 {
    if eye.distortion == 0.0 || off_axis_rad.abs() >= std::f64::consts::FRAC_PI_2 {
        return 0.0;
    }
    let r = tan(off_axis_rad);
    atan2(eye.bend(r * r) * r, 1.0) - off_axis_rad
}
