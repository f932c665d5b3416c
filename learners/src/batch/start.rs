//! Where the joint estimate starts: a filter and a smoother under the starting models (Stronger 2008, section
//! 4.2, with the smoother of Rauch, Tung and Striebel 1965), and what the smoothed poses say of the models.

use asami_dataset::{ActionModel, Models, SensorModel};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use asami_math::kalman::{Gaussian, Motion, Observation};
use asami_math::polynomial::Polynomial;
use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use super::joint::KINDS;
use crate::learner::CannotLearn;
use crate::line::Unit;
use crate::plane::{Plane, Seen};
use crate::view::View;

/// The models that a learner in the plane starts from, as numbers.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// Of each action of the log: right, forward, counter-clockwise.
    pub(crate) velocities: Vec<[f64; 3]>,
    /// Height or range of distance.
    pub(crate) sensor: Polynomial,
    /// Variances of size, bearing, and the three of motion in a step of median length.
    pub(crate) variances: [f64; KINDS],
}

impl Start {
    /// The given models in the log's terms; actions without an entry stand still.
    pub(crate) fn given(plane: &Plane, given: &Models) -> Result<Self, CannotLearn> {
        let Some(ActionModel::Table(table)) = &given.action else {
            return Err(CannotLearn::NotGiven("a table of velocities to start from"));
        };
        let (sensor, sigma1) = match (&given.sensor, plane.unit) {
            (Some(SensorModel::HeightOfDistance(f)), Unit::HeightPx) => (f, given.noise.sigma1_px),
            (Some(SensorModel::RangeOfDistance(f)), Unit::RangeM) => (f, given.noise.sigma1_m),
            _ => return Err(CannotLearn::NotGiven("a sensor model of what the log holds, heights or ranges")),
        };
        let (Some(sigma1), Some(sigma2), Some(motion)) = (sigma1, given.noise.sigma2_rad, given.noise.motion_sd) else {
            return Err(CannotLearn::NotGiven("the noise of size, bearing and motion to start from"));
        };
        let velocities = plane.actions.iter().map(|action| {
            let entry = table.iter().find(|entry| Some(entry.action) == action.id);
            entry.map_or([0.0; 3], |entry| [entry.vx_m_per_s, entry.vy_m_per_s, entry.vtheta_rad_per_s])
        });
        let sds = [sigma1, sigma2, motion[0], motion[1], motion[2]];
        if sds.iter().any(|sd| *sd <= 0.0 || !sd.is_finite()) {
            return Err(CannotLearn::NotGiven("noise greater than zero"));
        }
        Ok(Self {
            velocities: velocities.collect(),
            sensor: sensor.polynomial.clone(),
            variances: sds.map(|sd| sd * sd),
        })
    }
}

/// Motion under `velocity` for one frame, linearised at a pose.
pub(crate) fn motion(start: &Start, plane: &Plane, t: usize, w: &Vector3<f64>) -> Motion<3> {
    let frame = &plane.frames[t];
    let v = start.velocities[frame.action].map(|v| v * frame.dt_s);
    let (sin, cos) = sin_cos(w[2]);
    let (dx, dy) = (cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]);
    let f = Matrix3::new(1.0, 0.0, -dy, 0.0, 1.0, dx, 0.0, 0.0, 1.0);
    let r = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    let steps = (frame.dt_s / plane.step_s).max(1e-3);
    let own = Vector3::new(start.variances[2], start.variances[3], start.variances[4]) * steps;
    let q = r * Matrix3::from_diagonal(&own) * r.transpose();
    Motion { f, drift: w + Vector3::new(dx, dy, v[2]) - f * w, q }
}

/// A sighting, linearised at a pose.
pub(crate) fn observation(start: &Start, plane: &Plane, seen: &Seen, w: &Vector3<f64>) -> Observation<3, 2> {
    let view = View::of(&[w[0], w[1], w[2]], seen.landmark_m, plane.sensor_origin_m);
    let slope = start.sensor.slope_at(view.distance_m);
    let h = Matrix2x3::from_fn(|i, k| if i == 0 { slope * view.distance_by[k] } else { view.bearing_by[k] });
    let innovation =
        Vector2::new(seen.size - start.sensor.at(view.distance_m), wrap_rad(seen.bearing_rad - view.bearing_rad));
    let r = Matrix2::from_diagonal(&Vector2::new(start.variances[0], start.variances[1]));
    Observation { h, y: innovation + h * w, r }
}

/// The smoothed track under the models as they are.
pub(crate) struct Track {
    /// Poses given all data.
    pub(crate) poses: Vec<Vector3<f64>>,
}

struct Filtered {
    states: Vec<Gaussian<3>>,
    motions: Vec<Motion<3>>,
    log_likelihood: f64,
}

/// The first `frames` frames, filtered from `prior` on. Sightings far off are trusted less.
fn filter(start: &Start, plane: &Plane, prior: Gaussian<3>, frames: usize) -> Option<Filtered> {
    let mut filtered =
        Filtered { states: Vec::with_capacity(frames), motions: Vec::with_capacity(frames), log_likelihood: 0.0 };
    let mut state = prior;
    for t in 0..frames {
        if t > 0 {
            let motion = motion(start, plane, t - 1, &state.mean);
            state = state.predict(&motion);
            filtered.motions.push(motion);
        }
        for seen in plane.seen(t) {
            let mut one = observation(start, plane, seen, &state.mean);
            let update = state.update(&one)?;
            let far = update.nis / FAR_NIS;
            filtered.log_likelihood += update.log_likelihood() + 0.5 * (update.nis - update.nis.min(FAR_NIS));
            state = if far > 1.0 {
                one.r *= far;
                state.update(&one)?.state
            } else {
                update.state
            };
        }
        filtered.states.push(state);
    }
    Some(filtered)
}

/// Squared Mahalanobis length beyond which a sighting counts as far off.
const FAR_NIS: f64 = 9.0;

/// Sightings that the first pose is judged by.
const JUDGES: usize = 80;

/// The pose of a grid over the landmarks' rectangle under which the first sightings are most likely.
pub(crate) fn first_pose(start: &Start, plane: &Plane) -> Option<Gaussian<3>> {
    const CELLS: usize = 5;
    const HEADINGS: usize = 12;
    let places = plane.landmarks();
    let bounds = |k: usize| {
        let along = places.values().map(|place| place[k]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        // Landmarks in one place or in a row: some room beside them.
        (0.5 * (low + high), (0.5 * (high - low)).max(1.0))
    };
    let ((x_m, wide_m), (y_m, long_m)) = (bounds(0), bounds(1));
    let turn = std::f64::consts::TAU / HEADINGS as f64;
    let at = |i: usize, middle: f64, reach: f64| middle + reach * ((2 * i + 1) as f64 / CELLS as f64 - 1.0);
    let sd = Vector3::new(wide_m / CELLS as f64, long_m / CELLS as f64, 0.5 * turn);
    let covariance = Matrix3::from_diagonal(&sd.component_mul(&sd));
    let seen = (0..plane.frames.len()).scan(0, |found, t| {
        *found += plane.seen(t).len();
        Some(*found)
    });
    let frames = seen.take_while(|found| *found < JUDGES).count().min(plane.frames.len() - 1) + 1;
    let mut best: Option<(f64, Gaussian<3>)> = None;
    for i in 0..CELLS * CELLS * HEADINGS {
        let heading = turn * (i / (CELLS * CELLS)) as f64;
        let mean = Vector3::new(at(i % CELLS, x_m, wide_m), at(i / CELLS % CELLS, y_m, long_m), heading);
        let prior = Gaussian { mean, covariance };
        let Some(tried) = filter(start, plane, prior, frames) else { continue };
        if best.as_ref().is_none_or(|best| tried.log_likelihood > best.0) {
            best = Some((tried.log_likelihood, prior));
        }
    }
    best.map(|best| best.1)
}

/// All poses given all data, from `prior` on.
pub(crate) fn smoothed(start: &Start, plane: &Plane, prior: Gaussian<3>) -> Option<Track> {
    let filtered = filter(start, plane, prior, plane.frames.len())?;
    let mut state = *filtered.states.last()?;
    let mut poses = vec![state.mean];
    for (before, motion) in filtered.states.iter().zip(&filtered.motions).rev() {
        state = before.smooth(motion, &state)?.0;
        poses.push(state.mean);
    }
    poses.reverse();
    Some(Track { poses })
}

/// Velocities that the smoothed poses show: the mean displacement in the robot's frame, by action.
pub(crate) fn velocities(track: &Track, plane: &Plane) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 4]; plane.actions.len()];
    for (t, pair) in track.poses.windows(2).enumerate() {
        let frame = &plane.frames[t];
        let d = pair[1] - pair[0];
        let (sin, cos) = sin_cos(pair[0][2]);
        let moved = [cos * d[0] + sin * d[1], cos * d[1] - sin * d[0], wrap_rad(d[2]), frame.dt_s];
        for (sum, x) in sums[frame.action].iter_mut().zip(moved) {
            *sum += x;
        }
    }
    sums.iter().map(|[x, y, turn, s]| if *s > 0.0 { [x / s, y / s, turn / s] } else { [0.0; 3] }).collect()
}
