//! Algorithm 1 as published: both models learn from each other, observation by observation.

use asami_dataset::models::Curve;
use asami_dataset::{ActionModel, Log, Models, Rng, SensorModel};
use asami_math::polynomial::{Polynomial, powers};
use asami_math::regression::Regression;

use crate::learner::{CannotLearn, Learned, Learner, Step, Trace, Verdict, learner};
use crate::line::{Line, given_action};

learner! {
    /// Stronger 2008, Algorithm 1: starts from a rough action model and bootstraps.
    ///
    /// The models' common unit of length is that of the starting model: metres for `A0(c) = c`.
    Algorithm1, "algorithm1",
    "Learns both models from each other, incrementally, from a starting action model.",
    source "Stronger 2008, section 3.2.3, Algorithm 1", needs Action,
    {
        /// Degree of the sensor model, a polynomial of the observation.
        sensor_degree: u32 = 3, "1", 1.0..=8.0;
        /// Degree of the action model, a polynomial of the command.
        action_degree: u32 = 4, "1", 1.0..=8.0;
        /// Factor on every regression weight at each new observation.
        gamma: f64 = 0.999, "1", 0.5..=1.0;
        /// How strongly each observation pulls the action model's estimate of place towards the sensor model's.
        alpha: f64 = 0.03333333333333333, "1", 0.0..=1.0;
        /// The sensor model alone learns for this long, the action model for as long again before it is used.
        t_start_s: f64 = 20.0, "s", 0.0..=1000.0;
        /// How often the models are kept for the learning curve.
        history_every_s: f64 = 5.0, "s", 0.1..=1000.0;
    }
}

impl Learner for Algorithm1 {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        let start = given_action(given)?;
        let (sensor_degree, action_degree) = (self.sensor_degree as usize, self.action_degree as usize);
        line.require(sensor_degree + action_degree + 3)?;

        let mut run = Run::new(&line, sensor_degree, action_degree);
        let (mut history, mut next_s) = (Vec::new(), line.start_s + self.history_every_s);
        let (mut w_a, mut w_s) = (Vec::new(), Vec::new());
        for (i, row) in line.rows.iter().enumerate() {
            run.observe(self, start, i);
            w_a.push([row.t_s, run.w_a]);
            w_s.extend(run.w_s.map(|w_s| [row.t_s, w_s]));
            if row.t_s >= next_s {
                history.push(Step { t_s: Some(row.t_s), log_likelihood: None, models: run.models() });
                next_s += self.history_every_s * ((row.t_s - next_s) / self.history_every_s).floor().max(0.0);
                next_s += self.history_every_s;
            }
        }
        let models = run.models();
        Ok(Learned {
            verdict: if models.sensor.is_some() && models.action.is_some() {
                Verdict::Converged
            } else {
                Verdict::Diverged {
                    rule: "a model was never learned: the log ends in the starting phase, or overflowed",
                }
            },
            models,
            iterations: None,
            history,
            traces: vec![Trace { name: "w_a", points: w_a }, Trace { name: "w_s", points: w_s }],
            lacks: line.lacks(action_degree),
        })
    }
}

/// Algorithm 1 under way: constant space, and constant time per observation.
struct Run<'a> {
    line: &'a Line,
    /// Estimate of place by the action model.
    w_a: f64,
    /// Estimate of place by the sensor model, once there is one.
    w_s: Option<f64>,
    sensor_regression: Regression,
    action_regression: Regression,
    sensor: Polynomial,
    action: Polynomial,
    /// Integrals of the powers of the scaled command since the start: the regressors of eq. 3.2.
    cumulated: Vec<f64>,
}

impl<'a> Run<'a> {
    fn new(line: &'a Line, sensor_degree: usize, action_degree: usize) -> Self {
        // Centre and scale change no fitted curve, only rounding; that they look ahead gives nothing away.
        let (centre, scale) = line.observation_scaling();
        Self {
            line,
            w_a: 0.0,
            w_s: None,
            sensor_regression: Regression::new(sensor_degree + 1),
            action_regression: Regression::new(action_degree + 2),
            sensor: Polynomial { coefficients: Vec::new(), centre, scale },
            action: Polynomial { coefficients: Vec::new(), centre: 0.0, scale: line.command_scale() },
            cumulated: vec![0.0; action_degree + 1],
        }
    }

    /// Lines 3 to 15 of Algorithm 1, from the last observation up to observation `i`.
    fn observe(&mut self, parameters: &Algorithm1, start: &ActionModel, i: usize) {
        let row = &self.line.rows[i];
        let t_s = row.t_s - self.line.start_s;
        let learned = t_s >= 2.0 * parameters.t_start_s && !self.action.coefficients.is_empty();
        for piece in self.line.pieces(i) {
            let c = piece.c_m_per_s;
            let speed = if learned { self.action.at(c) } else { start.forward_at(c).unwrap_or(0.0) };
            self.w_a += speed * piece.dt_s;
        }
        let powers_now = self.line.powers(i, self.cumulated.len() - 1, self.action.scale);
        for (sum, power) in self.cumulated.iter_mut().zip(powers_now) {
            *sum += power;
        }
        if t_s > parameters.t_start_s && !self.sensor.coefficients.is_empty() {
            let w_s = self.sensor.at(row.o);
            self.w_s = Some(w_s);
            self.update_action(w_s, parameters.gamma);
            self.w_a = (1.0 - parameters.alpha) * self.w_a + parameters.alpha * w_s;
        }
        self.update_sensor(row.o, parameters.gamma);
    }

    /// UPDATE of the action model: the weighted regression of eq. 3.2, unknowns w_0, a_0, ..., a_d.
    fn update_action(&mut self, w_s: f64, gamma: f64) {
        let x: Vec<f64> = [1.0].into_iter().chain(self.cumulated.iter().copied()).collect();
        self.action_regression.forget(gamma);
        self.action_regression.observe(&x, w_s, 1.0);
        if let Some(fit) = self.action_regression.solve() {
            self.action.coefficients = fit.coefficients[1..].to_vec();
        }
    }

    /// UPDATE of the sensor model: the weighted regression of w_a on powers of o.
    fn update_sensor(&mut self, o: f64, gamma: f64) {
        let x = powers(self.sensor.scaled(o), self.sensor_regression.unknowns() - 1);
        self.sensor_regression.forget(gamma);
        self.sensor_regression.observe(&x, self.w_a, 1.0);
        if let Some(fit) = self.sensor_regression.solve() {
            self.sensor.coefficients = fit.coefficients;
        }
    }

    fn models(&self) -> Models {
        let curve = |p: &Polynomial| (!p.coefficients.is_empty()).then(|| Curve::from(p.clone()));
        Models {
            action: curve(&self.action).map(ActionModel::Polynomial),
            sensor: curve(&self.sensor).map(SensorModel::DistanceOfHeight),
            noise: Default::default(),
        }
    }
}
