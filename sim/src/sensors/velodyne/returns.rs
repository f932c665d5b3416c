//! What becomes of light that has met something: noise, loss, and the numbers that are recorded.

use asami_dataset::Rng;
use asami_math::elementary::{erfc, exp};
use asami_raycast::{Bundle, Hits};
use rand::Rng as _;

use super::{Scenery, VelodyneConfig};
use crate::knobs::VelodyneKnobs;

/// Units of a recorded range in a metre: 2 mm each.
const PER_STEP_M: f32 = 500.0;
/// Quantiles of the upper half of the normal distribution.
const QUANTILES: usize = 1 << 15;

/// How ranges are measured.
pub(super) struct Meter {
    least_m: f32,
    greatest_m: f32,
    kept: f32,
    per_half_lost_m: f32,
    /// Errors of the range: middles of equally likely classes of the half-normal distribution.
    errors_m: Vec<f32>,
}

/// What is recorded of a bundle, lane by lane.
pub(super) struct Readings {
    pub range_2mm: [u16; Bundle::RAYS],
    pub intensity: [u8; Bundle::RAYS],
}

/// Draws for a bundle: 16 bits a lane.
pub(super) type Draws = [u16; Bundle::RAYS];

/// Reflectivity times the cosine of incidence, lane by lane.
pub(super) type Light = [f32; Bundle::RAYS];

/// The light of what a bundle's beams met in a scene.
pub(super) fn light(scenery: &Scenery, bundle: &Bundle, hits: &Hits) -> Light {
    let mut light = [0.0_f32; Bundle::RAYS];
    let [dx, dy, dz] = &bundle.direction;
    for (lane, light) in light.iter_mut().enumerate() {
        let [x, y, z] = scenery.brightness(hits.triangle[lane]);
        *light = (x * dx[lane] + y * dy[lane] + z * dz[lane]).abs();
    }
    light
}

/// What each lane of a bundle measures too much, in metres.
pub(super) type Biases = [f32; Bundle::RAYS];

/// The next draws of a stream.
pub(super) fn draw(rng: &mut Rng) -> Draws {
    let mut bytes = [0; 2 * Bundle::RAYS];
    rng.fill_bytes(&mut bytes);
    std::array::from_fn(|lane| u16::from_le_bytes([bytes[2 * lane], bytes[2 * lane + 1]]))
}

impl Meter {
    pub fn new(config: &VelodyneConfig, knobs: &VelodyneKnobs) -> Self {
        let range_sd_m = config.range_sd_m * knobs.noise_ratio;
        Self {
            least_m: config.least_range_m as f32,
            greatest_m: config.greatest_range_m as f32,
            kept: (1.0 - config.dropouts - knobs.dropouts).max(0.0) as f32,
            per_half_lost_m: (1.0 / config.half_lost_range_m) as f32,
            errors_m: half_normal().map(|error| (range_sd_m * error) as f32).collect(),
        }
    }

    /// As far as rays need to be cast.
    pub fn reach_m(&self) -> f32 {
        self.greatest_m
    }

    /// Measures what a bundle's beams met. Light that comes back is reflectivity times the cosine of incidence, over the range squared: where it is
    /// as much as a white wall's at the half-lost range, every other return is seen; the odds of being seen go with its square.
    /// `biases_m` is what each lane measures too much.
    pub fn read(&self, hits: &Hits, brightness: &Light, draws: [&Draws; 2], biases_m: &Biases) -> Readings {
        let [noise, chance] = draws;
        let mut error_m = [0.0_f32; Bundle::RAYS];
        for ((error_m, draw), bias_m) in error_m.iter_mut().zip(noise).zip(biases_m) {
            let half = self.errors_m[usize::from(draw & 0x7fff)];
            *error_m = bias_m + if draw & 0x8000 == 0 { half } else { -half };
        }
        let mut readings = Readings { range_2mm: [0; Bundle::RAYS], intensity: [0; Bundle::RAYS] };
        for lane in 0..Bundle::RAYS {
            let range_m = hits.range[lane];
            let far = range_m * self.per_half_lost_m;
            // Light times far^2; the odds are light^2 : 1.
            let (seen, unseen) = (brightness[lane] * brightness[lane], far * far * far * far);
            let kept = f32::from(chance[lane]) * (seen + unseen) < 65_536.0 * self.kept * seen;
            // What met nothing is infinitely far.
            let kept = kept & (range_m >= self.least_m) & (range_m <= self.greatest_m);
            let steps = ((range_m + error_m[lane]) * PER_STEP_M + 0.5).clamp(1.0, 65_535.0);
            readings.range_2mm[lane] = if kept { steps as u16 } else { 0 };
            readings.intensity[lane] = if kept { (255.0 * brightness[lane] + 0.5) as u8 } else { 0 };
        }
        readings
    }
}

/// The half-normal distribution's quantiles in the middles of [`QUANTILES`] equally likely classes, by Newton's method from one to the next.
fn half_normal() -> impl Iterator<Item = f64> {
    let mut x = 0.0_f64;
    (0..QUANTILES).map(move |i| {
        let above = 1.0 - (i as f64 + 0.5) / QUANTILES as f64;
        for _ in 0..6 {
            // P(|X| > x) = erfc(x / sqrt 2), and its slope.
            let error = erfc(x * std::f64::consts::FRAC_1_SQRT_2) - above;
            let slope = (2.0 / std::f64::consts::PI).sqrt() * exp(-0.5 * x * x);
            x += error / slope;
        }
        x
    })
}
