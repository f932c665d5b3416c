//! Both models, all noise and all poses at once, by Gauss-Newton on the bordered normal equations: where
//! expectation-maximisation takes hundreds of passes, tens of solves.

mod bound;
mod joint;
mod noise;
mod rows;
mod search;
mod spread;
#[cfg(test)]
mod tests;

use asami_dataset::models::NoiseErrors;
use asami_dataset::{Log, Models, Rng};
use asami_math::kalman::Gaussian;

use crate::em::parameters::Parameters;
use crate::em::{self, information, start};
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::plane::Plane;
pub use bound::{PlaneBound, plane_bound};
use joint::{Estimate, Joint};
use search::Search;

learner! {
    /// Poses, velocities, sensor and noise by the marginal likelihood: expectations over the poses are taken
    /// around the joint estimate, and noise is learned with all of that integrated out.
    ///
    /// Starts from a few iterations of EM. Standard errors are those of the parameters'
    /// Schur complement, the poses unknown too.
    Batch, "batch",
    "Learns both models and all noise at once, by Gauss-Newton on a trajectory with unknown models.",
    source "Barfoot, Forbes and Yoon 2020 (poses); Johnson and Thompson 1995 (noise)", needs Both,
    {
        /// Degree of f, a polynomial of the distance.
        degree: u32 = 3, "1", 1.0..=5.0;
        /// Iterations of EM for the velocities, before all is solved at once.
        first_iterations: u32 = 6, "1", 1.0..=1000.0;
        /// Share of false sightings to begin with, of any size and bearing; 0: there are none.
        false_share: f64 = 0.0, "1", 0.0..=0.5;
        /// Greatest number of solves.
        max_iterations: u32 = 100, "1", 1.0..=10000.0;
        /// Stops when a solve promises less, in nats.
        tolerance: f64 = 0.05, "nat", 0.000001..=100.0;
    }
}

impl Learner for Batch {
    fn learn(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let plane = Plane::try_from(log)?;
        let lambda = start::in_plane(&plane, given, self.degree as usize + 1)?;
        let broke = || CannotLearn::Undetermined("the sightings do not tell where the robot was".to_string());
        let (lambda, states) = em::warmed(&plane, lambda, self.first_iterations, rng);
        let joint = Joint::new(&plane, &lambda, vague(&plane, lambda.f.n));
        let mut search = Search::new(self, joint, Estimate::of(&lambda, poses(&states))).ok_or_else(broke)?;
        let verdict = search.climb();
        let errors = information::errors(&plane, &information::variances(&search.system.border_inverse()), true);
        let mut models = search.joint.parameters(&search.estimate).models(&plane, Some(&errors));
        if let Some(shares) = bound::noise_shares(&search.joint, &search.estimate) {
            let [sigma1, sigma2_rad, motion_sd @ ..]: [f64; 5] =
                std::array::from_fn(|kind| shares[kind] * search.estimate.variances[kind].sqrt());
            models.noise.se =
                NoiseErrors { sigma1: Some(sigma1), sigma2_rad: Some(sigma2_rad), motion_sd: Some(motion_sd) };
        }
        Ok(Learned {
            models,
            verdict,
            iterations: Some(search.solves),
            lacks: em::lacks(&plane, given, false),
            history: search.history,
            ..Learned::default()
        })
    }
}

/// How vaguely velocities are known beforehand: an action that was never executed keeps this as its error.
const VELOCITY_SD: f64 = 10.0;
/// How vaguely the sensor's coefficients are known beforehand, px or m.
const SENSOR_SD: f64 = 1e3;

/// Information and mean of all parameters beforehand: next to none.
fn vague(plane: &Plane, coefficients: usize) -> Vec<[f64; 2]> {
    let velocities = std::iter::repeat_n([1.0 / (VELOCITY_SD * VELOCITY_SD), 0.0], 3 * plane.actions.len());
    velocities.chain(std::iter::repeat_n([1.0 / (SENSOR_SD * SENSOR_SD), 0.0], coefficients)).collect()
}

impl Estimate {
    /// The models of `lambda` at these poses.
    fn of(lambda: &Parameters<3>, poses: Vec<[f64; 3]>) -> Self {
        let motion = lambda.motion_var.first().map_or([1.0; 3], |var| [var[0], var[1], var[2]]);
        Self {
            poses,
            parameters: lambda.means(),
            variances: [lambda.size_var, lambda.bearing_var, motion[0], motion[1], motion[2]],
        }
    }
}

/// The means of states.
fn poses(states: &[Gaussian<3>]) -> Vec<[f64; 3]> {
    states.iter().map(|state| [state.mean[0], state.mean[1], state.mean[2]]).collect()
}
