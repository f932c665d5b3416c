//! How noisy a real robot and its sensor are, out of stretches of the log that are set aside for it.
//!
//! A nominal world's noise is of its simulator. Held against a real log, whose noise is another, every cause that scatters
//! would be evident, and none that moves something would be weighed as it should. Stretches that are not diagnosed say how
//! large the noise is: everything else is left free there, so that no gap is taken for noise.

use asami_dataset::Log;
use asami_math::optimise::golden_section;

use crate::blocks::likeliest;
use crate::judge::Judge;
use crate::library::Library;
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
/// What is kept of it.
const NOISE: [Numbers; 5] =
    [Numbers::MotionNoise, Numbers::SizeNoise, Numbers::BearingNoise, Numbers::False, Numbers::Detection];

/// Which times of a log are set aside: of blocks one after another the first of every so many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aside {
    /// The length of a block.
    pub block_s: f64,
    /// The first of so many is set aside.
    pub every: f64,
}

impl Default for Aside {
    /// A quarter of the log.
    fn default() -> Self {
        Self { block_s: 20.0, every: 4.0 }
    }
}

impl Aside {
    /// Whether a time is set aside.
    #[must_use]
    pub fn holds(&self, t_s: f64) -> bool {
        (t_s / self.block_s).floor().rem_euclid(self.every) < 1.0
    }
}

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

impl Library {
    /// The same library with the noise of what is set aside of a log in the place of the nominal world's own. What is
    /// `planted` is known to be in the world; whatever else may be is left free.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn noisy_as(&self, log: &Log, aside: Aside, planted: &[Planted]) -> Result<Self, CannotSee> {
        let judge = Sighted::scoring(log, self, |t_s| aside.holds(t_s))?;
        let judges: [&dyn Judge; 1] = [&judge];
        let likely = |numbers: &[f64]| judge.terms(numbers).iter().fold(0.0, |sum, it| sum + it);
        let mut numbers = self.numbers(planted);
        for of in NOISE.map(|group| self.base.shape.range(group)) {
            numbers[of.clone()].copy_from_slice(&self.base.numbers[of]);
        }
        for (group, more) in START {
            self.base.shape.range(group).for_each(|i| numbers[i] += more);
        }
        let mut before = likely(&numbers);
        for _ in 0..MOST_ROUNDS {
            for block in FREE {
                numbers = likeliest(&judges, &self.floored(scattered(&judge, numbers)), block);
            }
            let after = likely(&numbers);
            if after - before < GAINS_NOTHING_NATS {
                break;
            }
            before = after;
        }
        let mut noisy = Self { aside: Some(aside), ..self.clone() };
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
