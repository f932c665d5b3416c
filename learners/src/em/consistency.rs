//! Whether models know their own noise: the innovations of a filter with them, against what it expects of them
//! (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).

use asami_dataset::{Log, Models};
use nalgebra::{SMatrix, SVector};

use super::field::Field;
use super::filter::{noise, step, update};
use super::parameters::{Parameters, given_sensor};
use super::start;
use super::world::{Problem, World};
use crate::plane::Plane;

/// Frames that the filter is given to find the robot.
const SETTLING_FRAMES: usize = 300;

/// Mean of the innovations squared, normalised by the covariance that an extended Kalman filter in the plane
/// expects of them, by their two degrees of freedom: 1 where the models are right. `None` where the models do not fit the
/// log, or the filter breaks down.
#[must_use]
pub fn nis_in_plane(log: &Log, models: &Models) -> Option<f64> {
    let plane = Plane::try_from(log).ok()?;
    let world = Field { sensor_origin_m: plane.sensor_origin_m };
    let sensor = given_sensor(&plane, models).ok()?;
    let f = start::curve_in_plane(&plane, &sensor, sensor.coefficients.len());
    let mut lambda = Parameters::given(&plane, models, f, start::nowhere()).ok()?;
    lambda.prior = start::prior_in_plane(&world, &plane, &lambda);
    nis(Problem { world: &world, plane: &plane }, &lambda)
}

fn nis<const N: usize, const M: usize, W: World<N, M>>(problem: Problem<'_, W>, lambda: &Parameters<N>) -> Option<f64> {
    let Problem { world, plane } = problem;
    let mut state = lambda.prior;
    let r = noise(lambda, 1.0, 1);
    let (mut sum, mut count) = (0.0, 0.0);
    for t in 0..plane.frames.len() {
        for seen in plane.seen(t) {
            let (e, h): (SVector<f64, M>, _) = world.innovation(&state.mean, seen, &lambda.f);
            if t >= SETTLING_FRAMES {
                // e^T S^-1 e with S = H P H^T + R
                let s = h * state.covariance * h.transpose() + SMatrix::from_diagonal(&r);
                sum += e.dot(&s.try_inverse()?.tr_mul(&e));
                count += M as f64;
            }
            update(&mut state, &e, &h, &r)?;
        }
        let (mu, q) = step(plane, lambda, t);
        let moved = world.forth(&state.mean, &mu, &q);
        state.mean = moved.to;
        state.covariance = moved.f * state.covariance * moved.f.transpose() + moved.q;
    }
    let nis = sum / count;
    nis.is_finite().then_some(nis)
}
