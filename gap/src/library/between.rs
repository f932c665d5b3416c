//! How an effect's changes run between the sizes that were played: what one of these would be by the others tells.

use asami_dataset::Dataset;

use super::entry::Run;
use super::gauge::voiced;
use super::{Base, Entry, Library};
use crate::judge::Judge;
use crate::sighted::Sighted;

impl Entry {
    /// The same where changes run on parabolas through the nearest sizes, if the logs of sizes between others, `runs` in the
    /// order of sizes, are likelier by that than by one polynomial for all, each with its own size left out.
    #[must_use]
    pub fn settled(self, base: &Base, runs: &[&[Dataset]]) -> Self {
        let library = Library::new(base.clone(), Vec::new());
        let between = 1..self.sizes.len().saturating_sub(1);
        let gains = between.map(|i| {
            let [one, nearest] = [Run::Polynomial, Run::Parabolas].map(|run| self.without(i, run));
            let logs = runs[i].iter().filter_map(|run| Sighted::new(&run.log, &library).ok());
            logs.fold(0.0, |sum, log| {
                let [one, nearest] = [&one, &nearest].map(|entry| entry.log_likelihood(base, self.sizes[i], &log));
                sum + voiced(nearest - one)
            })
        });
        if gains.sum::<f64>() > 0.0 { Self { run: Run::Parabolas, ..self } } else { self }
    }

    /// What it would be had one of its sizes not been played, and did changes run like this.
    fn without(&self, i: usize, run: Run) -> Self {
        let mut left = Self { run, appears: Vec::new(), ..self.clone() };
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
