//! What the sensor on the deck reports: ranges and bearings of landmarks.

use std::f64::consts::{FRAC_PI_2, PI};

use asami_dataset::{Beacon, Rng, Sighting, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, cos, exp, hypot, sin, sin_cos, tan};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::config::Sight;
use crate::knobs::EyeKnobs;

/// What the range of each landmark is off for a while, in standard deviations: an autoregression of first order.
pub(super) struct Lasting {
    rng: Rng,
    off: Vec<f64>,
    /// What is left of it from frame to frame.
    kept: f64,
}

impl Lasting {
    /// Of so many landmarks.
    pub(super) fn new(landmarks: usize, frame_s: f64, sight: &Sight, mut rng: Rng) -> Self {
        let off = (0..landmarks).map(|_| StandardNormal.sample(&mut rng)).collect();
        Self { rng, off, kept: exp(-frame_s / sight.fades_s) }
    }

    /// A frame later.
    pub(super) fn go_on(&mut self) {
        let fresh = (1.0 - self.kept * self.kept).sqrt();
        for off in &mut self.off {
            let new: f64 = StandardNormal.sample(&mut self.rng);
            *off = self.kept * *off + fresh * new;
        }
    }
}

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
        lasting: &Lasting,
        rng: &mut Rng,
    ) -> Vec<Sighting> {
        let [old, new] = [self.lasting_share, 1.0 - self.lasting_share].map(f64::sqrt);
        let (sin_theta, cos_theta) = sin_cos(pose.theta_rad);
        let (x_m, y_m) = (pose.x_m - self.ahead_m * sin_theta, pose.y_m + self.ahead_m * cos_theta);
        let sightings = beacons.iter().zip(&lasting.off).filter_map(|(beacon, off)| {
            let [white, bearing_noise]: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(rng));
            let range_noise = old * off + new * white;
            let recognised = rng.random::<f64>() < self.recognised;

            let (right_m, ahead_m) = (beacon.x_m - x_m, beacon.y_m - y_m);
            let distance_m = hypot(right_m, ahead_m);
            let bearing_rad = wrap_rad(atan2(-right_m, ahead_m) - pose.theta_rad);
            let read_rad = bearing_rad + self.bent_rad(bearing_rad, eye);
            let seen = (self.near_m..=self.far_m).contains(&distance_m) && read_rad.abs() <= 0.5 * self.view_rad;
            (recognised && seen).then(|| {
                // From the sensor itself, or only along its axis.
                let lacks = eye.depth_share * (1.0 - cos(bearing_rad)) - eye.range_skew * sin(bearing_rad);
                let measured_m = distance_m * (1.0 - lacks);
                // By how large it is in the image.
                let measured_m = if self.scans() { measured_m } else { measured_m / eye.focal_ratio };
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

    /// What sees more than half a circle is a scanner, and has a mirror that turns; what sees less is a camera, and has a lens.
    fn scans(&self) -> bool {
        self.view_rad > PI
    }

    /// By how much the image, or the mirror, puts something off the axis farther out than it is.
    fn bent_rad(&self, off_axis_rad: f64, eye: &EyeKnobs) -> f64 {
        if self.scans() {
            return (eye.bearing_ratio - 1.0) * off_axis_rad + eye.eccentricity * (1.0 - cos(off_axis_rad));
        }
        // Beyond a right angle no lens sees.
        if (eye.distortion, eye.focal_ratio) == (0.0, 1.0) || off_axis_rad.abs() >= FRAC_PI_2 {
            return 0.0;
        }
        let r = tan(off_axis_rad);
        atan2(eye.magnification(r * r) * r, 1.0) - off_axis_rad
    }
}
