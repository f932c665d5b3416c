//! How well anything could learn chapter 4's models from a log: the Cramer-Rao bound.
//!
//! A reference, not a learner: it is told where the robot was and what the models are.

use asami_dataset::{Log, Models};
use asami_math::decomposition::{cholesky, cholesky_solve, dot};
use asami_math::polynomial::powers;

use super::joint::{Change, Estimate, Hold, Joint, KINDS};
use super::vague;
use crate::em::curve::SizeCurve;
use crate::em::parameters::{Parameters, given_sensor};
use crate::em::start;
use crate::learner::CannotLearn;
use crate::plane::Plane;

/// Least standard errors of unbiased estimators that are told nothing but the log.
#[derive(Clone, Debug)]
pub struct PlaneBound {
    /// Of each action's velocity, in order of id: right and forward in m/s, counter-clockwise in rad/s.
    pub velocities: Vec<(u16, [f64; 3])>,
    /// Of the noise, as a share of itself: size, bearing, motion rightward, forward, turn. All of them unknown.
    pub noise_shares: [f64; KINDS],
    /// The true sensor's basis, and the least covariance of its coefficients.
    sensor: (SizeCurve, Vec<Vec<f64>>),
}

impl PlaneBound {
    /// Root mean square over the actions, of each of the three velocities.
    #[must_use]
    pub fn velocity_rms(&self) -> [f64; 3] {
        let n = self.velocities.len().max(1) as f64;
        std::array::from_fn(|i| (self.velocities.iter().fold(0.0, |sum, (_, se)| sum + se[i] * se[i]) / n).sqrt())
    }

    /// Of the sensor's value at a distance, px or m.
    #[must_use]
    pub fn sensor_at(&self, distance_m: f64) -> f64 {
        let (f, covariance) = &self.sensor;
        let by = powers(f.scaled(distance_m), f.n - 1);
        covariance.iter().zip(&by).fold(0.0, |sum, (row, by_i)| sum + by_i * dot(row, &by)).max(0.0).sqrt()
    }
}

/// The bound for `log`, by the expected information of the residuals linearised along the true trajectory.
///
/// `pose_at` gives the true x, y in m and heading in rad at a time, `truth` the true models: a velocity for each
/// action, a sensor of the degree that is learned, and the noise, that of motion included. The information of
/// Gaussian noise has no part in common with that of means, so that velocities are bounded alike whether the
/// noise is known or not (Kay 1993, "Fundamentals of Statistical Signal Processing", eq. 3.31).
///
/// # Errors
/// What the log or `truth` lacks.
pub fn plane_bound(
    log: &Log,
    pose_at: impl Fn(f64) -> Option<[f64; 3]>,
    truth: &Models,
) -> Result<PlaneBound, CannotLearn> {
    let plane = Plane::try_from(log)?;
    let f = given_sensor(&plane, truth)?;
    let f = SizeCurve::new(&f, f.coefficients.len(), f.centre, f.scale);
    let lambda = Parameters::given(&plane, truth, f, start::nowhere())?;
    let poses: Option<Vec<[f64; 3]>> = plane.frames.iter().map(|frame| pose_at(frame.t_s)).collect();
    let poses = poses.ok_or(CannotLearn::NotGiven("the true pose at every frame"))?;
    let joint = Joint::new(&plane, &lambda, vague(&plane, f.n));
    let estimate = Estimate::of(&lambda, poses);
    let undetermined = || CannotLearn::Undetermined("the information is not positive definite".to_string());
    bound(&joint, &estimate, f).ok_or_else(undetermined)
}

fn bound(joint: &Joint, truth: &Estimate, sensor: SizeCurve) -> Option<PlaneBound> {
    let mut system = joint.system()?;
    let hold = Hold { poses: 0.0, sensor: false };
    system.factorise(&joint.pull(truth), |t, link| joint.fill(truth, hold, t, link))?;
    let covariance = system.border_inverse();
    let se = |i: usize| covariance[i][i].max(0.0).sqrt();
    let actions = joint.plane.actions.iter().enumerate();
    let velocities = actions.filter_map(|(a, action)| Some((action.id?, [0, 1, 2].map(|i| se(3 * a + i))))).collect();
    let first = 3 * joint.plane.actions.len();
    let of_sensor = covariance[first..].iter().map(|row| row[first..].to_vec()).collect();
    Some(PlaneBound { velocities, noise_shares: noise_shares(joint, truth)?, sensor: (sensor, of_sensor) })
}

/// Standard errors of the noise as shares of itself, by kind.
pub(super) fn noise_shares(joint: &Joint, estimate: &Estimate) -> Option<[f64; KINDS]> {
    let factor = cholesky(&noise_information(joint, estimate)?)?;
    Some(std::array::from_fn(|i| {
        let unit: Vec<f64> = (0..KINDS).map(|j| f64::from(u8::from(i == j))).collect();
        // Of ln sigma: half that of ln sigma^2.
        0.5 * cholesky_solve(&factor, &unit)[i].max(0.0).sqrt()
    }))
}

/// Expected information of the logarithms of the variances, poses and parameters unknown:
/// `tr(M D_i M D_j) / 2` with `M = I - P` for the rows' hat matrix `P` (Patterson and Thompson 1971).
pub(super) fn noise_information(joint: &Joint, truth: &Estimate) -> Option<Vec<Vec<f64>>> {
    const STEP: f64 = 1e-3;
    let still = Change { poses: vec![[0.0; 3]; truth.poses.len()], parameters: vec![0.0; truth.parameters.len()] };
    let mut system = joint.system()?;
    let mut leverage = |kind: usize, step: f64| {
        let mut moved = truth.clone();
        moved.variances[kind] *= asami_math::elementary::exp(-step);
        let hold = Hold { poses: 0.0, sensor: false };
        system.factorise(&joint.pull(&moved), |t, link| joint.fill(&moved, hold, t, link))?;
        Some(joint.sums(&moved, &system, &still).0)
    };
    let here = leverage(0, 0.0)?;
    let mut columns = Vec::with_capacity(KINDS);
    for j in 0..KINDS {
        let (after, before) = (leverage(j, STEP)?, leverage(j, -STEP)?);
        let entry = |i: usize| {
            // d tr(P D_i) / d ln lambda_j = [i = j] tr(P D_i) - tr(P D_i P D_j).
            let slope = (after.leverage[i] - before.leverage[i]) / (2.0 * STEP);
            let own = if i == j { here.count[i] - here.leverage[i] } else { 0.0 };
            0.5 * (own - slope)
        };
        columns.push((0..KINDS).map(entry).collect::<Vec<f64>>());
    }
    // Symmetric but for the differences' rounding.
    Some((0..KINDS).map(|i| (0..KINDS).map(|j| 0.5 * (columns[i][j] + columns[j][i])).collect()).collect())
}
