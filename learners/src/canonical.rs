//! Both models at once, in closed form and from no starting model.
//!
//! Eq. 3.1 of Stronger 2008, `S(o_t) = w_0 + sum A(c_i) dt`, is linear in the coefficients of S and A
//! together. Of all pairs of a polynomial S and an action model A, the one whose two sides go
//! together best is the first canonical correlation (Hotelling 1936) between the powers of `o` and
//! the cumulated powers of `c`.
//!
//! The robot's true place strays from the sum of its actions as a random walk does, so that the two sides
//! part over a long log. A high-pass filter, linear and hence harmless to the equation, keeps the last
//! [`memory_s`](Canonical::memory_s) seconds only; `w_0` leaves with it.
//!
//! What remains is the bias of a closed form: noise in `o` inflates the variance of S(o) where S is steep.
//! Subtracting it to first order (Fuller 1987) was tried and did harm where the noise is not white.

use asami_dataset::models::Curve;
use asami_dataset::{ActionModel, Log, Models, Noise, Rng, SensorModel};
use asami_math::decomposition::{dot, svd};
use asami_math::elementary::exp;
use asami_math::polynomial::{Polynomial, powers};
use asami_math::regression::Regression;

use crate::learner::{CannotLearn, Learned, Learner, Verdict, learner};
use crate::line::{Line, Unit};

learner! {
    /// The first canonical correlation between powers of the observation and cumulated powers of the
    /// command: one pass, constant space, no starting model.
    ///
    /// Scale and sign are set so that the action model regressed on the command has slope 1: units are
    /// metres as the commands understand them, and speed grows with the command. The sensor model is
    /// zero where the observation is in the middle of its range.
    Canonical, "canonical",
    "Learns both models at once as a first canonical correlation, in closed form, from no starting model.",
    source "eq. 3.1 of Stronger 2008 as a canonical correlation (Hotelling 1936)", needs Nothing,
    {
        /// Degree of the sensor model, a polynomial of the observation.
        sensor_degree: u32 = 3, "1", 1.0..=8.0;
        /// Degree of the action model, a polynomial of the command.
        action_degree: u32 = 4, "1", 1.0..=8.0;
        /// Time constant of the high-pass filter on both sides of the equation.
        memory_s: f64 = 6.0, "s", 0.5..=100000.0;
    }
}

impl Learner for Canonical {
    fn learn(&self, log: &Log, _given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        let pair = self.pair(&line)?;
        let sigma = Some(line.local_noise());
        let noise = match line.unit {
            Unit::HeightPx => Noise { sigma1_px: sigma, ..Noise::default() },
            Unit::RangeM => Noise { sigma1_m: sigma, ..Noise::default() },
        };
        Ok(Learned {
            models: Models {
                action: Some(ActionModel::Polynomial(Curve::from(pair.action))),
                sensor: Some(SensorModel::DistanceOfHeight(Curve::from(pair.sensor))),
                noise,
            },
            verdict: Verdict::Converged,
            lacks: line.lacks(self.action_degree as usize),
            ..Learned::default()
        })
    }
}

/// The two models of eq. 3.1, in one unit of length.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    pub(crate) sensor: Polynomial,
    pub(crate) action: Polynomial,
}

impl Canonical {
    /// The pair of models whose estimates of place go together best.
    pub(crate) fn pair(&self, line: &Line) -> Result<Pair, CannotLearn> {
        let (n_s, n_a) = (self.sensor_degree as usize, self.action_degree as usize + 1);
        line.require(n_s + n_a + 2)?;
        let (centre, scale) = line.observation_scaling();
        let command_scale = line.command_scale();
        let moments = Moments::of(line, self.memory_s, n_s, n_a, centre, scale, command_scale);
        let (s, a) = moments
            .first_canonical_pair()
            .ok_or_else(|| CannotLearn::Undetermined("observations and commands do not change together".to_string()))?;
        let sensor = Polynomial { coefficients: [vec![0.0], s].concat(), centre, scale };
        let action = Polynomial { coefficients: a, centre: 0.0, scale: command_scale };
        let k = metres_per_unit(line, &action)?;
        let times = |p: Polynomial| Polynomial { coefficients: p.coefficients.iter().map(|c| c * k).collect(), ..p };
        Ok(Pair { sensor: times(sensor), action: times(action) })
    }
}

/// The factor that gives `action`, regressed on the commands in force, slope 1.
pub(crate) fn metres_per_unit(line: &Line, action: &Polynomial) -> Result<f64, CannotLearn> {
    let (mut c_c, mut c_a) = (0.0, 0.0);
    for piece in line.all_pieces() {
        c_c += piece.c_m_per_s * piece.c_m_per_s * piece.dt_s;
        c_a += piece.c_m_per_s * action.at(piece.c_m_per_s) * piece.dt_s;
    }
    let k = c_c / c_a;
    let undetermined = || CannotLearn::Undetermined("the speed does not change with the command".to_string());
    if k.is_finite() && k != 0.0 { Ok(k) } else { Err(undetermined()) }
}

/// Second moments of both sides of eq. 3.1, as a triangular factor: constant space.
struct Moments {
    /// Columns of the factor that belong to the cumulated powers of the command.
    actions: Vec<Vec<f64>>,
    /// Columns that belong to the powers of the observation.
    sensors: Vec<Vec<f64>>,
}

impl Moments {
    fn of(line: &Line, memory_s: f64, n_s: usize, n_a: usize, centre: f64, scale: f64, command_scale: f64) -> Self {
        let mut regression = Regression::new(n_a + n_s);
        let mut low_pass = LowPass { memory_s, seen_s: 0.0, values: vec![0.0; n_a + n_s] };
        let mut cumulated = vec![0.0; n_a];
        let mut before_s = line.start_s;
        for (i, row) in line.rows.iter().enumerate() {
            for (sum, power) in cumulated.iter_mut().zip(line.powers(i, n_a - 1, command_scale)) {
                *sum += power;
            }
            let u = (row.o - centre) / scale;
            let o_powers = powers(u, n_s);
            let all = [&cumulated[..], &o_powers[1..]].concat();
            let high = low_pass.part(&all, row.t_s - before_s);
            before_s = row.t_s;
            regression.observe(&high, 0.0, 1.0);
        }
        let factor = regression.factor();
        let column = |j: usize| factor.iter().map(|row| row[j]).collect::<Vec<f64>>();
        Self { actions: (0..n_a).map(column).collect(), sensors: (n_a..n_a + n_s).map(column).collect() }
    }

    /// Coefficients of S (less its constant) and of A; `None` where either side does not change.
    fn first_canonical_pair(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let basis = svd(&self.actions);
        let cut = 1e-9 * basis.values.first()?;
        let rank = basis.values.iter().take_while(|s| **s > cut).count();
        let sensors = svd(&self.sensors);
        let cut = 1e-9 * sensors.values.first()?;
        let sensor_rank = sensors.values.iter().take_while(|s| **s > cut).count();
        // Cosines between the two sides' directions.
        let columns: Vec<Vec<f64>> = basis.left[..rank]
            .iter()
            .map(|u| sensors.left[..sensor_rank].iter().map(|v| dot(u, v)).collect())
            .collect();
        let parts = svd(&columns);
        let best = parts.left.first().filter(|_| parts.values[0] > 0.0)?;
        let s: Vec<f64> = (0..self.sensors.len())
            .map(|j| (0..sensor_rank).fold(0.0, |sum, k| sum + best[k] / sensors.values[k] * sensors.right[k][j]))
            .collect();
        // A is the regression of S(o) on the cumulated powers.
        let place: Vec<f64> = (0..self.actions[0].len())
            .map(|i| s.iter().zip(&self.sensors).fold(0.0, |sum, (s, p)| sum + s * p[i]))
            .collect();
        let along: Vec<f64> = basis.left[..rank].iter().map(|u| dot(u, &place)).collect();
        let a = (0..self.actions.len())
            .map(|j| (0..rank).fold(0.0, |sum, k| sum + along[k] / basis.values[k] * basis.right[k][j]))
            .collect::<Vec<f64>>();
        s.iter().chain(&a).all(|x: &f64| x.is_finite()).then_some((s, a))
    }
}

/// A running mean with exponential memory.
struct LowPass {
    memory_s: f64,
    seen_s: f64,
    values: Vec<f64>,
}

impl LowPass {
    /// What `now` has above the mean of the past.
    fn part(&mut self, now: &[f64], dt_s: f64) -> Vec<f64> {
        self.seen_s += dt_s;
        // A plain mean until the memory is full.
        let mean_s = if self.seen_s < self.memory_s { self.seen_s } else { self.memory_s };
        let gain = if mean_s > 0.0 { 1.0 - exp(-dt_s / mean_s) } else { 1.0 };
        for (mean, x) in self.values.iter_mut().zip(now) {
            *mean += gain * (x - *mean);
        }
        now.iter().zip(&self.values).map(|(x, mean)| x - mean).collect()
    }
}
