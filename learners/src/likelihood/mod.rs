//! Both models by maximum likelihood: a smoother runs through the robot's places, and the models are
//! those under which the observations are most likely.
//!
//! Regressing a place on noisy observations, as Algorithm 1 does, bends the sensor model: the noise
//! of `o` passes for motion (errors in variables; Fuller 1987). Here `o = f(place) + noise` with `f` from
//! place to observation, and both the noise of the sensor and that of the motion are learned too.

mod bending;
mod noise;
mod posterior;
mod shape;

use std::cell::Cell;

use asami_dataset::models::Curve;
use asami_dataset::{ActionModel, Log, Models, Noise, Rng, SensorModel};
use asami_math::decomposition::dot;
use asami_math::elementary::ln;
use asami_math::kalman::scalar;
use asami_math::polynomial::Polynomial;

use crate::canonical::{Canonical, Pair, metres_per_unit};
use crate::learner::{CannotLearn, Learned, Learner, Trace, Verdict, learner};
use crate::line::{Line, Unit};
use posterior::{Data, State};
use shape::first_shape;

learner! {
    /// Maximum likelihood with a smoother, started by the canonical correlation.
    ///
    /// The sensor is a polynomial of place, or one with a pole (as a pinhole's image of a thing has),
    /// whichever and of whichever degree Schwarz's criterion prefers; so is whether commands act late. How
    /// far the action model bends is weighed by a smoothing spline's prior. Places stray from the commands
    /// as a random walk does; observations have Student's t errors.
    ///
    /// Scale and sign are those of `canonical`: metres as the commands understand them. The sensor model is
    /// the inverse of the learned curve as a polynomial, over the places visited and a little beyond. Standard
    /// errors are those of the information matrix, at the learned noise, stiffness and shape.
    Likelihood, "likelihood",
    "Learns both models, their noise and the delay of commands by maximum likelihood with a smoother.",
    source "Student-t Rauch-Tung-Striebel smoother by Gauss-Newton (Bell 1994); Schwarz 1978 for the shapes", needs Nothing,
    {
        /// Greatest degree of the learned curve from place to observation.
        max_sensor_degree: u32 = 5, "1", 1.0..=8.0;
        /// Degree of the learned action model; how much of it is used the data decide.
        action_degree: u32 = 9, "1", 1.0..=12.0;
        /// Commands may take effect this much late or early; 0: at once.
        max_delay_s: f64 = 0.5, "s", 0.0..=2.0;
        /// Greatest number of passes over the data for one pair of shapes.
        max_iterations: u32 = 60, "1", 1.0..=10000.0;
    }
}

impl Learner for Likelihood {
    fn learn(&self, log: &Log, _given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        line.require(30)?;
        let pair = Canonical::default().pair(&line)?;
        // No polynomial of higher degree than the commands determine.
        let action_degree = (self.action_degree as usize).min(line.distinct_commands().saturating_sub(1));
        let data = Data::new(&line, action_degree);
        let search = Search { line: &line, data: &data, limits: self, passes: Cell::new(0) };
        let start = search.start(&pair)?;
        let best = search.choose_shapes(start);
        let models = best.models(&line, &data)?;
        let to_metres = best.action(&line)?.1;
        let places_m: Vec<f64> = best.state.u.iter().map(|u| u * to_metres).collect();
        Ok(Learned {
            verdict: if best.converged {
                Verdict::Converged
            } else {
                Verdict::Diverged { rule: "the likelihood still rose at the last pass" }
            },
            iterations: Some(search.passes.get()),
            traces: vec![Trace { name: "w", points: line.trace(&places_m) }],
            models,
            lacks: line.lacks(2),
            ..Learned::default()
        })
    }
}

/// A fit with chosen shapes.
#[derive(Clone)]
struct Fitted {
    state: State,
    log_likelihood: f64,
    /// Schwarz's criterion: smaller is better.
    bic: f64,
    converged: bool,
}

struct Search<'a> {
    line: &'a Line,
    data: &'a Data<'a>,
    limits: &'a Likelihood,
    passes: Cell<u32>,
}

impl Search<'_> {
    /// A straight line for a sensor, through places smoothed under the canonical pair of models.
    fn start(&self, pair: &Pair) -> Result<Fitted, CannotLearn> {
        let undetermined = || CannotLearn::Undetermined("observations and commands do not change together".to_string());
        let place = smoothed_places(self.line, pair).ok_or_else(undetermined)?;
        let (least, greatest) =
            place.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(*w), b.max(*w)));
        let (middle, unit_m) = (0.5 * (least + greatest), 0.5 * (greatest - least));
        let u: Vec<f64> = place.iter().map(|w| (w - middle) / unit_m).collect();
        let points: Vec<(f64, f64)> = u.iter().copied().zip(self.line.rows.iter().map(|row| row.o)).collect();
        let shape = first_shape(&points).filter(|_| unit_m > 0.0 && unit_m.is_finite()).ok_or_else(undetermined)?;
        let mut action: Vec<f64> = pair.action.coefficients.iter().map(|a| a / unit_m).collect();
        action.resize(self.data.action_degree() + 1, 0.0);
        let state = State {
            u,
            spread: Vec::new(),
            action,
            stiffness: 1.0,
            delay_s: None,
            tail: 10.0,
            sigma: self.line.local_noise().max(0.02 * shape.g.abs()),
            q: 1e-3,
            shape,
        };
        Ok(Fitted { state, log_likelihood: f64::NEG_INFINITY, bic: f64::INFINITY, converged: false })
    }

    /// Climbs the likelihood with the shapes as they are.
    fn climb(&self, from: &Fitted) -> Fitted {
        let mut fitted = from.clone();
        let least_sigma = 1e-4 * fitted.state.shape.g.abs();
        let mut before = f64::NEG_INFINITY;
        fitted.converged = false;
        for pass in 0..self.limits.max_iterations {
            self.passes.set(self.passes.get() + 1);
            let rose = self.data.step(&mut fitted.state, self.limits.max_delay_s);
            if rose && pass % 2 == 0 {
                continue;
            }
            let reach = if pass < 2 { 3.0 } else { 0.5 };
            self.data.update_noise(&mut fitted.state, least_sigma, reach);
            self.data.update_stiffness(&mut fitted.state);
            let log_likelihood = self.data.log_likelihood(&fitted.state);
            if (log_likelihood - before).abs() < 0.05 {
                fitted.converged = true;
                break;
            }
            before = log_likelihood;
        }
        fitted.log_likelihood = self.data.log_likelihood(&fitted.state);
        // Three more: the noises and the tail.
        let unknowns = (fitted.state.unknowns() + 3) as f64;
        fitted.bic = unknowns * ln(self.data.len() as f64) - 2.0 * fitted.log_likelihood;
        if !fitted.bic.is_finite() {
            fitted.bic = f64::INFINITY;
        }
        fitted
    }

    /// Adds and removes terms of either model while Schwarz's criterion falls.
    fn choose_shapes(&self, start: Fitted) -> Fitted {
        let mut settled = with_sensor(&start, true, 0);
        // Before the shape is roughly right, its misfit would pass for noise of the motion.
        for _step in 0..8 {
            self.data.step(&mut settled.state, self.limits.max_delay_s);
        }
        let mut best = self.climb(&settled);
        for (pole, bends) in [(false, 0), (false, 1), (false, 2)] {
            best = better(best.clone(), self.climb(&with_sensor(&best, pole, bends)));
        }
        best = self.choose_sensor(best);
        if self.limits.max_delay_s > 0.0 {
            let mut late = best.clone();
            late.state.delay_s = Some(0.0);
            best = better(best, self.climb(&late));
        }
        self.choose_sensor(best)
    }

    fn choose_sensor(&self, from: Fitted) -> Fitted {
        let mut best = from;
        while best.state.shape.degree() < self.limits.max_sensor_degree as usize {
            let (pole, bends) = (best.state.shape.pole.is_some(), best.state.shape.bends.len());
            let richer = self.climb(&with_sensor(&best, pole, bends + 1));
            if richer.bic >= best.bic {
                break;
            }
            best = richer;
        }
        best
    }
}

fn better(a: Fitted, b: Fitted) -> Fitted {
    if b.bic < a.bic { b } else { a }
}

fn with_sensor(from: &Fitted, pole: bool, bends: usize) -> Fitted {
    let mut other = from.clone();
    other.state.shape = from.state.shape.reshaped(pole, bends);
    other
}

/// Places under a pair of models, in metres: a smoother between where the sensor model sees the
/// robot and how the action model moves it.
fn smoothed_places(line: &Line, pair: &Pair) -> Option<Vec<f64>> {
    let seen: Vec<f64> = line.rows.iter().map(|row| pair.sensor.at(row.o)).collect();
    let mean = seen.iter().sum::<f64>() / seen.len() as f64;
    let variance = seen.iter().fold(0.0, |sum, w| sum + (w - mean) * (w - mean)) / seen.len() as f64;
    // Rough guesses do: an observation tells a place to a fifth of the track, and in a second the robot
    // strays by a fiftieth of it.
    let (seen_var, stray_var) = (variance / 25.0, variance / 2500.0);
    let n = pair.action.degree();
    let (drifts, strays): (Vec<f64>, Vec<f64>) = (0..line.rows.len())
        .map(|i| {
            let powers = line.powers(i, n, pair.action.scale);
            (dot(&powers, &pair.action.coefficients), stray_var * powers[0] + 1e-9 * variance)
        })
        .unzip();
    let mut filtered: Vec<scalar::State> = Vec::with_capacity(seen.len());
    for (i, w) in seen.iter().enumerate() {
        let before = match filtered.last() {
            Some(before) => before.predict(drifts[i], strays[i]),
            None => scalar::State { mean: *w, variance },
        };
        filtered.push(before.update(1.0, *w, seen_var)?.0);
    }
    for i in (0..filtered.len().saturating_sub(1)).rev() {
        filtered[i] = filtered[i].smooth(drifts[i + 1], strays[i + 1], filtered[i + 1]);
    }
    Some(filtered.iter().map(|state| state.mean).collect())
}

impl Fitted {
    /// The action model in metres, and how many of them a scaled place is.
    fn action(&self, line: &Line) -> Result<(Polynomial, f64), CannotLearn> {
        let scaled = Polynomial { coefficients: self.state.action.clone(), centre: 0.0, scale: line.command_scale() };
        let to_metres = metres_per_unit(line, &scaled)?;
        let coefficients = scaled.coefficients.iter().map(|a| a * to_metres).collect();
        Ok((Polynomial { coefficients, ..scaled }, to_metres))
    }

    /// The models as polynomials, in metres, with standard errors.
    fn models(&self, line: &Line, data: &Data) -> Result<Models, CannotLearn> {
        let state = &self.state;
        let (action, to_metres) = self.action(line)?;
        let (least, greatest) =
            state.u.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), u| (a.min(*u), b.max(*u)));
        let margin = 0.08 * (greatest - least);
        let inverse = state.shape.inverse(least - margin, greatest + margin, 9);
        let inverse = inverse.ok_or_else(|| CannotLearn::Undetermined("the sensor cannot be inverted".to_string()))?;
        let sensor = Polynomial {
            coefficients: inverse.polynomial.coefficients.iter().map(|s| s * to_metres).collect(),
            ..inverse.polynomial
        };

        let errors = || -> Option<(Vec<f64>, Vec<f64>)> {
            let covariance = data.covariance(state)?;
            let n_f = state.shape.unknowns();
            // How the logarithm of the scale changes with each coefficient of the action model.
            let by_action = scale_gradient(line, &action, to_metres);
            let by_shape = inverse.sensitivity(&state.shape)?;
            let zeros = || vec![0.0; state.unknowns()];
            let of = |gradient: &[f64]| {
                let variance = covariance.iter().zip(gradient).fold(0.0, |sum, (row, g)| sum + g * dot(row, gradient));
                variance.max(0.0).sqrt()
            };
            let action_se = (0..action.coefficients.len()).map(|j| {
                let mut gradient = zeros();
                for (i, by) in by_action.iter().enumerate() {
                    gradient[n_f + i] = action.coefficients[j] * by + if i == j { to_metres } else { 0.0 };
                }
                of(&gradient)
            });
            let sensor_se = (0..sensor.coefficients.len()).map(|j| {
                let mut gradient = zeros();
                for (i, by) in by_shape.iter().enumerate() {
                    gradient[i] = by[j] * to_metres;
                }
                for (i, by) in by_action.iter().enumerate() {
                    gradient[n_f + i] = sensor.coefficients[j] * by;
                }
                of(&gradient)
            });
            let (action_se, sensor_se): (Vec<f64>, Vec<f64>) = (action_se.collect(), sensor_se.collect());
            action_se.iter().chain(&sensor_se).all(|se| se.is_finite()).then_some((action_se, sensor_se))
        };
        let (action_se, sensor_se) = errors().unwrap_or_default();
        let sigma = data.noise_sd(state);
        let noise = match line.unit {
            Unit::HeightPx => Noise { sigma1_px: Some(sigma), ..Noise::default() },
            Unit::RangeM => Noise { sigma1_m: Some(sigma), ..Noise::default() },
        };
        let finite = action.coefficients.iter().chain(&sensor.coefficients).all(|c| c.is_finite());
        if !finite {
            return Err(CannotLearn::Undetermined("the likelihood has no maximum".to_string()));
        }
        Ok(Models {
            action: Some(ActionModel::Polynomial(Curve { polynomial: action, se: action_se })),
            sensor: Some(SensorModel::DistanceOfHeight(Curve { polynomial: sensor, se: sensor_se })),
            noise,
        })
    }
}

/// Derivative of `ln k` by each scaled coefficient of the action model, where `k` sets the slope of the
/// action model on the command to 1.
fn scale_gradient(line: &Line, action: &Polynomial, to_metres: f64) -> Vec<f64> {
    let (mut c_c, mut by) = (0.0, vec![0.0; action.coefficients.len()]);
    for piece in line.all_pieces() {
        c_c += piece.c_m_per_s * piece.c_m_per_s * piece.dt_s;
        let mut power = piece.c_m_per_s * piece.dt_s;
        for sum in &mut by {
            *sum += power;
            power *= piece.c_m_per_s / action.scale;
        }
    }
    by.iter().map(|m| -m * to_metres / c_c).collect()
}
