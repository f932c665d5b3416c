//! An action model that runs free: its own speed, not the measured one, decides how the speed goes on.
//!
//! A regression of accelerations weighs every step by itself, and what it gets wrong adds up where the model is rolled out. Here the
//! coefficients are those whose roll-out over the whole drive comes nearest the measured speeds (the output-error method: Ljung 1999,
//! System Identification, section 7.2), by Gauss-Newton steps from the regression's.

use asami_dataset::Command;
use asami_math::regression::Regression;

use super::action::{Coefficients, Stretch, follows, pedals};
use super::registered::{Registered, delays_s, judged};

/// Parts of a stretch in which the speed is integrated.
const PARTS: u32 = 10;

/// Gauss-Newton steps at most, and how often one is halved that makes things worse.
const MOST_STEPS: u32 = 30;
const HALVINGS: u32 = 8;

/// A step that lowers the sum of squares by less than this share of it is the last.
const SETTLED: f64 = 1e-7;

/// What a model makes of one stretch by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Mean speed.
    pub v_m_per_s: f64,
    /// Mean turning rate.
    pub omega_rad_per_s: f64,
    /// How the mean speed changes with c5 to c8.
    pub gradient: [f64; 4],
}

/// Mean speeds and turning rates of each stretch by the model and the pedals alone, from the first stretch's measured speed on; with
/// `anew`, from the measured speed after every gap. Pedals act `delay_s` late.
#[must_use]
pub fn free_run(
    coefficients: &Coefficients,
    stretches: &[Stretch],
    commands: &[Command],
    delay_s: f64,
    anew: bool,
) -> Vec<Run> {
    let mut v = stretches.first().map_or(0.0, |first| first.v_m_per_s);
    let mut gradient = [0.0; 4];
    let mut runs = Vec::with_capacity(stretches.len());
    for (i, now) in stretches.iter().enumerate() {
        if anew && i.checked_sub(1).is_some_and(|before| !follows(&stretches[before], now)) {
            (v, gradient) = (now.v_m_per_s, [0.0; 4]);
        }
        let part_s = now.dt_s / f64::from(PARTS);
        let (mut way_m, mut turn_rad, mut gradients) = (0.0, 0.0, [0.0; 4]);
        for part in 0..PARTS {
            let from_s = now.t_s + f64::from(part) * part_s - delay_s;
            let held = pedals(commands, from_s, from_s + part_s).unwrap_or(now.pedals);
            // The rule of the midpoint, and its derivative.
            let fades = coefficients.c[2] + coefficients.c[3] * held[1];
            let middle = v + 0.5 * part_s * coefficients.acceleration(v, held);
            let (at_start, at_middle) = ([1.0, held[0], v, v * held[1]], [1.0, held[0], middle, middle * held[1]]);
            for k in 0..4 {
                let half = gradient[k] + 0.5 * part_s * (fades * gradient[k] + at_start[k]);
                gradients[k] += half * part_s;
                gradient[k] += part_s * (fades * half + at_middle[k]);
            }
            way_m += middle * part_s;
            turn_rad += coefficients.turning(middle, held) * part_s;
            v += part_s * coefficients.acceleration(middle, held);
        }
        runs.push(Run {
            v_m_per_s: way_m / now.dt_s,
            omega_rad_per_s: turn_rad / now.dt_s,
            gradient: gradients.map(|sum| sum / now.dt_s),
        });
    }
    runs
}

/// How the roll-out that comes nearest is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRun {
    /// What it starts from; its delays are tried, and its prior holds.
    pub from: Registered,
}

/// A fit at one delay.
struct Fitted {
    coefficients: Coefficients,
    objective: f64,
    residual_ss: f64,
}

impl FreeRun {
    /// The coefficients and the delay; `None` where the stretches determine nothing.
    #[must_use]
    pub fn learn(&self, stretches: &[Stretch], commands: &[Command]) -> Option<(Coefficients, f64)> {
        let used = judged(stretches, commands, self.from.most_delay_s)?;
        let n = used.len() as f64;
        let mut best: Option<(f64, Coefficients, f64)> = None;
        for delay_s in delays_s(self.from.most_delay_s) {
            let Some((_, turning_ss, begun)) = self.from.at(used, commands, delay_s) else { continue };
            let Some(fitted) = self.fit(begun, used, commands, delay_s) else { continue };
            let ln_variance = |residual_ss: f64| asami_math::elementary::ln((residual_ss / n).max(1e-12));
            let cost = n * (ln_variance(fitted.residual_ss) + ln_variance(turning_ss));
            if best.as_ref().is_none_or(|best| cost < best.0) {
                best = Some((cost, fitted.coefficients, delay_s));
            }
        }
        best.map(|(_, coefficients, delay_s)| (coefficients, delay_s))
    }

    /// The coefficients whose roll-out comes nearest.
    fn fit(&self, begun: Coefficients, used: &[Stretch], commands: &[Command], delay_s: f64) -> Option<Fitted> {
        let mut at = self.run(begun, used, commands, delay_s)?;
        for _ in 0..MOST_STEPS {
            let step = at.1.solve()?.coefficients;
            let mut share = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let mut moved = at.0.coefficients;
                moved.c.iter_mut().zip(&step).for_each(|(c, step)| *c += share * step);
                next = self.run(moved, used, commands, delay_s).filter(|next| next.0.objective < at.0.objective);
                if next.is_some() {
                    break;
                }
                share /= 2.0;
            }
            let Some(next) = next else { break };
            let settled = next.0.objective > (1.0 - SETTLED) * at.0.objective;
            at = next;
            if settled {
                break;
            }
        }
        let (mut fitted, regression) = at;
        let wider = lasting(&free_run(&fitted.coefficients, used, commands, delay_s, true), used);
        if let (Some(se), Some(all)) = (regression.standard_errors(), fitted.coefficients.se.as_mut()) {
            all.iter_mut().zip(se).for_each(|(slot, se)| *slot = se * wider);
        }
        Some(fitted)
    }

    /// A roll-out, and the regression of what it leaves on how it changes with the coefficients.
    fn run(
        &self,
        coefficients: Coefficients,
        used: &[Stretch],
        commands: &[Command],
        delay_s: f64,
    ) -> Option<(Fitted, Regression)> {
        let runs = free_run(&coefficients, used, commands, delay_s, true);
        let mut regression = Regression::new(4);
        let mut residual_ss = 0.0;
        for (run, now) in runs.iter().zip(used) {
            let residual = now.v_m_per_s - run.v_m_per_s;
            residual_ss += residual * residual;
            regression.observe(&run.gradient, residual, 1.0);
        }
        let mut objective = residual_ss;
        for (i, row, weight) in self.from.prior(used, residual_ss / used.len() as f64) {
            let term = row[i] * coefficients.c[i];
            objective += weight * term * term;
            regression.observe(&row, -term, weight);
        }
        objective.is_finite().then_some((Fitted { coefficients, objective, residual_ss }, regression))
    }
}

/// The factor on standard errors where what is left of the speed lasts from one stretch to the next: of a first-order process with the
/// correlation of neighbours that was found.
fn lasting(runs: &[Run], used: &[Stretch]) -> f64 {
    let left: Vec<f64> = runs.iter().zip(used).map(|(run, now)| now.v_m_per_s - run.v_m_per_s).collect();
    let (mut same, mut next) = (0.0, 0.0);
    for pair in left.windows(2) {
        same += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]);
        next += pair[0] * pair[1];
    }
    let rho = if same > 0.0 { (next / same).clamp(0.0, 0.99) } else { 0.0 };
    ((1.0 + rho) / (1.0 - rho)).sqrt()
}
