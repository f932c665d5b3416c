//! Both models, all noise and all poses at once, by Gauss-Newton on the bordered normal equations: where
//! expectation-maximisation takes hundreds of passes, tens of solves.

mod bound;
mod joint;
mod noise;
mod search;
mod spread;
pub(crate) mod start;
#[cfg(test)]
mod tests;

use asami_dataset::models::{Curve, Entry};
use asami_dataset::{ActionModel, Log, Models, Noise, Rng, SensorModel};

use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::line::Unit;
use crate::plane::Plane;
pub use bound::{PlaneBound, plane_bound};
use joint::{Estimate, Joint};
use search::Search;
use start::Start;

learner! {
    /// Poses, velocities, sensor and noise by the marginal likelihood: expectations over the poses are taken
    /// around the joint estimate, and noise is learned with all of that integrated out.
    ///
    /// Starts from a filter and smoother under the given models. Standard errors are those of the parameters'
    /// Schur complement, the poses unknown too.
    Batch, "batch",
    "Learns both models and all noise at once, by Gauss-Newton on a trajectory with unknown models.",
    source "Barfoot, Forbes and Yoon 2020 (poses); Johnson and Thompson 1995 (noise)", needs Both,
    {
        /// Degree of the sensor model, a polynomial of distance.
        sensor_degree: u32 = 3, "1", 1.0..=8.0;
        /// Passes of the smoother before all is solved at once.
        first_passes: u32 = 2, "1", 1.0..=50.0;
        /// Share of false sightings to begin with, of any size and bearing; 0: there are none.
        false_share: f64 = 0.0, "1", 0.0..=0.5;
        /// Greatest number of solves.
        max_iterations: u32 = 100, "1", 1.0..=10000.0;
        /// Stops when a solve promises less, in nats.
        tolerance: f64 = 0.05, "nat", 0.000001..=100.0;
    }
}

impl Learner for Batch {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let plane = Plane::try_from(log)?;
        let start = Start::given(&plane, given)?;
        plane.require(self.sensor_degree as usize + 4)?;
        let broke = || CannotLearn::Undetermined("the sightings do not tell where the robot was".to_string());
        let (estimate, joint) = self.start(&plane, start).ok_or_else(broke)?;
        let mut search = Search::new(self, joint, estimate).ok_or_else(broke)?;
        let verdict = search.climb();
        Ok(Learned {
            models: models(&search.joint, &search.estimate, Some(&search.system.border_inverse())),
            verdict,
            iterations: Some(search.solves),
            lacks: plane.lacks(false),
            history: search.history,
            ..Learned::default()
        })
    }
}

/// How vaguely velocities are known beforehand: an action that was never executed keeps this as its error.
const VELOCITY_SD: f64 = 10.0;
/// How vaguely the sensor's coefficients are known beforehand, px or m.
const SENSOR_SD: f64 = 1e3;

impl Batch {
    /// Smoothed poses, and the velocities that these show.
    fn start<'a>(&self, plane: &'a Plane, mut start: Start) -> Option<(Estimate, Joint<'a>)> {
        if plane.frames.len() < 2 {
            return None;
        }
        let prior = start::first_pose(&start, plane)?;
        let mut track = start::smoothed(&start, plane, prior)?;
        for _pass in 1..self.first_passes {
            start.velocities = start::velocities(&track, plane);
            track = start::smoothed(&start, plane, prior)?;
        }
        let poses: Vec<[f64; 3]> = track.poses.iter().map(|w| [w[0], w[1], w[2]]).collect();
        let (centre_m, scale_m) = distances(plane);
        let mut sensor = start.sensor.rebased(centre_m, scale_m).coefficients;
        sensor.resize(self.sensor_degree as usize + 1, 0.0);
        let parameters: Vec<f64> = start.velocities.iter().flatten().copied().chain(sensor).collect();
        let prior = vague(start.velocities.len(), self.sensor_degree as usize + 1);
        let joint = Joint::new(plane, centre_m, scale_m, prior);
        Some((Estimate { poses, parameters, variances: start.variances }, joint))
    }
}

/// Information and mean of all parameters beforehand: next to none.
fn vague(actions: usize, coefficients: usize) -> Vec<[f64; 2]> {
    let velocities = std::iter::repeat_n([1.0 / (VELOCITY_SD * VELOCITY_SD), 0.0], 3 * actions);
    velocities.chain(std::iter::repeat_n([1.0 / (SENSOR_SD * SENSOR_SD), 0.0], coefficients)).collect()
}

/// Centre and half the span of the distances at which a robot among the landmarks may see them.
pub(crate) fn distances(plane: &Plane) -> (f64, f64) {
    let places = plane.landmarks();
    let span = |k: usize| {
        let along = places.values().map(|place| place[k]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        high - low
    };
    let half = (0.5 * (span(0) * span(0) + span(1) * span(1)).sqrt()).max(0.5);
    (half, half)
}

/// An estimate as models, with standard errors where a covariance of the parameters is given.
fn models(joint: &Joint, estimate: &Estimate, covariance: Option<&[Vec<f64>]>) -> Models {
    let plane = joint.plane;
    let se = |i: usize| covariance.map(|covariance| covariance[i][i].max(0.0).sqrt());
    let table = plane.actions.iter().enumerate().filter_map(|(a, action)| {
        let v = &estimate.parameters[3 * a..3 * a + 3];
        Some(Entry {
            action: action.id?,
            vx_m_per_s: v[0],
            vy_m_per_s: v[1],
            vtheta_rad_per_s: v[2],
            se: se(3 * a).zip(se(3 * a + 1)).zip(se(3 * a + 2)).map(|((x, y), turn)| [x, y, turn]),
        })
    });
    let first = 3 * plane.actions.len();
    let curve = Curve { se: (first..joint.prior.len()).filter_map(se).collect(), polynomial: joint.sensor(estimate) };
    let sd = estimate.variances.map(f64::sqrt);
    let noise = Noise { sigma2_rad: Some(sd[1]), motion_sd: Some([sd[2], sd[3], sd[4]]), ..Noise::default() };
    let (sensor, noise) = match plane.unit {
        Unit::HeightPx => (SensorModel::HeightOfDistance(curve), Noise { sigma1_px: Some(sd[0]), ..noise }),
        Unit::RangeM => (SensorModel::RangeOfDistance(curve), Noise { sigma1_m: Some(sd[0]), ..noise }),
    };
    Models { action: Some(ActionModel::Table(table.collect())), sensor: Some(sensor), noise }
}
