//! As how large an effect appears to a filter, which does not know the truth that its entry was learned from: of where in the
//! image a landmark is, a robot's belief says less than the truth, so that of what a lens does less is seen than it does.

use asami_dataset::Dataset;
use asami_math::elementary::exp;
use asami_math::optimise::golden_section;

use super::{Base, Entry, Library};
use crate::sighted::Sighted;

/// Nats by which one log can speak for a size, so that a robot that a filter lost does not decide.
const VOICE: f64 = 20.0;
/// Standard deviation of the logarithm of the size that appears over the one that was played, of all sizes in common.
const COMMON_SD: f64 = 0.3;
/// And that of each size beside it.
const OWN_SD: f64 = 0.1;
/// Logarithms are sought so far to both sides of what is known, in standard deviations, and as exactly.
const WITHIN: f64 = 1.5;
const NEAR_ENOUGH: f64 = 0.01;

/// The logarithm of the size that logs are likeliest at over the one that was played, for each of an entry's sizes.
pub fn gauge(base: &Base, entry: &Entry, runs: &[&[Dataset]]) -> Vec<f64> {
    let library = Library::new(base.clone(), Vec::new());
    let played = |(size, runs): (&f64, &&[Dataset])| -> Vec<Played<'_>> {
        let logs = runs.iter().filter_map(|run| Sighted::new(&run.log, &library).ok());
        logs.map(|log| Played::new(base, entry, *size, log)).collect()
    };
    let logs: Vec<Vec<Played<'_>>> = entry.sizes.iter().zip(runs).map(played).collect();
    let all: Vec<&Played<'_>> = logs.iter().flatten().collect();
    let common = likeliest(&all, 0.0, COMMON_SD);
    logs.iter().map(|logs| likeliest(&logs.iter().collect::<Vec<_>>(), common, OWN_SD)).collect()
}

/// The logarithm at which logs are likeliest, of which so much is known beforehand.
fn likeliest(logs: &[&Played<'_>], mean: f64, sd: f64) -> f64 {
    let unlikely = |at: f64| {
        let away = (at - mean) / sd;
        logs.iter().fold(0.5 * away * away, |sum, log| sum - log.gain(at))
    };
    golden_section(unlikely, mean - WITHIN * sd, mean + WITHIN * sd, NEAR_ENOUGH).x
}

/// A log of an effect of a size.
struct Played<'a> {
    base: &'a Base,
    entry: &'a Entry,
    size: f64,
    log: Sighted<'a>,
    /// Its log-likelihood under that size.
    known: f64,
}

impl<'a> Played<'a> {
    fn new(base: &'a Base, entry: &'a Entry, size: f64, log: Sighted<'a>) -> Self {
        let log = Self { base, entry, size, log, known: 0.0 };
        Self { known: log.log_likelihood(0.0), ..log }
    }

    fn log_likelihood(&self, ln_ratio: f64) -> f64 {
        self.entry.log_likelihood(self.base, self.size * exp(ln_ratio), &self.log)
    }

    /// What it gains if it appears as another size; never more than its voice.
    fn gain(&self, ln_ratio: f64) -> f64 {
        voiced(self.log_likelihood(ln_ratio) - self.known)
    }
}

/// What one log says, never more than its voice.
fn voiced(nats: f64) -> f64 {
    nats / (1.0 + nats.abs() / VOICE)
}
