//! Where there are too few sizes played of an effect: what one of them would be by the others tells.

use asami_dataset::Dataset;

use super::{Base, Entry, Library};
use crate::judge::Judge;
use crate::sighted::Sighted;

/// Logs of a size that is left out lose so many nats each: sizes next to it must be played as well.
const FORETOLD_BADLY_NATS: f64 = 30.0;

impl Entry {
    /// Half-way, by ratio, to both sides of sizes that those next to them foretell badly; `runs` are those of its sizes.
    pub(super) fn sizes_between(&self, base: &Base, runs: &[(f64, Vec<Dataset>)]) -> Vec<f64> {
        let library = Library::new(base.clone(), Vec::new());
        let inner = 1..self.sizes.len().saturating_sub(1);
        let badly: Vec<usize> =
            inner.filter(|i| self.shortfall(&library, *i, &runs[*i].1) > FORETOLD_BADLY_NATS).collect();
        let gaps = 1..self.sizes.len();
        let wanting = gaps.filter(|above| badly.contains(above) || badly.contains(&(above - 1)));
        wanting.map(|above| (self.sizes[above - 1] * self.sizes[above]).sqrt()).collect()
    }

    /// By how much logs of one of its sizes would be less likely had that not been played, in nats each.
    fn shortfall(&self, library: &Library, i: usize, runs: &[Dataset]) -> f64 {
        let (base, size) = (&library.base, self.sizes[i]);
        let (with, without) = (Self { appears: Vec::new(), ..self.clone() }, self.without(i));
        let logs: Vec<Sighted<'_>> = runs.iter().filter_map(|run| Sighted::new(&run.log, library).ok()).collect();
        let lost = |log: &Sighted<'_>| with.log_likelihood(base, size, log) - without.log_likelihood(base, size, log);
        logs.iter().map(lost).fold(0.0, |sum, it| sum + it) / logs.len().max(1) as f64
    }

    /// What it would be had one of its sizes not been played.
    fn without(&self, i: usize) -> Self {
        let mut left = Self { appears: Vec::new(), ..self.clone() };
        left.sizes.remove(i);
        left.changes.remove(i);
        left
    }

    /// Of a log, if it has the effect at this size.
    pub(super) fn log_likelihood(&self, base: &Base, size: f64, log: &Sighted<'_>) -> f64 {
        let mut numbers = base.numbers.clone();
        self.add(&base.shape, size, &mut numbers);
        log.terms(&numbers).into_iter().fold(0.0, |sum, it| sum + it)
    }
}
