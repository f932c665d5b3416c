//! What the filters that learn as they go share: where they start, how they linearise, what they give.

use asami_dataset::models::{Curve, Entry};
use asami_dataset::{ActionModel, Models, Noise, SensorModel};
use asami_math::angle::wrap_rad;
use asami_math::elementary::ln;
use asami_math::polynomial::Polynomial;

use crate::batch::start::{Start, first_pose};
use crate::learner::{CannotLearn, Learned, Step, Verdict};
use crate::line::Unit;
use crate::plane::{Plane, Seen};
use crate::view::View;

/// How sure the filters are beforehand.
pub(crate) struct Belief {
    pub(crate) sensor_degree: usize,
    pub(crate) velocity_sd: [f64; 3],
    pub(crate) sensor_sd_share: f64,
}

/// A filter's models under way.
pub(crate) struct Augmented<'a> {
    pub(crate) plane: &'a Plane,
    /// Velocities by action, then the sensor's coefficients.
    pub(crate) parameters: Vec<f64>,
    /// Variances of these before a pass, and after the last.
    pub(crate) parameter_var: Vec<f64>,
    pub(crate) learned_var: Vec<f64>,
    /// Of size, bearing, and motion in a step of median length.
    pub(crate) variances: [f64; 5],
    pub(crate) first_pose: [f64; 3],
    pub(crate) pose_var: [f64; 3],
    /// Of the sightings in this pass, as predicted, nats.
    pub(crate) log_likelihood: f64,
    centre_m: f64,
    scale_m: f64,
}

/// Most unknowns that a component of a sighting depends on: the pose, and a sensor of degree 8.
const MOST: usize = 3 + 9;

/// One component of a sighting, linearised.
pub(crate) struct Row {
    pub(crate) innovation: f64,
    by: [(usize, f64); MOST],
    used: usize,
}

impl Row {
    /// Derivatives of the prediction: by which unknown (the pose first, then the parameters), and how much.
    pub(crate) fn by(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.by[..self.used].iter().copied()
    }

    /// Log-density of the innovation if its variance is this.
    pub(crate) fn log_density(&self, variance: f64) -> f64 {
        -0.5 * (self.innovation * self.innovation / variance + ln(std::f64::consts::TAU * variance))
    }
}

impl<'a> Augmented<'a> {
    pub(crate) fn new(plane: &'a Plane, given: &Models, belief: &Belief) -> Result<Self, CannotLearn> {
        let start = Start::given(plane, given)?;
        plane.require(belief.sensor_degree + 4)?;
        let lost = || CannotLearn::Undetermined("the sightings do not tell where the robot was".to_string());
        let first = first_pose(&start, plane).ok_or_else(lost)?;
        let (centre_m, scale_m) = crate::batch::distances(plane);
        let mut sensor = start.sensor.rebased(centre_m, scale_m).coefficients;
        sensor.resize(belief.sensor_degree + 1, 0.0);
        let n = plane.sightings.len() as f64;
        let mean = plane.sightings.iter().fold(0.0, |sum, seen| sum + seen.size) / n;
        let spread = plane.sightings.iter().fold(0.0, |sum, seen| sum + (seen.size - mean) * (seen.size - mean)) / n;
        let sensor_var = belief.sensor_sd_share * belief.sensor_sd_share * spread.max(1e-12);
        let velocity_var = start.velocities.iter().flat_map(|_| belief.velocity_sd.map(|sd| sd * sd));
        let parameter_var: Vec<f64> = velocity_var.chain(sensor.iter().map(|_| sensor_var)).collect();
        Ok(Self {
            plane,
            parameters: start.velocities.iter().flatten().copied().chain(sensor).collect(),
            learned_var: parameter_var.clone(),
            parameter_var,
            variances: start.variances,
            first_pose: [first.mean[0], first.mean[1], first.mean[2]],
            pose_var: [0, 1, 2].map(|i| first.covariance[(i, i)]),
            log_likelihood: 0.0,
            centre_m,
            scale_m,
        })
    }

    /// Passes over the log, and what they taught.
    pub(crate) fn learn(
        mut self,
        passes: u32,
        pass: impl Fn(&mut Augmented) -> Option<()>,
    ) -> Result<Learned, CannotLearn> {
        let (mut history, mut verdict, mut done) = (Vec::new(), Verdict::Converged, 0);
        while done < passes {
            let before = (self.parameters.clone(), self.learned_var.clone());
            self.log_likelihood = 0.0;
            let passed = pass(&mut self);
            let finite = self.parameters.iter().chain(&self.learned_var).all(|x| x.is_finite());
            if passed.is_none() || !finite || !self.log_likelihood.is_finite() {
                (self.parameters, self.learned_var) = before;
                verdict = Verdict::Diverged { rule: "the filter broke down" };
                break;
            }
            done += 1;
            history.push(Step { t_s: None, log_likelihood: Some(self.log_likelihood), models: self.models() });
        }
        let (models, lacks) = (self.models(), self.plane.lacks(false));
        Ok(Learned { models, verdict, iterations: Some(done), history, lacks, ..Learned::default() })
    }

    /// Component `kind` of a sighting, 0 its size and 1 its bearing, linearised at a pose.
    pub(crate) fn row(&self, w: &[f64; 3], seen: &Seen, kind: usize) -> Row {
        let view = View::of(w, seen.landmark_m, self.plane.sensor_origin_m);
        let mut by = [(0, 0.0); MOST];
        if kind == 1 {
            for (k, by_w) in view.bearing_by.into_iter().enumerate() {
                by[k] = (k, by_w);
            }
            return Row { innovation: wrap_rad(seen.bearing_rad - view.bearing_rad), by, used: 3 };
        }
        let first = 3 * self.plane.actions.len();
        let f = self.sensor();
        let slope = f.slope_at(view.distance_m);
        for (k, by_w) in view.distance_by.into_iter().enumerate() {
            by[k] = (k, slope * by_w);
        }
        let mut power = 1.0;
        for (k, by) in by.iter_mut().skip(3).take(f.coefficients.len()).enumerate() {
            *by = (3 + first + k, power);
            power *= f.scaled(view.distance_m);
        }
        Row { innovation: seen.size - f.at(view.distance_m), by, used: 3 + f.coefficients.len() }
    }

    /// Covariance of frame `t`'s noise of motion in the world, for a heading of this sine and cosine.
    pub(crate) fn motion_covariance(&self, t: usize, sin: f64, cos: f64) -> [[f64; 3]; 3] {
        let steps = (self.plane.frames[t].dt_s / self.plane.step_s).max(1e-3);
        let [right, forward, turn] = [2, 3, 4].map(|kind| steps * self.variances[kind]);
        let across = sin * cos * (right - forward);
        [
            [cos * cos * right + sin * sin * forward, across, 0.0],
            [across, sin * sin * right + cos * cos * forward, 0.0],
            [0.0, 0.0, turn],
        ]
    }

    fn sensor(&self) -> Polynomial {
        let coefficients = self.parameters[3 * self.plane.actions.len()..].to_vec();
        Polynomial { coefficients, centre: self.centre_m, scale: self.scale_m }
    }

    fn models(&self) -> Models {
        let se = |i: usize| self.learned_var[i].max(0.0).sqrt();
        let table = self.plane.actions.iter().enumerate().filter_map(|(a, action)| {
            let v = &self.parameters[3 * a..3 * a + 3];
            Some(Entry {
                action: action.id?,
                vx_m_per_s: v[0],
                vy_m_per_s: v[1],
                vtheta_rad_per_s: v[2],
                se: Some([0, 1, 2].map(|i| se(3 * a + i))),
            })
        });
        let first = 3 * self.plane.actions.len();
        let curve = Curve { se: (first..self.parameters.len()).map(se).collect(), polynomial: self.sensor() };
        let sd = self.variances.map(f64::sqrt);
        let noise = Noise { sigma2_rad: Some(sd[1]), motion_sd: Some([sd[2], sd[3], sd[4]]), ..Noise::default() };
        let (sensor, noise) = match self.plane.unit {
            Unit::HeightPx => (SensorModel::HeightOfDistance(curve), Noise { sigma1_px: Some(sd[0]), ..noise }),
            Unit::RangeM => (SensorModel::RangeOfDistance(curve), Noise { sigma1_m: Some(sd[0]), ..noise }),
        };
        Models { action: Some(ActionModel::Table(table.collect())), sensor: Some(sensor), noise }
    }
}
