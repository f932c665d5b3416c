//! The backward pass of Rauch, Tung and Striebel (1965): one filter, no vague start.

use asami_math::kalman::Gaussian;
use nalgebra::SVector;

use super::filter::{Forward, Weight};
use super::sums::Sums;
use super::world::{Pair, World};
use crate::plane::Plane;

/// Gives every `gamma_t` and pair to `sums`, last frame first, and leaves the smoothed means in `trajectory`.
/// `None` if the smoother breaks down.
pub fn backward<const N: usize, const M: usize, W: World<N, M>>(
    world: &W,
    plane: &Plane,
    forward: &Forward<N>,
    weights: &[Weight],
    trajectory: &mut [SVector<f64, N>],
    mut sums: Option<&mut Sums<'_, N>>,
) -> Option<()> {
    let mut end = weights.len();
    let mut next: Option<Gaussian<N>> = None;
    for t in (0..forward.alpha.len()).rev() {
        let alpha = &forward.alpha[t];
        let gamma = match &next {
            None => *alpha,
            Some(next) => {
                // G = P F^T P'^-1; mean and covariance given all data (Rauch, Tung and Striebel 1965).
                let predicted = &forward.predicted[t + 1];
                let gain = alpha.covariance * forward.moved[t].f.transpose() * world.inverse(&predicted.covariance);
                let more = next.covariance - predicted.covariance;
                let gamma = Gaussian {
                    mean: alpha.mean + gain * world.difference(&next.mean, &predicted.mean),
                    covariance: alpha.covariance + gain * more * gain.transpose(),
                };
                if let Some(sums) = &mut sums {
                    let cross = next.covariance * gain.transpose();
                    sums.pair(world, plane, t, &Pair { now: gamma, next: *next, cross });
                }
                gamma
            }
        };
        if !gamma.mean.iter().all(|x| x.is_finite()) {
            return None;
        }
        trajectory[t] = gamma.mean;
        let seen = plane.seen(t);
        let own = end - seen.len()..end;
        end = own.start;
        if let Some(sums) = &mut sums
            && (!seen.is_empty() || t == 0)
        {
            sums.frame(world, t, &gamma, seen, own.clone(), &weights[own])?;
        }
        next = Some(gamma);
    }
    Some(())
}
