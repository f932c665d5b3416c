//! The sensor model from a known action model, choosing its own degree.
//!
//! Stronger 2008, section 3.3.3, describes the idea and leaves the details to Stronger and Stone 2006:
//! starting at degree 1, compare a *global prediction error* with a *local noise estimate*, and restart
//! with the next degree while the former is too large to be noise. Chosen here:
//!
//! - both are errors of prediction: each observation is compared with what was learned from those
//!   before it, and the squares are averaged with the regression's own forgetting;
//! - the local noise is that about straight lines, one for each of [`bins`](DegreeSelection::bins) equal
//!   parts of the range of observations: as good as any smooth curve could do. The drift of `w_a`, which
//!   no curve could follow, is in both alike;
//! - a degree is given up if, after [`patience`](DegreeSelection::patience) observations, the global error
//!   is more than [`excess_ratio`](DegreeSelection::excess_ratio) times the local one.

use asami_dataset::models::Curve;
use asami_dataset::{Log, Models, Rng, SensorModel};
use asami_math::polynomial::{Polynomial, powers};
use asami_math::regression::Regression;

use crate::learner::{CannotLearn, Learned, Learner, Step, Trace, Verdict, learner};
use crate::line::{Line, given_action};

learner! {
    /// Stronger 2008, section 3.3.3: sensor model from a given action model, degree by degree until the
    /// fit is as good as the noise allows. The unit of length is the given model's.
    DegreeSelection, "degree_selection",
    "Learns the sensor model from a known action model and chooses its degree on the way.",
    source "Stronger 2008, section 3.3.3; thresholds chosen here", needs Action,
    {
        /// Factor on every weight at each new observation.
        gamma: f64 = 0.999, "1", 0.5..=1.0;
        /// Parts of the range of observations, each with a straight line of its own.
        bins: u32 = 10, "1", 2.0..=100.0;
        /// A global error this many times the local one is no noise (both are mean squares).
        excess_ratio: f64 = 1.1, "1", 1.0..=100.0;
        /// Observations before a degree may be given up.
        patience: u32 = 500, "1", 10.0..=100000.0;
        /// Degree at which to stop.
        max_degree: u32 = 8, "1", 1.0..=8.0;
        /// How often the model is kept for the learning curve.
        history_every_s: f64 = 5.0, "s", 0.1..=1000.0;
    }
}

impl Learner for DegreeSelection {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        let action = given_action(given)?;
        line.require(3)?;
        let w_a = line.places(action);
        let (centre, scale) = line.observation_scaling();
        let mut global = Predictor::new(1);
        let mut local: Vec<Predictor> = (0..self.bins).map(|_| Predictor::new(1)).collect();
        let mut local_error = ForgettingMean::default();
        let model = |global: &Predictor| -> Option<Models> {
            let coefficients = global.regression.solve()?.coefficients;
            let sensor = SensorModel::DistanceOfHeight(Curve::from(Polynomial { coefficients, centre, scale }));
            Some(Models { sensor: Some(sensor), ..Models::default() })
        };
        let (mut history, mut degrees) = (Vec::new(), Vec::new());
        let mut next_s = line.start_s + self.history_every_s;
        for (row, place) in line.rows.iter().zip(&w_a) {
            let u = (row.o - centre) / scale;
            global.observe(u, *place, self.gamma);
            // u runs from -1 to 1; the last bin has its right end.
            let bin = ((0.5 * (u + 1.0) * f64::from(self.bins)) as usize).min(local.len() - 1);
            if let Some(square) = local[bin].observe(u, *place, self.gamma) {
                local_error.add(square, self.gamma);
            }
            let patient = global.observations < self.patience || global.degree() >= self.max_degree as usize;
            if !patient && global.error.mean() > self.excess_ratio * local_error.mean() {
                global = Predictor::new(global.degree() + 1);
                global.observe(u, *place, self.gamma);
            }
            degrees.push(global.degree() as f64);
            if row.t_s >= next_s {
                history.extend(model(&global).map(|models| Step { t_s: Some(row.t_s), log_likelihood: None, models }));
                next_s = row.t_s + self.history_every_s;
            }
        }
        let overflow = || CannotLearn::Undetermined("observations or commands overflow".to_string());
        Ok(Learned {
            models: model(&global).ok_or_else(overflow)?,
            verdict: Verdict::Converged,
            history,
            traces: vec![Trace { name: "degree", points: line.trace(&degrees) }],
            lacks: line.lacks(0),
            ..Learned::default()
        })
    }
}

/// A weighted polynomial regression and its errors of prediction.
struct Predictor {
    regression: Regression,
    error: ForgettingMean,
    observations: u32,
}

impl Predictor {
    fn new(degree: usize) -> Self {
        Self { regression: Regression::new(degree + 1), error: ForgettingMean::default(), observations: 0 }
    }

    fn degree(&self) -> usize {
        self.regression.unknowns() - 1
    }

    /// Predicts, compares, learns; the squared error, once there is something to predict from.
    fn observe(&mut self, u: f64, place: f64, gamma: f64) -> Option<f64> {
        let x = powers(u, self.degree());
        // The first predictions are extrapolations, which say nothing about either model or noise.
        let known = self.observations as usize > 3 * x.len();
        let fit = if known { self.regression.solve() } else { None };
        let square = fit.map(|fit| {
            let predicted = fit.coefficients.iter().zip(&x).fold(0.0, |sum, (c, x)| sum + c * x);
            (place - predicted) * (place - predicted)
        });
        if let Some(square) = square {
            self.error.add(square, gamma);
        }
        self.regression.forget(gamma);
        self.regression.observe(&x, place, 1.0);
        self.observations = self.observations.saturating_add(1);
        square
    }
}

/// A mean in which older values count for less.
#[derive(Default)]
struct ForgettingMean {
    sum: f64,
    weight: f64,
}

impl ForgettingMean {
    fn add(&mut self, value: f64, gamma: f64) {
        self.sum = gamma * self.sum + value;
        self.weight = gamma * self.weight + 1.0;
    }

    fn mean(&self) -> f64 {
        if self.weight > 0.0 { self.sum / self.weight } else { 0.0 }
    }
}
