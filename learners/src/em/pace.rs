//! Fewer iterations: extrapolated and Newton steps, and the way back from bad ones.

use super::parameters::Parameters;
use super::run::Run;
use super::squarem::Squarem;
use super::world::World;
use super::{Acceleration, MotionNoise, information, noise};

/// How acceleration is getting on.
pub(super) struct Pace<const N: usize> {
    pub(super) squarem: Squarem<N>,
    /// The best log-likelihood since the last time that it went wrong.
    pub(super) reference: f64,
    /// Steps since then.
    pub(super) steps: u32,
    /// Whether the next E-step is made after a long step.
    pub(super) jumped: bool,
}

impl<const N: usize> Default for Pace<N> {
    fn default() -> Self {
        Self { squarem: Squarem::default(), reference: f64::NEG_INFINITY, steps: 0, jumped: false }
    }
}

impl<const N: usize, const M: usize, W: World<N, M>> Run<'_, N, M, W> {
    /// Remembers where the best parameters led, with the trajectory: a bad step must not leave its own behind, for
    /// the next sweep would be linearised about it.
    pub(super) fn keep(&mut self, next: &Parameters<N>) {
        if self.em.acceleration != Acceleration::None {
            self.kept.0.clone_from(&self.weights);
            self.kept.1.clone_from(&self.trajectory);
            self.kept.2 = Some(next.clone());
        }
    }

    /// Where to make the next E-step, after what the one at `lambda` found.
    pub(super) fn accelerated(
        &mut self,
        lambda: &Parameters<N>,
        found: Option<(f64, Parameters<N>)>,
        pace: &mut Pace<N>,
    ) -> Option<Parameters<N>> {
        let (log_likelihood, next) = match (found, &self.kept.2) {
            (Some((log_likelihood, next)), _) if log_likelihood >= pace.reference - FALLEN => (log_likelihood, next),
            (Some(found), None) => found,
            (None, None) => return None,
            // Back to the best, and slowly on from there.
            (_, Some(kept)) => {
                self.weights.clone_from(&self.kept.0);
                self.trajectory.clone_from(&self.kept.1);
                // A step of EM proper may be worse too: it is taken nevertheless.
                *pace = Pace { squarem: pace.squarem.slower(), ..Pace::default() };
                return Some(kept.clone());
            }
        };
        pace.steps += 1;
        pace.reference = pace.reference.max(log_likelihood);
        if self.em.acceleration == Acceleration::Newton && pace.steps.is_multiple_of(NEWTON_EVERY) {
            pace.squarem = Squarem::default();
            pace.jumped = true;
            return self.newton(lambda, &next).or(Some(next));
        }
        let next = pace.squarem.advance(lambda, next);
        pace.jumped = pace.squarem.far;
        next
    }

    /// The EM map's `next`, but velocities, `f` and what noise is learned where the log-likelihood's quadratic
    /// approximation at `lambda` has its maximum.
    pub(super) fn newton(&self, lambda: &Parameters<N>, next: &Parameters<N>) -> Option<Parameters<N>> {
        let trajectory = &self.trajectory;
        let information = information::information(self.problem, lambda, trajectory, &self.weights)?;
        let step = information::solve(&information, &self.score)?;
        // Far from the maximum the approximation holds for a part of the way only.
        let gain = 0.5 * asami_math::decomposition::dot(&step, &self.score);
        let part = if gain > LONGEST_GAIN { (LONGEST_GAIN / gain).sqrt() } else { 1.0 };
        let mut far = next.clone();
        far.set_means(&lambda.means().iter().zip(step).map(|(mean, step)| mean + part * step).collect::<Vec<f64>>());
        if let MotionNoise::Learned { .. } = self.em.motion {
            let steps = noise::derivatives(self.problem, lambda, trajectory, &self.weights)?.newton()?;
            far.set_noise(lambda, &steps);
        }
        Some(far)
    }
}

/// Iterations before extrapolation.
pub(super) const UNACCELERATED: u32 = 10;

/// Iterations from one Newton step to the next.
const NEWTON_EVERY: u32 = 12;

/// A Newton step that promises more, in nats, is shortened.
const LONGEST_GAIN: f64 = 100.0;

/// A likelihood that is so much worse than the best, in nats, is given up.
const FALLEN: f64 = 5.0;

/// Sweeps after a long step.
pub(super) const SWEEPS: u32 = 2;
