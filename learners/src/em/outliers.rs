//! False sightings as part of the model: each sighting is true, or false and then of any size and bearing.

use asami_math::elementary::{exp, ln, ln_1p};

use super::filter::Weight;
use super::parameters::Parameters;
use super::world::LookMoments;
use crate::plane::Plane;

/// The share of false sightings that EM starts with.
const START: f64 = 1e-3;

/// Iterations with a smoother before sightings are judged: the starting models are no judges.
pub const UNJUDGED: u32 = 10;

/// Log-density of a false sighting: uniform over the sizes observed and the circle.
fn log_density<const N: usize>(plane: &Plane) -> f64 {
    let sizes = plane.sightings.iter().map(|seen| seen.size);
    let (least, greatest) = sizes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), o| (a.min(o), b.max(o)));
    let span = if greatest > least { greatest - least } else { 1.0 };
    -ln(span) - if N > 1 { ln(std::f64::consts::TAU) } else { 0.0 }
}

/// The next weights, the probabilities that the sightings are true, by the looks at them under the last
/// distribution of the states; and the next share of false ones, into `lambda`.
pub fn judge<const N: usize>(plane: &Plane, looks: &[LookMoments], weights: &mut [Weight], lambda: &mut Parameters<N>) {
    lambda.false_log_density = log_density::<N>(plane);
    let share = if lambda.false_share > 0.0 { lambda.false_share } else { START };
    let is_false = ln(share) + lambda.false_log_density;
    let parts = if N > 1 { 2.0 } else { 1.0 };
    let bearing_var = if N > 1 { lambda.bearing_var } else { 1.0 };
    let common = ln_1p(-share) - 0.5 * (parts * ln(std::f64::consts::TAU) + ln(lambda.size_var * bearing_var));
    let mut sum = 0.0;
    for ((seen, look), weight) in plane.sightings.iter().zip(looks).zip(weights.iter_mut()) {
        let (size, slope) = lambda.f.at(look.distance_m);
        let (e1, e2) = (size - seen.size, look.bearing_error_rad);
        let size2 = e1 * e1 + slope * slope * look.distance_var;
        let bearing2 = if N > 1 { e2 * e2 + look.bearing_var } else { 0.0 };
        let is_true = common - 0.5 * (size2 / lambda.size_var + bearing2 / bearing_var);
        let true_share = 1.0 / (1.0 + exp(is_false - is_true));
        *weight = if true_share > 1e-9 { true_share } else { 0.0 };
        sum += 1.0 - true_share;
    }
    let found = sum / weights.len() as f64;
    lambda.false_share = found.clamp(1e-6, 0.5);
}
