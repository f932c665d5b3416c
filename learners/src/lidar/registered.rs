//! An action model from accelerations and pedals over the same time.
//!
//! The speed of an interval is its mean. The difference of two such is the acceleration over both intervals, weighted by a triangle that
//! rises over the first and falls over the second; as published the pedals are averaged over the first alone, and run half an interval
//! ahead. Here they are weighted by the same triangle.

use asami_dataset::Command;
use asami_math::regression::Regression;

use super::action::{Coefficients, Stretch, follows, pedals};

/// What the tyres of a car hold, about (m/s^2).
const GRIP_M_PER_S2: f64 = 9.81;

/// Step of the delays that are tried.
const DELAY_STEP_S: f64 = 0.05;

/// How registered accelerations become coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registered {
    /// Delays of the actuators up to this are tried, in steps of 0.05 s; the one whose residuals are least is taken.
    pub most_delay_s: f64,
    /// No term of eq. 5.3 at its greatest is likely to make more than this share of what tyres hold, 9.81 m/s^2: a normal
    /// prior about 0 with that standard deviation at full pedals and the drive's greatest speed. 0: no prior. It leaves alone what the drive
    /// tells, and keeps what the drive does not tell (a brake that was hardly touched) from being anything at all.
    pub grip: f64,
}

/// Parts of an interval over which pedals are averaged before they are weighted.
const PARTS: u32 = 4;

/// Means of throttle, brake and steering from the beginning of `now` to the end of `next`, weighted by the triangle, `delay_s` earlier.
fn triangle(commands: &[Command], now: &Stretch, next: &Stretch, delay_s: f64) -> Option<[f64; 3]> {
    let (mut sums, mut weights) = ([0.0; 3], 0.0);
    for (stretch, rises) in [(now, true), (next, false)] {
        let part_s = stretch.dt_s / f64::from(PARTS);
        for part in 0..PARTS {
            let from_s = stretch.t_s - delay_s + f64::from(part) * part_s;
            let along = (f64::from(part) + 0.5) / f64::from(PARTS);
            let weight = part_s * if rises { along } else { 1.0 - along };
            let means = pedals(commands, from_s, from_s + part_s)?;
            sums.iter_mut().zip(means).for_each(|(sum, mean)| *sum += weight * mean);
            weights += weight;
        }
    }
    Some(sums.map(|sum| sum / weights))
}

/// The delays up to `most_s` that are tried.
pub(super) fn delays_s(most_s: f64) -> impl Iterator<Item = f64> {
    let steps = (most_s / DELAY_STEP_S).floor().clamp(0.0, 100.0) as u32;
    (0..=steps).map(|step| f64::from(step) * DELAY_STEP_S)
}

/// The stretches on which every delay up to `most_s` is judged: those whose pedals are known at the longest.
pub(super) fn judged<'a>(stretches: &'a [Stretch], commands: &[Command], most_s: f64) -> Option<&'a [Stretch]> {
    let known_from_s = commands.first()?.t_s + delays_s(most_s).last()?;
    Some(&stretches[stretches.partition_point(|stretch| stretch.t_s < known_from_s)..])
}

impl Registered {
    /// The coefficients and the delay; `None` where the stretches determine nothing.
    #[must_use]
    pub fn learn(&self, stretches: &[Stretch], commands: &[Command]) -> Option<(Coefficients, f64)> {
        let used = judged(stretches, commands, self.most_delay_s)?;
        let n = used.len() as f64;
        let mut best: Option<(f64, Coefficients, f64)> = None;
        for delay_s in delays_s(self.most_delay_s) {
            let Some((faster_ss, turning_ss, coefficients)) = self.at(used, commands, delay_s) else { continue };
            let ln_variance = |residual_ss: f64| asami_math::elementary::ln((residual_ss / n).max(1e-12));
            // Minus twice the log-likelihood of both regressions, up to a constant.
            let cost = n * (ln_variance(faster_ss) + ln_variance(turning_ss));
            if cost.is_finite() && best.as_ref().is_none_or(|best| cost < best.0) {
                best = Some((cost, coefficients, delay_s));
            }
        }
        best.map(|(_, coefficients, delay_s)| (coefficients, delay_s))
    }

    /// Both regressions' sums of squared residuals at a delay, and their coefficients.
    pub(super) fn at(&self, used: &[Stretch], commands: &[Command], delay_s: f64) -> Option<(f64, f64, Coefficients)> {
        let (mut faster, mut turning) = (Regression::new(4), Regression::new(2));
        for (i, now) in used.iter().enumerate() {
            let v = now.v_m_per_s;
            let [_, _, steering] = pedals(commands, now.t_s - delay_s, now.t_s - delay_s + now.dt_s)?;
            turning.observe(&[v, v * steering], now.omega_rad_per_s, 1.0);
            if let Some(next) = used.get(i + 1).filter(|next| follows(now, next)) {
                let [throttle, brake, _] = triangle(commands, now, next, delay_s)?;
                faster.observe(&[1.0, throttle, v, v * brake], (next.v_m_per_s - v) / (next.t_s - now.t_s), 1.0);
            }
        }
        let (free, bend) = (faster.solve()?, turning.solve()?);
        for (_, row, weight) in self.prior(used, free.residual_ss / used.len() as f64) {
            faster.observe(&row, 0.0, weight);
        }
        let fit = faster.solve()?;
        let join = |a: &[f64], b: &[f64]| {
            let mut all = [0.0; 6];
            all.iter_mut().zip(a.iter().chain(b)).for_each(|(slot, value)| *slot = *value);
            all
        };
        let se = faster.standard_errors().zip(turning.standard_errors()).map(|(a, b)| join(&a, &b));
        Some((free.residual_ss, bend.residual_ss, Coefficients { c: join(&fit.coefficients, &bend.coefficients), se }))
    }

    /// The prior as rows of a regression whose residuals have this variance: which coefficient, its row, its weight.
    pub(super) fn prior(&self, used: &[Stretch], variance: f64) -> impl Iterator<Item = (usize, [f64; 4], f64)> {
        let fastest = used.iter().fold(1.0f64, |fastest, stretch| fastest.max(stretch.v_m_per_s.abs()));
        let sd = self.grip * GRIP_M_PER_S2;
        let row = move |(i, most): (usize, f64)| {
            let mut row = [0.0; 4];
            row[i] = most;
            (i, row, variance.max(1e-12) / (sd * sd))
        };
        [1.0, 1.0, fastest, fastest].into_iter().enumerate().filter(move |_| sd > 0.0).map(row)
    }
}
