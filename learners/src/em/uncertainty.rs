//! How sure the learner may be of what it learned.

use asami_dataset::Models;

use super::filter::About;
use super::parameters::Parameters;
use super::run::Run;
use super::world::World;
use super::{MotionNoise, Structure, information, noise, smoother, structure};

impl<const N: usize, const M: usize, W: World<N, M>> Run<'_, N, M, W> {
    /// The models of `lambda` with standard errors, after sharing between actions where the method does.
    pub(super) fn with_errors(&mut self, mut lambda: Parameters<N>) -> Models {
        let plane = self.problem.plane;
        if let MotionNoise::Learned { .. } = self.em.motion {
            let _ = self.restrict(&mut lambda);
        }
        let Some(information) = self.information(&lambda) else { return lambda.models(plane, None) };
        if self.em.structure == Structure::Smooth
            && let Some(shared) = structure::shared(plane, N, &lambda.means(), &information)
        {
            lambda.set_means(&shared.parameters);
            return lambda
                .models(plane, Some(&information::errors(plane, &information::variances(&shared.covariance), true)));
        }
        let covariance = information::covariance(&information);
        lambda
            .models(plane, covariance.map(|c| information::errors(plane, &information::variances(&c), false)).as_ref())
    }

    /// Makes up for what the velocities have taken of the motion's noise: from the greatest likelihood to the
    /// greatest restricted likelihood (Patterson and Thompson 1971), `log p - 1/2 log det I`, in one Newton step. `I`, the
    /// information about velocities and `f`, is differentiated by differences.
    pub(super) fn restrict(&mut self, lambda: &mut Parameters<N>) -> Option<()> {
        const CHANGE: f64 = 0.1;
        let information = self.information(lambda)?;
        let covariance = information::covariance(&information)?;
        let mut derivatives = noise::derivatives(self.problem, lambda, &self.smoothed, &self.weights)?;
        derivatives.score.fill(0.0);
        for axis in 0..N {
            let mut changes = vec![0.0; N + M];
            changes[axis] = CHANGE;
            let mut other = lambda.clone();
            other.set_noise(lambda, &changes);
            let changed = information::information(self.problem, &other, &self.smoothed, &self.weights)?;
            let rows = covariance.iter().zip(changed.iter().zip(&information));
            let trace = rows.fold(0.0, |sum, (c, (a, b))| {
                sum + c.iter().zip(a.iter().zip(b)).fold(0.0, |sum, (c, (a, b))| sum + c * (a - b))
            });
            derivatives.score[axis] = -0.5 * trace / CHANGE;
        }
        let steps = derivatives.newton()?;
        let before = lambda.clone();
        lambda.set_noise(&before, &steps);
        Some(())
    }

    /// The information about the smoothed trajectory of `lambda`; of units that the log leaves open, as if they
    /// were agreed on.
    pub(super) fn information(&mut self, lambda: &Parameters<N>) -> Option<information::Information> {
        self.smooth(lambda)?;
        let mut information = information::information(self.problem, lambda, &self.smoothed, &self.weights)?;
        for free in lambda.free_units() {
            information::agree(&mut information, &free);
        }
        Some(information)
    }

    /// Leaves the states given all data in `smoothed`: one filter, linearised about itself, and a smoother.
    pub(super) fn smooth(&mut self, lambda: &Parameters<N>) -> Option<()> {
        let (problem, weights) = (self.problem, &mut self.weights);
        self.forward.run(problem, lambda, About::Own, weights, false)?;
        smoother::backward(problem, lambda, About::Own, &self.forward, weights, &mut self.smoothed, None)
    }
}
