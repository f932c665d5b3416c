//! How noisy a real robot and its sensor are, out of stretches of the log that are set aside for it.
//!
//! A nominal world's noise is of its simulator. Held against a real log, whose noise is another, every cause that scatters
//! would be evident, and none that moves something would be weighed as it should. Stretches that are not diagnosed say how
//! large the noise is, and how long it lasts: everything else is left free there, so that no gap is taken for noise.

use asami_dataset::Log;
use asami_math::elementary::exp;
use asami_math::optimise::golden_section;
use asami_math::statistics::median;

use crate::aside::Aside;
use crate::blocks::likeliest;
use crate::judge::Judge;
use crate::library::Library;
use crate::memory::Sway;
use crate::plant::Planted;
use crate::shape::Numbers;
use crate::sighted::Sighted;
use crate::view::CannotSee;

/// Blocks in which the response is made most likely there, one after another, each time once noise is; again and again.
const FREE: [&str; 3] = ["sensor", "static_motion", "timing"];
/// How far a size of noise goes at once, and how closely it is found, in the noise block's standard deviations.
const FARTHEST: f64 = 3.0;
const NEAR_ENOUGH: f64 = 0.05;
/// At most so often.
const MOST_ROUNDS: usize = 8;
/// A round that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 1.0;
/// Noise is large at first: where it is too small, single sightings of hundreds of nats say which way to go, and no step is
/// small enough.
const START: [(Numbers, f64); 4] =
    [(Numbers::MotionNoise, 4.0), (Numbers::SizeNoise, 1.2), (Numbers::BearingNoise, 1.2), (Numbers::False, 3.0)];
/// Logarithm of the least standard deviation of a sensor, 1 mm and 1 mrad: readings that never change have none.
const LEAST_LN_SD: f64 = -6.9;
/// Shares of noise that may last, and frames in which it fades to 1/e.
const SHARES: [f64; 5] = [0.3, 0.6, 0.8, 0.9, 0.95];
const FRAMES: [f64; 6] = [2.0, 4.0, 8.0, 16.0, 32.0, 60.0];
/// Noise lasts only if that is so much more likely, in nats.
const LASTS_NATS: f64 = 10.0;
/// What is kept of it.
const NOISE: [Numbers; 5] =
    [Numbers::MotionNoise, Numbers::SizeNoise, Numbers::BearingNoise, Numbers::False, Numbers::Detection];

/// The noise made most likely, one size of it after another, as far as that goes: the likelihood is nowhere near quadratic
/// in it.
fn scattered(judge: &dyn Judge, mut numbers: Vec<f64>) -> Vec<f64> {
    for direction in judge.directions(&numbers, "noise") {
        let at =
            |by: f64| numbers.iter().zip(&direction).map(|(number, change)| number + by * change).collect::<Vec<_>>();
        let unlikely = |by: f64| -judge.terms(&at(by)).iter().fold(0.0, |sum, it| sum + it);
        let found = golden_section(unlikely, -FARTHEST, FARTHEST, NEAR_ENOUGH);
        if unlikely(found.x) < unlikely(0.0) {
            numbers = at(found.x);
        }
    }
    numbers
}

fn likely(judge: &dyn Judge, numbers: &[f64]) -> f64 {
    judge.terms(numbers).iter().fold(0.0, |sum, it| sum + it)
}

/// Has noise last as long as is most likely: that of sizes, then that of bearings.
fn last(judge: &mut Sighted<'_>, numbers: &[f64]) {
    let frames = judge.view.steps.windows(2).map(|pair| pair[1].t_s - pair[0].t_s).filter(|it| *it > 0.0);
    judge.memory.frame_s = median(&frames.collect::<Vec<f64>>()).unwrap_or(judge.memory.frame_s);
    for k in 0..2 {
        let mut best = (likely(judge, numbers), judge.memory);
        judge.memory.sways.iter_mut().for_each(|sways| sways[k] = Sway::default());
        let without = likely(judge, numbers);
        if without + LASTS_NATS > best.0 {
            best = (without + LASTS_NATS, judge.memory);
        }
        for (share, frames) in SHARES.into_iter().flat_map(|share| FRAMES.map(|frames| (share, frames))) {
            let sway = Sway { share, on: [exp(-1.0 / frames), 0.0], ..Sway::default() };
            judge.memory.sways.iter_mut().for_each(|sways| sways[k] = sway);
            let found = likely(judge, numbers);
            if found > best.0 {
                best = (found, judge.memory);
            }
        }
        judge.memory = best.1;
    }
}

impl Library {
    /// The same library with the noise of what is set aside of a log in the place of the nominal world's own. What is
    /// `planted` is known to be in the world; whatever else may be is left free. What was known of it `before` is gone on
    /// from.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn noisy_as(
        &self,
        log: &Log,
        aside: Aside,
        planted: &[Planted],
        before: Option<&Self>,
    ) -> Result<Self, CannotSee> {
        let mut judge = Sighted::scoring(log, self, |t_s| aside.holds(t_s))?;
        let mut numbers = self.numbers(planted);
        for of in NOISE.map(|group| self.base.shape.range(group)) {
            numbers[of.clone()].copy_from_slice(&before.unwrap_or(self).base.numbers[of]);
        }
        match before {
            Some(before) => judge.memory = before.base.memory,
            None => START.into_iter().for_each(|(group, more)| {
                self.base.shape.range(group).for_each(|i| numbers[i] += more);
            }),
        }
        let mut gone_before = f64::NEG_INFINITY;
        for _ in 0..MOST_ROUNDS {
            for block in FREE {
                numbers = likeliest(&[&judge as &dyn Judge], &self.floored(scattered(&judge, numbers)), block);
            }
            let after = likely(&judge, &numbers);
            if after - gone_before < GAINS_NOTHING_NATS {
                break;
            }
            gone_before = after;
            // Of several landmarks each has a noise of its own.
            if judge.view.landmarks.len() == 1 {
                last(&mut judge, &numbers);
            }
        }
        let mut noisy = Self { aside: Some(aside), ..self.clone() };
        noisy.base.memory = judge.memory;
        for of in NOISE.map(|group| self.base.shape.range(group)) {
            noisy.base.numbers[of.clone()].copy_from_slice(&numbers[of.clone()]);
            noisy.entries.iter_mut().filter(|entry| !entry.is_of_noise()).for_each(|entry| entry.leaves(of.clone()));
        }
        Ok(noisy)
    }

    /// With no sensor more exact than any is.
    fn floored(&self, mut numbers: Vec<f64>) -> Vec<f64> {
        for of in [Numbers::SizeNoise, Numbers::BearingNoise].map(|group| self.base.shape.range(group)) {
            numbers[of].iter_mut().for_each(|it| *it = it.max(LEAST_LN_SD));
        }
        numbers
    }
}
