//! Feet that grip a little more or less from stride to stride.

use asami_dataset::Rng;
use asami_math::elementary::exp;
use rand_distr::{Distribution, StandardNormal};

use super::config::Disturbance;

/// A factor on each foot's friction coefficient, log-normal about 1, drawn anew now and then.
#[derive(Clone, Debug)]
pub struct Grip {
    disturbance: Disturbance,
    rng: Rng,
    factors: [f64; 4],
    draws: u64,
}

impl Grip {
    /// Even grip until the first draw.
    #[must_use]
    pub fn new(disturbance: Disturbance, rng: Rng) -> Self {
        Self { disturbance, rng, factors: [1.0; 4], draws: 0 }
    }

    /// The feet's factors at `t_s`, which never goes back.
    pub fn factors(&mut self, t_s: f64) -> [f64; 4] {
        let sd = self.disturbance.friction_log_sd;
        if sd > 0.0 && t_s >= self.draws as f64 * self.disturbance.friction_hold_s {
            self.draws += 1;
            self.factors = std::array::from_fn(|_| {
                let normal: f64 = StandardNormal.sample(&mut self.rng);
                exp(sd * normal)
            });
        }
        self.factors
    }
}
