//! What the filters that learn as they go share: where they start, how they linearise, what they give.

use asami_dataset::{Log, Models};
use asami_math::elementary::ln;
use asami_math::kalman::Gaussian;
use nalgebra::{Matrix3, Vector3};

use crate::em::field::Field;
use crate::em::filter;
use crate::em::parameters::Parameters;
use crate::em::world::{Moved, World};
use crate::em::{self, curve, information, start};
use crate::learner::{CannotLearn, Learned, Step, Verdict};
use crate::plane::{Plane, Seen};

/// Declares a filter that learns as it goes out of its `pass` over the log.
macro_rules! augmented {
    ($(#[$meta:meta])* $T:ident, $name:literal, $what:literal, source $source:literal) => {
        $crate::learner::learner! {
            $(#[$meta])*
            $T, $name, $what, source $source, needs Both,
            {
                /// Degree of f, a polynomial of the distance.
                degree: u32 = 3, "1", 1.0..=5.0;
                /// How well translation is known beforehand.
                velocity_sd_m_per_s: f64 = 0.3, "m/s", 0.001..=100.0;
                /// How well turning is known beforehand.
                turn_sd_rad_per_s: f64 = 1.0, "rad/s", 0.001..=100.0;
                /// How well the sensor is known beforehand, as a share of the sizes' standard deviation in the log.
                sensor_sd_share: f64 = 2.0, "1", 0.001..=1000.0;
                /// Passes over the log; each starts from the models of the one before, and as unsure as the first.
                max_iterations: u32 = 1, "1", 1.0..=1000.0;
            }
        }

        impl $crate::learner::Learner for $T {
            fn learn(
                &self,
                log: &asami_dataset::Log,
                given: &asami_dataset::Models,
                _rng: &mut asami_dataset::Rng,
            ) -> Result<$crate::learner::Learned, $crate::learner::CannotLearn> {
                let belief = $crate::augmented::Belief {
                    coefficients: self.degree as usize + 1,
                    velocity_sd: [self.velocity_sd_m_per_s, self.velocity_sd_m_per_s, self.turn_sd_rad_per_s],
                    sensor_sd_share: self.sensor_sd_share,
                };
                $crate::augmented::learn(log, given, &belief, self.max_iterations, pass)
            }
        }
    };
}
pub(crate) use augmented;

/// How sure the filters are beforehand.
pub(crate) struct Belief {
    pub(crate) coefficients: usize,
    pub(crate) velocity_sd: [f64; 3],
    pub(crate) sensor_sd_share: f64,
}

/// Passes over the log, and what they taught.
pub(crate) fn learn(
    log: &Log,
    given: &Models,
    belief: &Belief,
    passes: u32,
    pass: impl Fn(&mut Augmented) -> Option<()>,
) -> Result<Learned, CannotLearn> {
    let plane = Plane::try_from(log)?;
    let mut filter = Augmented::new(&plane, given, belief)?;
    let (mut history, mut verdict, mut done) = (Vec::new(), Verdict::Converged, 0);
    while done < passes {
        let before = (filter.lambda.clone(), filter.learned_var.clone());
        filter.log_likelihood = 0.0;
        let passed = pass(&mut filter);
        let finite = filter.lambda.is_finite() && filter.learned_var.iter().all(|var| var.is_finite());
        if passed.is_none() || !finite || !filter.log_likelihood.is_finite() {
            (filter.lambda, filter.learned_var) = before;
            verdict = Verdict::Diverged { rule: "the filter broke down" };
            break;
        }
        done += 1;
        let models = filter.lambda.models(&plane, None);
        history.push(Step { t_s: None, log_likelihood: Some(filter.log_likelihood), models });
    }
    let errors = information::errors(&plane, &filter.learned_var, true);
    let (models, lacks) = (filter.lambda.models(&plane, Some(&errors)), em::lacks(&plane, given, false));
    Ok(Learned { models, verdict, iterations: Some(done), history, lacks, ..Learned::default() })
}

/// A filter's models under way.
pub(crate) struct Augmented<'a> {
    pub(crate) plane: &'a Plane,
    world: Field,
    lambda: Parameters<3>,
    /// Variances of velocities and then coefficients before a pass, and after the last.
    pub(crate) parameter_var: Vec<f64>,
    pub(crate) learned_var: Vec<f64>,
    /// Of the sightings in this pass, as predicted, nats.
    pub(crate) log_likelihood: f64,
}

/// Most unknowns that a component of a sighting depends on: the pose, and the sensor.
const MOST: usize = 3 + curve::MOST;

/// One component of a sighting, linearised.
pub(crate) struct Row {
    pub(crate) innovation: f64,
    /// Variance of its noise.
    pub(crate) variance: f64,
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

/// A step of motion, linearised.
pub(crate) struct Stride {
    pub(crate) moved: Moved<3>,
    /// Which parameter is the first of the three velocities.
    pub(crate) first: usize,
    /// Derivatives of the pose by these.
    pub(crate) by_velocity: Matrix3<f64>,
}

impl<'a> Augmented<'a> {
    fn new(plane: &'a Plane, given: &Models, belief: &Belief) -> Result<Self, CannotLearn> {
        let lambda = start::in_plane(plane, given, belief.coefficients)?;
        let n = plane.sightings.len() as f64;
        let mean = plane.sightings.iter().fold(0.0, |sum, seen| sum + seen.size) / n;
        let spread = plane.sightings.iter().fold(0.0, |sum, seen| sum + (seen.size - mean) * (seen.size - mean)) / n;
        let sensor_var = belief.sensor_sd_share * belief.sensor_sd_share * spread.max(1e-12);
        let velocity_var = plane.actions.iter().flat_map(|_| belief.velocity_sd.map(|sd| sd * sd));
        let parameter_var: Vec<f64> = velocity_var.chain(std::iter::repeat_n(sensor_var, lambda.f.n)).collect();
        Ok(Self {
            world: Field::of(plane),
            plane,
            lambda,
            learned_var: parameter_var.clone(),
            parameter_var,
            log_likelihood: 0.0,
        })
    }

    /// Where the robot may be at first.
    pub(crate) fn prior(&self) -> Gaussian<3> {
        self.lambda.prior
    }

    /// Component `kind` of a sighting, 0 its size and 1 its bearing, linearised at a pose.
    pub(crate) fn row(&self, w: &Vector3<f64>, seen: &Seen, kind: usize) -> Row {
        let f = &self.lambda.f;
        let (innovation, h) = self.world.innovation(w, seen, f);
        let mut row = Row {
            innovation: innovation[kind],
            variance: [self.lambda.size_var, self.lambda.bearing_var][kind],
            by: [(0, 0.0); MOST],
            used: 3,
        };
        for (k, by) in row.by[..3].iter_mut().enumerate() {
            *by = (k, h[(kind, k)]);
        }
        if kind == 0 {
            let (u, mut power) = (f.scaled(self.world.look(w, seen).distance_m), 1.0);
            let first = 3 + 3 * self.plane.actions.len();
            for (k, by) in row.by[3..3 + f.n].iter_mut().enumerate() {
                *by = (first + k, power);
                power *= u;
            }
            row.used += f.n;
        }
        row
    }

    /// The motion from frame `t` to the next, from a pose.
    pub(crate) fn stride(&self, t: usize, w: &Vector3<f64>) -> Stride {
        let (mu, q) = filter::step(self.plane, &self.lambda, t);
        let frame = &self.plane.frames[t];
        Stride {
            moved: self.world.forth(w, &mu, &q),
            first: 3 * frame.action,
            by_velocity: self.world.axes(w) * frame.dt_s,
        }
    }

    /// Changes velocities and coefficients.
    pub(crate) fn correct(&mut self, changes: impl Iterator<Item = f64>) {
        let corrected: Vec<f64> = self.lambda.means().iter().zip(changes).map(|(mean, change)| mean + change).collect();
        self.lambda.set_means(&corrected);
    }
}
