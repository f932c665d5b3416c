//! A log in folds, each held against a library whose noise is of the other folds.

use asami_dataset::Log;
use rayon::prelude::*;

use super::folds::Folds;
use super::noise::NOISE;
use crate::directions::Direction;
use crate::judge::{Channel, Judge, Moment, Reading, Regime};
use crate::library::Library;
use crate::plant::{Planted, Variant};
use crate::race::Pace;
use crate::sighted::Sighted;
use crate::view::CannotSee;

/// The log, by folds. Of responses the numbers of noise are those of the first fold; each other fold's own lie where its library
/// has them, and change as these do.
pub struct Crossed<'a> {
    parts: Vec<Part<'a>>,
    /// The steps of all parts, in order of time.
    moments: Vec<Moment>,
}

/// A fold.
struct Part<'a> {
    judge: Sighted<'a>,
    /// Its library's noise less the first one's, by number.
    noisier: Vec<f64>,
    /// Where each of its steps is among those of all.
    at: Vec<usize>,
}

impl Part<'_> {
    fn numbers(&self, numbers: &[f64]) -> Vec<f64> {
        numbers.iter().zip(&self.noisier).map(|(number, more)| number + more).collect()
    }
}

impl<'a> Crossed<'a> {
    /// Looks at a log, of which each fold is held against the library of its number, and whose robot starts where it is likeliest to
    /// with these effects in the world.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn new(log: &Log, libraries: &'a [Library], folds: Folds, with: &[Planted]) -> Result<Self, CannotSee> {
        let fold =
            |(k, library): (usize, &'a Library)| Sighted::scoring(log, library, with, move |t_s| folds.of(t_s) == k);
        let judges: Vec<Sighted<'a>> = libraries.iter().enumerate().map(fold).collect::<Result<_, _>>()?;
        let mut steps: Vec<(Moment, usize)> = Vec::new();
        for (k, judge) in judges.iter().enumerate() {
            steps.extend(judge.steps().iter().map(|step| (*step, k)));
        }
        steps.sort_by(|a, b| a.0.t_s.total_cmp(&b.0.t_s));
        let part = |(k, judge): (usize, Sighted<'a>)| {
            let own = steps.iter().enumerate().filter(|(_, (_, of))| *of == k);
            Part { at: own.map(|(at, _)| at).collect(), noisier: noisier(judge.library, &libraries[0]), judge }
        };
        let parts = judges.into_iter().enumerate().map(part).collect();
        Ok(Self { parts, moments: steps.into_iter().map(|(step, _)| step).collect() })
    }

    /// What every part makes of a response, one after another.
    fn each<T: Send>(&self, numbers: &[f64], made: impl Fn(&Part<'_>, &[f64]) -> T + Sync) -> Vec<T> {
        self.parts.par_iter().map(|part| made(part, &part.numbers(numbers))).collect()
    }

    /// What parts have by step, in the order of all steps.
    fn in_order<T: Clone>(&self, by_part: &[Vec<T>], nothing: T) -> Vec<T> {
        let mut all = vec![nothing; self.moments.len()];
        for (part, of) in self.parts.iter().zip(by_part) {
            part.at.iter().zip(of).for_each(|(at, it)| all[*at] = it.clone());
        }
        all
    }

    fn first(&self) -> &Sighted<'a> {
        &self.parts[0].judge
    }
}

/// By how much the noise of a library is more than another's, by number of a response.
fn noisier(library: &Library, than: &Library) -> Vec<f64> {
    let mut more = vec![0.0; library.base.numbers.len()];
    for i in NOISE.into_iter().flat_map(|group| library.base.shape.range(group)) {
        more[i] = library.base.numbers[i] - than.base.numbers[i];
    }
    more
}

impl Judge for Crossed<'_> {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        self.first().numbers(planted)
    }

    fn knows_together(&self, motion: bool) -> bool {
        self.first().knows_together(motion)
    }

    fn knows(&self, variant: &Variant) -> bool {
        self.first().knows(variant)
    }

    fn read(&self, numbers: &[f64]) -> Reading {
        let mut readings = self.each(numbers, |part, numbers| part.judge.read(numbers));
        let mut by_step = |of: fn(&mut Reading) -> &mut Vec<f64>| {
            let terms: Vec<Vec<f64>> = readings.iter_mut().map(|it| std::mem::take(of(it))).collect();
            self.in_order(&terms, 0.0)
        };
        let log_likelihoods = by_step(|it| &mut it.log_likelihoods);
        let expected = by_step(|it| &mut it.expected);
        let mut all = Reading { log_likelihoods, expected, ..Reading::default() };
        for reading in readings {
            all.innovations.extend(reading.innovations);
            all.shares.extend(reading.shares);
            all.observations += reading.observations;
        }
        all
    }

    fn terms(&self, numbers: &[f64]) -> Vec<f64> {
        self.in_order(&self.each(numbers, |part, numbers| part.judge.terms(numbers)), 0.0)
    }

    fn beside(&self, numbers: &[f64], pace: &Pace) -> f64 {
        self.each(numbers, |part, numbers| part.judge.beside(numbers, &pace.of_part(&part.at))).into_iter().sum()
    }

    fn steps(&self) -> &[Moment] {
        &self.moments
    }

    fn length_s(&self) -> f64 {
        self.first().length_s()
    }

    fn measured(&self) -> Vec<&'static str> {
        self.first().measured()
    }

    fn directions(&self, numbers: &[f64], block: &str) -> Vec<Direction> {
        self.first().directions(numbers, block)
    }

    fn channels(&self) -> Vec<Channel> {
        self.first().channels()
    }

    fn regimes(&self) -> Vec<Regime> {
        let by_part: Vec<Vec<Regime>> = self.parts.iter().map(|part| part.judge.regimes()).collect();
        let names = by_part.first().into_iter().flatten().map(|(name, _)| *name).enumerate();
        let regime = |(r, name): (usize, &'static str)| {
            let of: Vec<Vec<bool>> = by_part.iter().map(|regimes| regimes[r].1.clone()).collect();
            (name, self.in_order(&of, false))
        };
        names.map(regime).collect()
    }
}
