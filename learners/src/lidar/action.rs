//! From motions and pedals to the car's action model (eqs 5.3 to 5.5).

use asami_dataset::{Action, ActionModel, Command};
use asami_math::regression::Regression;

/// What the car did over one interval, and what was commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// When it begins.
    pub t_s: f64,
    /// How long it lasts.
    pub dt_s: f64,
    /// Mean forward speed.
    pub v_m_per_s: f64,
    /// Mean turning rate, counter-clockwise.
    pub omega_rad_per_s: f64,
    /// Means of throttle, brake and steering over it.
    pub pedals: [f64; 3],
}

/// The coefficients c5 to c10 and their standard errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// c5 to c10.
    pub c: [f64; 6],
    /// Their standard errors; `None` where the data do not determine them all.
    pub se: Option<[f64; 6]>,
}

impl Coefficients {
    /// Of a model of pedals; `None` of any other.
    #[must_use]
    pub fn of(model: &ActionModel) -> Option<Self> {
        match model {
            ActionModel::Car { c, se, .. } => Some(Self { c: *c, se: *se }),
            _ => None,
        }
    }

    /// As a model.
    #[must_use]
    pub fn model(&self, delay_s: f64) -> ActionModel {
        ActionModel::Car { c: self.c, se: self.se, delay_s }
    }

    /// Acceleration (eq. 5.3).
    #[must_use]
    pub fn acceleration(&self, v_m_per_s: f64, [throttle, brake, _]: [f64; 3]) -> f64 {
        self.c[0] + self.c[1] * throttle + self.c[2] * v_m_per_s + self.c[3] * v_m_per_s * brake
    }

    /// Turning rate (eq. 5.4).
    #[must_use]
    pub fn turning(&self, v_m_per_s: f64, [_, _, steering]: [f64; 3]) -> f64 {
        self.c[4] * v_m_per_s + self.c[5] * v_m_per_s * steering
    }
}

/// Means of throttle, brake and steering over `[from_s, to_s)`, each command holding until the next; `None` before the first
/// command, and of other commands than pedals.
#[must_use]
pub fn pedals(commands: &[Command], from_s: f64, to_s: f64) -> Option<[f64; 3]> {
    let first = commands.partition_point(|command| command.t_s <= from_s).checked_sub(1)?;
    let (mut sums, mut at_s) = ([0.0; 3], from_s);
    for (i, command) in commands.iter().enumerate().skip(first) {
        let until_s = commands.get(i + 1).map_or(to_s, |next| next.t_s.min(to_s));
        let Action::Pedals { throttle, brake, steering } = command.action else { return None };
        for (sum, value) in sums.iter_mut().zip([throttle, brake, steering]) {
            *sum += value * (until_s - at_s);
        }
        at_s = until_s;
        if at_s >= to_s {
            break;
        }
    }
    Some(sums.map(|sum| sum / (to_s - from_s)))
}

/// How far a stretch may begin from where the one before it ends, to count as following it, as a share of its length.
const SEAM: f64 = 0.01;

/// Whether `next` begins where `stretch` ends.
#[must_use]
pub fn follows(stretch: &Stretch, next: &Stretch) -> bool {
    (next.t_s - stretch.t_s - stretch.dt_s).abs() <= SEAM * stretch.dt_s
}

/// The regressions of eqs 5.3 and 5.4 as published: accelerations are differences of the speeds of following stretches. `None`
/// without following stretches.
#[must_use]
pub fn regress(stretches: &[Stretch]) -> Option<Coefficients> {
    let (mut faster, mut turning) = (Regression::new(4), Regression::new(2));
    for (i, now) in stretches.iter().enumerate() {
        let ([throttle, brake, steering], v) = (now.pedals, now.v_m_per_s);
        if let Some(next) = stretches.get(i + 1).filter(|next| follows(now, next)) {
            faster.observe(&[1.0, throttle, v, v * brake], (next.v_m_per_s - v) / (next.t_s - now.t_s), 1.0);
        }
        turning.observe(&[v, v * steering], now.omega_rad_per_s, 1.0);
    }
    let join = |a: &[f64], b: &[f64]| {
        let mut all = [0.0; 6];
        all.iter_mut().zip(a.iter().chain(b)).for_each(|(slot, value)| *slot = *value);
        all
    };
    let se = faster.standard_errors().zip(turning.standard_errors()).map(|(a, b)| join(&a, &b));
    Some(Coefficients { c: join(&faster.solve()?.coefficients, &turning.solve()?.coefficients), se })
}

/// Speeds that the model predicts open-loop from the first stretch's measured speed (eq. 5.5), anew after a gap.
#[must_use]
pub fn roll_out(coefficients: &Coefficients, stretches: &[Stretch]) -> Vec<f64> {
    let mut speeds: Vec<f64> = Vec::with_capacity(stretches.len());
    for (i, now) in stretches.iter().enumerate() {
        let before = i.checked_sub(1).map(|j| (stretches[j], speeds[j])).filter(|(before, _)| follows(before, now));
        speeds.push(before.map_or(now.v_m_per_s, |(before, v)| {
            v + coefficients.acceleration(v, before.pedals) * (now.t_s - before.t_s)
        }));
    }
    speeds
}
