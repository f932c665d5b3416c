//! From the angles that the gait wants to the set-points that the motors are given.

use asami_dataset::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::config::Servo;

/// The set-points of all joints, moved no faster than each servo can.
#[derive(Clone, Debug)]
pub struct SetPoints {
    angles_rad: Vec<f64>,
    greatest_step_rad: Vec<f64>,
    jitter_rad: f64,
    rng: Rng,
}

impl SetPoints {
    /// Starts at `angles_rad`; `speed_limits_rad_per_s` are the body's, `rng` draws the jitter.
    #[must_use]
    pub fn new(
        servo: &Servo,
        tick_s: f64,
        angles_rad: Vec<f64>,
        speed_limits_rad_per_s: impl Iterator<Item = f64>,
        rng: Rng,
    ) -> Self {
        let greatest_step_rad = speed_limits_rad_per_s.map(|limit| limit * servo.speed_limit_ratio * tick_s).collect();
        Self { angles_rad, greatest_step_rad, jitter_rad: servo.set_point_jitter_rad, rng }
    }

    /// Moves towards `wanted_rad` for one control period, at `speed_ratio` of the greatest speed at most.
    pub fn approach(&mut self, wanted_rad: &[f64], speed_ratio: f64) -> &mut [f64] {
        for ((angle, wanted), step) in self.angles_rad.iter_mut().zip(wanted_rad).zip(&self.greatest_step_rad) {
            let jitter = if self.jitter_rad > 0.0 {
                let normal: f64 = StandardNormal.sample(&mut self.rng);
                self.jitter_rad * normal
            } else {
                0.0
            };
            let step = speed_ratio * step;
            *angle += (wanted + jitter - *angle).clamp(-step, step);
        }
        &mut self.angles_rad
    }
}
