//! The lie of the land: hills, and bumps small enough for wheels to feel.

use asami_dataset::Rng;
use asami_math::elementary::{sin, sin_cos};
use rand::RngExt;

/// A sum of waves over the plane.
#[derive(Clone, Debug)]
pub(super) struct Waves(Vec<Wave>);

#[derive(Clone, Debug)]
struct Wave {
    /// Radians a metre, x and y.
    along: [f64; 2],
    phase_rad: f64,
    amplitude_m: f64,
}

impl Waves {
    /// `count` waves of lengths between two, all of the same steepness, of root-mean-square `slope` together.
    pub fn of_slope(rng: &mut Rng, count: usize, lengths_m: [f64; 2], slope: f64) -> Self {
        let wave = |_| {
            let length_m = lengths_m[0] + (lengths_m[1] - lengths_m[0]) * rng.random::<f64>();
            let (sin, cos) = sin_cos(std::f64::consts::TAU * rng.random::<f64>());
            let per_m = std::f64::consts::TAU / length_m;
            // The slope of a sin(k x) is a k cos(k x): a k / sqrt(2) in the root mean square.
            let amplitude_m = slope * (2.0 / count as f64).sqrt() / per_m;
            let phase_rad = std::f64::consts::TAU * rng.random::<f64>();
            Wave { along: [per_m * cos, per_m * sin], phase_rad, amplitude_m }
        };
        Self((0..count).map(wave).collect())
    }

    /// Height at a place.
    pub fn at(&self, x_m: f64, y_m: f64) -> f64 {
        self.0.iter().map(|it| it.amplitude_m * sin(it.along[0] * x_m + it.along[1] * y_m + it.phase_rad)).sum()
    }
}

/// A draw between two numbers.
pub(super) fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

/// Whether something happens that does so with this chance.
pub(super) fn chance(rng: &mut Rng, share: f64) -> bool {
    rng.random::<f64>() < share
}
