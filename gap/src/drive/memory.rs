//! How what is left of the motion scatters in the nominal world, and hangs on what was left before: hills last for tens
//! of seconds, and an error of one scan's pose is in two motions.

use asami_math::elementary::{exp, ln};
use asami_math::regression::Regression;
use serde::{Deserialize, Serialize};

use super::motion::Step;

/// As many steps back is remembered.
const ORDER: usize = 3;
/// Each scatters in its own way.
const CLASSES: usize = 8;
const STANDING: usize = 0;
const UNDER_WAY: usize = 1;
const TURNING: usize = 2;
/// The last step under way, and the first of a car that stands. A car that is played comes to a stand a little earlier or later
/// than the one that was seen, and for half a second the two have nothing in common.
const BRAKED: usize = 3;
const STOPPING: usize = 4;
/// A car that came to a stand rocks on its springs.
const ROCKING: usize = 5;
/// The last step of a car that stands, and the first ones under way.
const LEAVING: usize = 6;
const STARTING: usize = 7;
/// So many steps after it came to a stand a car rocks, the first one apart.
const ROCKS: usize = 2;
/// So many are first ones under way.
const STARTS: usize = 2;
/// As many steps back tell.
const LATELY: usize = 3;
/// Share of steps that are something else: a gear changed elsewhere, scans that were matched to something else.
pub(super) const ASTRAY: f64 = 0.02;
/// How much farther those scatter.
pub(super) const ASTRAY_SCALE: f64 = 6.0;
/// Slower cars stand.
const STANDING_M_PER_S: f64 = 0.3;
/// Faster turns are corners.
const TURNING_RAD_PER_S: f64 = 0.05;
/// Steps farther apart are no neighbours.
const NEAR_S: f64 = 1.6;

/// Memory of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Mean, by class.
    mean: [f64; CLASSES],
    /// What is kept of what was left one, two, three steps before.
    kept: [f64; ORDER],
    /// Standard deviation of what is new, by class.
    spread: [f64; CLASSES],
}

/// What one step says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fresh {
    /// `log p`.
    pub log_likelihood: f64,
    /// What is expected of minus it.
    pub expected: f64,
    /// What is new in it, in standard deviations.
    pub white: f64,
    /// Logarithm of that standard deviation.
    pub ln_scale: f64,
    /// Whether it is of the motion at all.
    pub genuine: bool,
}

/// Whether the car stands.
pub(super) fn stands(step: &Step) -> bool {
    step.v_m_per_s.abs() < STANDING_M_PER_S
}

/// The class of a step, by whether the car stands in it, before it and after it.
fn class(steps: &[Step], i: usize) -> usize {
    let now = stands(&steps[i]);
    let lasted = steps[i.saturating_sub(LATELY)..i].iter().rev().take_while(|step| stands(step) == now).count();
    // What came before the first step is not known.
    let began = lasted < i;
    let changes = steps.get(i + 1).is_some_and(|next| stands(next) != now);
    match now {
        true if began && lasted == 0 => STOPPING,
        true if changes => LEAVING,
        true if began && lasted <= ROCKS => ROCKING,
        true => STANDING,
        false if changes => BRAKED,
        false if began && lasted < STARTS => STARTING,
        false if steps[i].omega_rad_per_s.abs() > TURNING_RAD_PER_S => TURNING,
        false => UNDER_WAY,
    }
}

/// Whether something is kept of what was left before: a car that stands, or comes to it, has no speed to keep.
fn keeps(class: usize) -> bool {
    matches!(class, UNDER_WAY | TURNING | BRAKED | STARTING)
}

/// Whether no step is missing of those that are remembered at step `i`.
fn remembers(steps: &[Step], i: usize) -> bool {
    let first = i.checked_sub(ORDER);
    first.is_some_and(|first| steps[first..=i].windows(2).all(|pair| pair[1].t_s - pair[0].t_s < NEAR_S))
}

/// Probability's logarithm of a number that is normal most of the time, and whether it is one of those times.
pub(super) fn contaminated(squares: f64, dimensions: f64, ln_scale: f64) -> (f64, bool) {
    let usual = ln(1.0 - ASTRAY) - 0.5 * squares;
    let astray = ln(ASTRAY) - 0.5 * squares / (ASTRAY_SCALE * ASTRAY_SCALE) - dimensions * ln(ASTRAY_SCALE);
    let greater = usual.max(astray);
    let sum = greater + ln(exp(usual - greater) + exp(astray - greater));
    (sum - 0.5 * dimensions * ln(std::f64::consts::TAU) - ln_scale, usual > astray)
}

impl Memory {
    /// The memory in what nominal logs leave of one axis.
    #[must_use]
    pub fn learn(logs: &[(&[Step], Vec<f64>)]) -> Self {
        let mut memory = Self { spread: [1.0; CLASSES], ..Self::default() };
        for (class_of, mean) in memory.mean.iter_mut().enumerate() {
            let of = |(steps, left): &(&[Step], Vec<f64>)| -> Vec<f64> {
                left.iter().enumerate().filter(|(i, _)| class(steps, *i) == class_of).map(|(_, left)| *left).collect()
            };
            let mut all: Vec<f64> = logs.iter().flat_map(of).collect();
            all.sort_by(f64::total_cmp);
            // The middle half's mean: some steps are something else.
            let middle = &all[all.len() / 4..all.len() - all.len() / 4];
            *mean = middle.iter().fold(0.0, |sum, it| sum + it) / middle.len().max(1) as f64;
        }
        for _ in 0..4 {
            memory = memory.again(logs);
        }
        memory
    }

    /// The same about no mean at all: of a real car a mean is no noise.
    #[must_use]
    pub fn about_none(self) -> Self {
        Self { mean: [0.0; CLASSES], ..self }
    }

    fn again(&self, logs: &[(&[Step], Vec<f64>)]) -> Self {
        let first = self.spread[UNDER_WAY] == 1.0;
        let mut regression = Regression::new(ORDER);
        let mut sums = [[1e-12; 2]; CLASSES];
        for (steps, left) in logs {
            for i in ORDER..steps.len() {
                let (Some(before), class) = (self.before(steps, left, i), class(steps, i)) else { continue };
                let now = left[i] - self.mean[class];
                let off = now - self.kept_of(class, &before);
                let squares = (off / self.spread[class]) * (off / self.spread[class]);
                let usual = first || contaminated(squares, 1.0, 0.0).1;
                if usual {
                    if keeps(class) {
                        regression.observe(&before, now, 1.0 / (self.spread[class] * self.spread[class]));
                    }
                    sums[class][0] += off * off;
                    sums[class][1] += 1.0;
                }
            }
        }
        let kept = regression
            .solve()
            .filter(|fit| fit.rank == ORDER)
            .map_or(self.kept, |fit| [fit.coefficients[0], fit.coefficients[1], fit.coefficients[2]]);
        let all = sums.iter().fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
        // A class that is hardly seen is taken for like the others.
        let spread = sums.map(|[squares, n]| ((squares + 5.0 * all[0] / all[1].max(1.0)) / (n + 5.0)).sqrt().max(1e-6));
        Self { kept, spread, ..*self }
    }

    /// What was left before step `i`, the nearest first; `None` where a step is missing.
    fn before(&self, steps: &[Step], left: &[f64], i: usize) -> Option<[f64; ORDER]> {
        remembers(steps, i).then(|| std::array::from_fn(|k| left[i - 1 - k] - self.mean[class(steps, i - 1 - k)]))
    }

    /// What a step of a class keeps of those before.
    fn kept_of(&self, class: usize, before: &[f64; ORDER]) -> f64 {
        if keeps(class) { self.kept.iter().zip(before).fold(0.0, |sum, (k, b)| sum + k * b) } else { 0.0 }
    }

    /// What step `i` says, were scatter `exp(louder)` times as great, and were something else in it of this mean and
    /// variance; `None` where steps before it are missing.
    #[must_use]
    pub fn fresh(&self, steps: &[Step], left: &[f64], i: usize, louder: f64, beside: [f64; 2]) -> Option<Fresh> {
        let class = class(steps, i);
        let before = self.before(steps, left, i)?;
        let expected = self.mean[class] + self.kept_of(class, &before);
        let own = self.spread[class] * exp(louder);
        let ln_scale = 0.5 * ln(own * own + beside[1]);
        let white = (left[i] - expected - beside[0]) / exp(ln_scale);
        let (log_likelihood, genuine) = contaminated(white * white, 1.0, ln_scale);
        let expected = 0.5 + 0.5 * ln(std::f64::consts::TAU) + ln_scale;
        Some(Fresh { log_likelihood, expected, white, ln_scale, genuine })
    }

    /// What is new in a column at step `i`, less what would be kept of it; 0 where steps before it are missing.
    #[must_use]
    pub fn new_in(&self, steps: &[Step], column: &[f64], i: usize) -> f64 {
        if !remembers(steps, i) {
            return 0.0;
        }
        column[i] - self.kept_of(class(steps, i), &std::array::from_fn(|k| column[i - 1 - k]))
    }

    /// Standard deviation of what is new in step `i`.
    #[must_use]
    pub fn spread_of(&self, steps: &[Step], i: usize) -> f64 {
        self.spread[class(steps, i)]
    }

    /// As many steps say nothing by themselves.
    pub const SILENT: usize = ORDER;
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_dataset::Seed;
    use rand_distr::{Distribution, StandardNormal};

    fn step(i: usize) -> Step {
        Step { t_s: 0.5 * i as f64, dt_s: 0.5, v_m_per_s: 5.0, omega_rad_per_s: 0.0 }
    }

    #[test]
    fn densities_that_allow_for_what_is_astray_add_up_to_one() {
        let width = 0.01;
        let sum: f64 =
            (-4000..4000).map(|i| width * contaminated((f64::from(i) * width).powi(2), 1.0, 0.0).0.exp()).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn a_stop_is_apart_from_standing_and_driving() {
        let speeds = [0.0, 0.0, 4.0, 5.0, 5.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0];
        let turning = |i: usize| if i == 4 { 0.3 } else { 0.0 };
        let moving = |(i, v): (usize, &f64)| Step { v_m_per_s: *v, omega_rad_per_s: turning(i), ..step(i) };
        let steps: Vec<Step> = speeds.iter().enumerate().map(moving).collect();
        let classes: Vec<usize> = (0..steps.len()).map(|i| class(&steps, i)).collect();
        let wanted = [
            STANDING, LEAVING, STARTING, STARTING, TURNING, BRAKED, STOPPING, ROCKING, ROCKING, STANDING, STANDING,
            LEAVING, STARTING,
        ];
        assert_eq!(classes, wanted);
    }

    /// Where a car stops, something else is left than under way: what stops scatter in does not scatter what is under way.
    #[test]
    fn stops_scatter_by_themselves() {
        let mut rng = Seed(5).stream("drive/memory/stops");
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let stands = |i: usize| i % 20 >= 14;
        let speed = |i: usize| if stands(i) { 0.0 } else { 5.0 };
        let steps: Vec<Step> = (0..8000).map(|i| Step { v_m_per_s: speed(i), ..step(i) }).collect();
        let scatter = |i: usize| [0.02, 0.5][usize::from(class(&steps, i) == STOPPING)];
        let left: Vec<f64> = (0..steps.len()).map(|i| scatter(i) * normal()).collect();
        let memory = Memory::learn(&[(&steps, left)]);
        assert!((memory.spread[UNDER_WAY] / 0.02 - 1.0).abs() < 0.05, "{memory:?}");
        assert!((memory.spread[STOPPING] / 0.5 - 1.0).abs() < 0.15, "{memory:?}");
        assert!((memory.spread[STANDING] / 0.02 - 1.0).abs() < 0.2, "{memory:?}");
    }

    /// An autoregression of first order with 0.8 and a scatter of 0.02, a step in fifty of them somewhere else.
    #[test]
    fn an_autoregression_is_learned_and_what_is_new_in_it_is_white() {
        let mut rng = Seed(3).stream("drive/memory");
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let steps: Vec<Step> = (0..4000).map(step).collect();
        let mut last = 0.0;
        let left: Vec<f64> = (0..4000)
            .map(|_| {
                last = 0.8 * last + 0.02 * normal();
                0.1 + last
            })
            .collect();
        let memory = Memory::learn(&[(&steps, left.clone())]);
        let [a, b, c] = memory.kept;
        // Standard errors are sqrt((1 - 0.64) / 4000), about 0.01.
        assert!((a - 0.8).abs() < 0.06 && b.abs() < 0.08 && c.abs() < 0.06, "{memory:?}");
        assert!((memory.spread[1] - 0.02).abs() < 0.001 && (memory.mean[1] - 0.1).abs() < 0.01, "{memory:?}");
        let squares: f64 =
            (3..4000).filter_map(|i| memory.fresh(&steps, &left, i, 0.0, [0.0; 2])).map(|it| it.white.powi(2)).sum();
        assert!((squares - 3997.0).abs() < 4.0 * (2.0_f64 * 3997.0).sqrt() + 40.0, "{squares}");
    }
}
