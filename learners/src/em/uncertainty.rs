//! How sure the learner may be of what it learned.

use asami_dataset::models::NoiseErrors;
use asami_dataset::{Models, Noise};
use asami_math::decomposition::{cholesky, cholesky_solve};

use super::filter::About;
use super::parameters::{Parameters, axes};
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
        let shares = self.noise_shares(&lambda);
        let shared = (self.em.structure == Structure::Smooth)
            .then(|| structure::shared(plane, N, &lambda.means(), &information))
            .flatten();
        let variances = match &shared {
            Some(shared) => {
                lambda.set_means(&shared.parameters);
                Some(information::variances(&shared.covariance))
            }
            None => information::covariance(&information).map(|c| information::variances(&c)),
        };
        let errors = variances.map(|variances| information::errors(plane, &variances, shared.is_some()));
        let mut models = lambda.models(plane, errors.as_ref());
        models.noise.se =
            shares.map_or_else(NoiseErrors::default, |shares| errors_of_noise::<N>(&models.noise, &shares));
        models
    }

    /// Standard errors of the noise as shares of itself: of the motion along each axis, where it is learned, then of size
    /// and bearing. About the trajectory smoothed last.
    fn noise_shares(&self, lambda: &Parameters<N>) -> Option<Vec<Option<f64>>> {
        let derivatives = noise::derivatives(self.problem, lambda, &self.smoothed, &self.weights)?;
        let given = if self.em.motion == MotionNoise::Given { N } else { 0 };
        let information: Vec<Vec<f64>> =
            derivatives.information[given..].iter().map(|row| row[given..].to_vec()).collect();
        let l = cholesky(&information)?;
        // Of ln sigma: half that of ln sigma^2.
        let share = |i: usize| {
            let unit: Vec<f64> = (0..information.len()).map(|k| f64::from(u8::from(k == i))).collect();
            Some(0.5 * cholesky_solve(&l, &unit)[i].max(0.0).sqrt()).filter(|share| share.is_finite())
        };
        Some(std::iter::repeat_n(None, given).chain((0..information.len()).map(share)).collect())
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

/// Standard errors of noise, out of their shares of it.
fn errors_of_noise<const N: usize>(noise: &Noise, shares: &[Option<f64>]) -> NoiseErrors {
    let of = |value: Option<f64>, i: usize| Some(value? * shares.get(i).copied().flatten()?);
    let motion_sd = noise.motion_sd.filter(|_| shares[..N].iter().all(Option::is_some)).map(|sd| {
        let mut se = [0.0; 3];
        for (i, axis) in axes::<N>().into_iter().enumerate() {
            se[axis] = of(Some(sd[axis]), i).unwrap_or(0.0);
        }
        se
    });
    NoiseErrors {
        sigma1: of(noise.sigma1_px.or(noise.sigma1_m), N),
        sigma2_rad: of(noise.sigma2_rad, N + 1),
        motion_sd,
    }
}
