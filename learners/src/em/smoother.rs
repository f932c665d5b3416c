//! The backward pass of Rauch, Tung and Striebel (1965): one filter, no vague start.

use asami_math::kalman::Gaussian;
use nalgebra::SVector;

use super::filter::{About, Forward, Weight, step};
use super::parameters::Parameters;
use super::sums::Sums;
use super::world::{Moved, Pair, Problem, World};

/// Gives every `gamma_t` and pair to `sums`, last frame first, and leaves the states in `smoothed`; `about`
/// is what the forward sweep was linearised about.
/// `None` if the smoother breaks down.
pub fn backward<const N: usize, const M: usize, W: World<N, M>>(
    problem: Problem<'_, W>,
    lambda: &Parameters<N>,
    about: About<'_, N>,
    forward: &Forward<N>,
    weights: &[Weight],
    smoothed: &mut [Gaussian<N>],
    mut sums: Option<&mut Sums<'_, N>>,
) -> Option<()> {
    let Problem { world, plane } = problem;
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
                    let pair = Pair { now: gamma, next: *next, cross };
                    let (d, d2) = match about {
                        About::States(_) => world.displacement_moments(&pair),
                        About::Own | About::Means(_) => {
                            let (mu, _) = step(plane, lambda, t);
                            displaced(world, &pair, &forward.moved[t], &about.mean(t, &alpha.mean), &mu)
                        }
                    };
                    sums.displacement(plane, t, &d, &d2);
                }
                gamma
            }
        };
        if !gamma.mean.iter().all(|x| x.is_finite()) {
            return None;
        }
        smoothed[t] = gamma;
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

/// `E D` and `E D^2` as the linearised motion has them: with `e = w' - g(at) - F (w - at)` what it leaves over,
/// `D = mu + R(-theta) e`. (D proper of the same states has a term of second order in the heading's uncertainty, which
/// the linearised motion lacks: steps would grow a little with every iteration.)
fn displaced<const N: usize, const M: usize, W: World<N, M>>(
    world: &W,
    pair: &Pair<N>,
    moved: &Moved<N>,
    at: &SVector<f64, N>,
    mu: &SVector<f64, N>,
) -> (SVector<f64, N>, SVector<f64, N>) {
    let (now, next) = (&pair.now, &pair.next);
    let e = world.difference(&next.mean, &moved.to) - moved.f * world.difference(&now.mean, at);
    let f_cross = moved.f * pair.cross.transpose();
    let var = next.covariance + moved.f * now.covariance * moved.f.transpose() - f_cross - f_cross.transpose();
    let to_robot = world.axes(at).transpose();
    let mean = mu + to_robot * e;
    (mean, mean.component_mul(&mean) + (to_robot * var * to_robot.transpose()).diagonal())
}
