//! The joint density of all places and models, climbed by Gauss-Newton steps.
//!
//! Places form a chain, `u_i = u_{i-1} + sum_j a_j D_ij + noise` with `D_ij` the integrals of the powers of
//! the command, and each is seen as `o_i = f(u_i) + noise`. The Hessian is tridiagonal in the places,
//! bordered by the few coefficients of the models: a step costs time proportional to the length of the log.
//!
//! The most likely models are those with the places integrated out, which the joint mode is not: it lacks
//! Laplace's `1/2 ln det T`. Its gradient is that of `sum_i P_i f'(u_i)^2 / (2 sigma^2)` with the variances
//! `P` of the places held, so that this sum is added, and the variances renewed at each step.

use std::borrow::Cow;

use asami_math::decomposition::{cholesky, cholesky_solve, dot};
use asami_math::elementary::ln;
use asami_math::tridiagonal::Factor;

use super::bending::{Evidence, bending, force};
use super::noise::{log_of_product, log_peak};
use super::shape::Shape;
use crate::line::Line;

/// Observations and commands in scaled form.
pub(super) struct Data<'a> {
    line: &'a Line,
    command_scale: f64,
    /// Seconds since the row before.
    pub(super) dt_s: Vec<f64>,
    /// [`Line::delayed_powers`] without delay, for the greatest degree.
    prompt: (Vec<f64>, Vec<f64>),
    action_degree: usize,
    bending: Vec<Vec<f64>>,
}

/// All that is estimated.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Place at each observation, scaled.
    pub(super) u: Vec<f64>,
    /// Variances of these places, given all observations and the models of the last step.
    pub(super) spread: Vec<f64>,
    pub(super) shape: Shape,
    /// Coefficients of the action model: scaled places per second, in powers of the scaled command.
    pub(super) action: Vec<f64>,
    /// Of the action model: see [`super::bending`].
    pub(super) stiffness: f64,
    /// How late commands take effect, of a state that learns it.
    pub(super) delay_s: Option<f64>,
    /// Scale of the observations' noise.
    pub(super) sigma: f64,
    /// Degrees of freedom of the observations' Student t distribution: many, and it is Gaussian.
    pub(super) tail: f64,
    /// Variance of the motion's noise per second.
    pub(super) q: f64,
}

impl State {
    pub(super) fn unknowns(&self) -> usize {
        self.shape.unknowns() + self.action.len() + usize::from(self.delay_s.is_some())
    }
}

/// What commands do between observations under a state's delay and action model.
pub(super) struct Motion<'d> {
    /// Integrals of the powers of the scaled command, `width` a row.
    powers: Cow<'d, [f64]>,
    width: usize,
    /// The command in force at each observation, scaled.
    command: Cow<'d, [f64]>,
    /// Scaled places that the action model says were covered since the row before.
    pub(super) drift: Vec<f64>,
}

/// The quadratic approximation at a state: `H step = -gradient`, by blocks.
struct Normal {
    chain: Factor,
    /// `T^-1 B` and `T^-1 gradient`, by rows.
    solved: Vec<f64>,
    /// `P - B^T T^-1 B`: the information on the models when the places are unknown.
    information: Vec<Vec<f64>>,
    gradient: Vec<f64>,
}

impl<'a> Data<'a> {
    pub(super) fn new(line: &'a Line, action_degree: usize) -> Self {
        let before = [line.start_s].into_iter().chain(line.rows.iter().map(|row| row.t_s));
        // Rows of the same time would leave no room for noise between them.
        let dt_s = line.rows.iter().zip(before).map(|(row, before_s)| (row.t_s - before_s).max(1e-4)).collect();
        let command_scale = line.command_scale();
        let prompt = scaled_powers(line, action_degree, command_scale, 0.0);
        Self { line, command_scale, dt_s, prompt, action_degree, bending: bending(action_degree + 1) }
    }

    pub(super) fn len(&self) -> usize {
        self.dt_s.len()
    }

    pub(super) fn action_degree(&self) -> usize {
        self.action_degree
    }

    pub(super) fn motion(&self, state: &State) -> Motion<'_> {
        let width = self.action_degree + 1;
        let (powers, command) = match state.delay_s {
            None => (Cow::from(&self.prompt.0), Cow::from(&self.prompt.1)),
            Some(delay_s) => {
                let late = scaled_powers(self.line, self.action_degree, self.command_scale, delay_s);
                (late.0.into(), late.1.into())
            }
        };
        let drift = powers.chunks(width).map(|row| dot(row, &state.action)).collect();
        Motion { powers, width, command, drift }
    }

    pub(super) fn residual(&self, state: &State, i: usize) -> f64 {
        self.line.rows[i].o - state.shape.at(state.u[i])
    }

    /// Minus the log-density of observations and places, less what depends on neither; infinite where
    /// the shape means nothing.
    fn cost(&self, state: &State, motion: &Motion) -> f64 {
        if state.u.iter().any(|u| state.shape.denominator(*u) < 0.02) {
            return f64::INFINITY;
        }
        let seen = |i: usize| (self.residual(state, i) / state.sigma).powi(2);
        let of_sensor = log_of_product((0..self.len()).map(|i| 1.0 + seen(i) / state.tail));
        let of_motion = (1..self.len()).fold(0.0, |sum, i| {
            let stray = state.u[i] - state.u[i - 1] - motion.drift[i];
            sum + stray * stray / self.dt_s[i]
        });
        let of_volume = (0..self.len()).fold(0.0, |sum, i| {
            let slope = state.shape.slope_at(state.u[i]);
            sum + self.volume_precision(state, i) * slope * slope
        });
        let sum = 0.5 * (state.tail + 1.0) * of_sensor + 0.5 * of_motion / state.q + 0.5 * of_volume;
        let sum = sum + 0.5 * self.bend(state);
        if sum.is_finite() { sum } else { f64::INFINITY }
    }

    /// The prior's `stiffness * integral of A''^2`.
    fn bend(&self, state: &State) -> f64 {
        dot(&state.action, &force(&self.bending, state.stiffness, &state.action))
    }

    /// `P_i / sigma^2`, of a state that has the variances.
    fn volume_precision(&self, state: &State, i: usize) -> f64 {
        state.spread.get(i).map_or(0.0, |variance| variance / (state.sigma * state.sigma))
    }

    fn normal(&self, state: &State, motion: &Motion) -> Option<Normal> {
        let (n, p, p_f) = (self.len(), state.unknowns(), state.shape.unknowns());
        let p_a = state.action.len();
        let width = p + 1;
        let (mut diagonal, mut beside) = (vec![0.0; n], vec![0.0; n.saturating_sub(1)]);
        // Rows of [B, gradient]; the models' own block and gradient.
        let mut border = vec![0.0; n * width];
        let (mut own, mut own_gradient) = (vec![vec![0.0; p]; p], vec![0.0; p]);
        let mut by = vec![0.0; p];
        for i in 0..n {
            // Observation: residual o - f(u), whose derivatives are -f' and -df.
            let (r, slope) = (self.residual(state, i), state.shape.slope_at(state.u[i]));
            let precision = self.weight(state, r) / (state.sigma * state.sigma);
            by[..p_f].fill(0.0);
            state.shape.gradient_at(state.u[i], &mut by[..p_f]);
            diagonal[i] += precision * slope * slope;
            border[i * width + p] -= precision * slope * r;
            for j in 0..p_f {
                border[i * width + j] += precision * slope * by[j];
                own_gradient[j] -= precision * by[j] * r;
                for k in 0..=j {
                    own[j][k] += precision * by[j] * by[k];
                }
            }
            // Volume: residual f', whose derivatives are f'' and df'.
            let precision = self.volume_precision(state, i);
            state.shape.slope_gradient_at(state.u[i], &mut by[..p_f]);
            border[i * width + p] += precision * slope * state.shape.curvature_at(state.u[i]);
            for j in 0..p_f {
                own_gradient[j] += precision * by[j] * slope;
                for k in 0..=j {
                    own[j][k] += precision * by[j] * by[k];
                }
            }
            if i == 0 {
                continue;
            }
            // Motion: stray u_i - u_{i-1} - D a.
            let stray = state.u[i] - state.u[i - 1] - motion.drift[i];
            let precision = 1.0 / (state.q * self.dt_s[i]);
            diagonal[i] += precision;
            diagonal[i - 1] += precision;
            beside[i - 1] = -precision;
            border[i * width + p] += precision * stray;
            border[(i - 1) * width + p] -= precision * stray;
            for j in 0..p_a {
                by[p_f + j] = -motion.powers[i * motion.width + j];
            }
            if state.delay_s.is_some() {
                by[p_f + p_a] = self.speed(state, motion.command[i]) - self.speed(state, motion.command[i - 1]);
            }
            for j in p_f..p {
                border[i * width + j] += precision * by[j];
                border[(i - 1) * width + j] -= precision * by[j];
                own_gradient[j] += precision * by[j] * stray;
                for k in p_f..=j {
                    own[j][k] += precision * by[j] * by[k];
                }
            }
        }
        let chain = Factor::new(&diagonal, &beside)?;
        let mut solved = border.clone();
        chain.solve(&mut solved, width);
        for i in 0..n {
            let (b, x) = (&border[i * width..][..width], &solved[i * width..][..width]);
            for j in 0..p {
                if b[j] == 0.0 {
                    continue;
                }
                own_gradient[j] -= b[j] * x[p];
                for k in 0..=j {
                    own[j][k] -= b[j] * x[k];
                }
            }
        }
        let full = |j: usize, k: usize| own[j.max(k)][j.min(k)];
        let own = (0..p).map(|j| (0..p).map(|k| full(j, k)).collect()).collect();
        Some(Normal { chain, solved, information: own, gradient: own_gradient })
    }

    fn speed(&self, state: &State, scaled_command: f64) -> f64 {
        state.action.iter().rev().fold(0.0, |sum, a| sum * scaled_command + a)
    }

    /// One Gauss-Newton step, shortened until it climbs; whether it did, and how far relative to the
    /// cost.
    pub(super) fn step(&self, state: &mut State, max_delay_s: f64) -> bool {
        let motion = self.motion(state);
        let Some(normal) = self.normal(state, &motion) else { return false };
        let evidence = self.evidence(state, &normal);
        let Some(l) = damped_cholesky(&evidence.stiffened(state.stiffness)) else { return false };
        let (p, width) = (state.unknowns(), state.unknowns() + 1);
        let models: Vec<f64> = cholesky_solve(&l, &evidence.slope(state.stiffness)).iter().map(|x| -x).collect();
        state.spread = normal.chain.inverse_diagonal();
        let before = self.cost(state, &motion);
        let places: Vec<f64> = normal.solved.chunks(width).map(|row| -row[p] - dot(&row[..p], &models)).collect();
        let mut part = 1.0;
        for _halving in 0..12 {
            let next = moved(state, &models, &places, part, max_delay_s);
            let cost = self.cost(&next, &self.motion(&next));
            if cost < before {
                *state = next;
                return before - cost > 1e-3;
            }
            part *= 0.5;
        }
        false
    }

    fn evidence<'b>(&'b self, state: &'b State, normal: &'b Normal) -> Evidence<'b> {
        Evidence {
            information: &normal.information,
            gradient: &normal.gradient,
            bending: &self.bending,
            action: &state.action,
            first: state.shape.unknowns(),
        }
    }

    /// Sets the stiffness to the most likely one.
    pub(super) fn update_stiffness(&self, state: &mut State) {
        if let Some(normal) = self.normal(state, &self.motion(state)) {
            state.stiffness = self.evidence(state, &normal).best_stiffness();
        }
    }

    /// Log-likelihood of the observations in nats, places and bends of the action model integrated out
    /// by Laplace's approximation; minus infinity where there is none.
    pub(super) fn log_likelihood(&self, state: &State) -> f64 {
        let motion = self.motion(state);
        let Some(normal) = self.normal(state, &motion) else { return f64::NEG_INFINITY };
        let n = self.len() as f64;
        let pi = std::f64::consts::PI;
        // The volume enters by the determinant itself.
        let joint = State { spread: Vec::new(), ..state.clone() };
        let of_t = log_peak(state.tail) - ln(state.sigma);
        let of_motion = -0.5 * log_of_product(self.dt_s[1..].iter().map(|dt_s| 2.0 * pi * state.q * dt_s));
        let of_places = 0.5 * self.bend(state) - self.cost(&joint, &motion);
        let of_bend = -0.5 * self.bend(state) + self.evidence(state, &normal).volume(state.stiffness);
        n * of_t + of_motion + of_places + of_bend + 0.5 * n * ln(2.0 * pi) - 0.5 * normal.chain.log_det()
    }

    /// Covariance of the models' coefficients: shape, action, delay.
    pub(super) fn covariance(&self, state: &State) -> Option<Vec<Vec<f64>>> {
        let normal = self.normal(state, &self.motion(state))?;
        let (l, p) = (damped_cholesky(&self.evidence(state, &normal).stiffened(state.stiffness))?, state.unknowns());
        Some(
            (0..p)
                .map(|j| cholesky_solve(&l, &(0..p).map(|k| f64::from(u8::from(j == k))).collect::<Vec<f64>>()))
                .collect(),
        )
    }
}

fn scaled_powers(line: &Line, degree: usize, scale: f64, delay_s: f64) -> (Vec<f64>, Vec<f64>) {
    let (powers, mut command) = line.delayed_powers(degree, scale, delay_s);
    for c in &mut command {
        *c /= scale;
    }
    (powers, command)
}

fn moved(state: &State, models: &[f64], places: &[f64], part: f64, max_delay_s: f64) -> State {
    let scaled: Vec<f64> = models.iter().map(|x| part * x).collect();
    let (shape, rest) = scaled.split_at(state.shape.unknowns());
    let mut next = state.clone();
    next.shape = state.shape.with(shape);
    for (a, step) in next.action.iter_mut().zip(rest) {
        *a += step;
    }
    next.delay_s = state.delay_s.map(|delay_s| {
        let step = rest.last().copied().unwrap_or(0.0);
        (delay_s + step).clamp(-max_delay_s, max_delay_s)
    });
    for (u, step) in next.u.iter_mut().zip(places) {
        *u += part * step;
    }
    next
}

/// Cholesky's factor of a matrix that ought to be positive definite, with as little added to its
/// diagonal as makes it so.
fn damped_cholesky(information: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    [0.0, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1.0].into_iter().find_map(|damping| {
        let mut damped = information.to_vec();
        let greatest = (0..damped.len()).fold(0.0, |most: f64, j| most.max(damped[j][j].abs()));
        for (j, row) in damped.iter_mut().enumerate() {
            row[j] += damping * row[j].abs().max(1e-12 * greatest);
        }
        cholesky(&damped)
    })
}
