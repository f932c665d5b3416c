//! What one kind of effect changes of the nominal response, by its size.

use asami_dataset::{Dataset, Seed};
use asami_math::elementary::{exp, ln};
use asami_sim::effect::{Block, Place};
use asami_sim::effects::catalogue;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::between::bends;
use super::gauge::gauge;
use super::{Base, Budget, FIRST_SEED, play};
use crate::fit::{Free, changed};
use crate::nominal::{CannotPlay, Nominal};
use crate::plant::{Planted, Variant};
use crate::shape::{Numbers, ORDER, Shape};
use crate::sizes::{curved, smoothed, spaced, straight, through};
use crate::touch::Touch;

/// In so many seconds of a log effects on sensing show at their greatest sizes, if they do at all.
const SHOWS_S: f64 = 60.0;

/// What one kind of effect changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// [`Variant::name`].
    pub kind: String,
    /// Sizes played, increasing.
    pub sizes: Vec<f64>,
    /// Changes of the nominal numbers at these sizes; none of an effect that no log shows.
    pub(super) changes: Vec<Vec<f64>>,
    /// How changes run from size to size.
    pub(super) run: Run,
    /// How much splines bend over them ([`smoothed`]); 0 where there are none.
    pub(super) bends: f64,
    /// Logarithm of the size that logs are likeliest at over the one that was played, for each of the sizes.
    pub(super) appears: Vec<f64>,
}

/// How changes of means run over sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Run {
    /// All on one polynomial of third degree through 0.
    Polynomial,
    /// On parabolas through the nearest sizes.
    Parabolas,
    /// In straight lines.
    Straight,
    /// As noise and shares do, on curves in the size's logarithm.
    Logarithms,
    /// On splines that bend the more the larger the size, and lie near to what was found.
    Smooth,
}

impl Entry {
    /// Plays one kind of effect at its sizes, with the seeds of the first nominal runs, and learns what it changes.
    ///
    /// # Errors
    /// If the world cannot be played.
    pub fn learn(nominal: &dyn Nominal, base: &Base, variant: &Variant, budget: &Budget) -> Result<Self, CannotPlay> {
        let mut sizes = spaced(variant, budget.sizes_of(variant));
        if base.memory.sways() && run(variant) != Run::Logarithms {
            // Below the next, splines are near to a line from nothing, of which the least size tells least.
            sizes.remove(0);
        }
        if !shows(nominal, &base.shape, variant, budget.run_s.min(SHOWS_S))? {
            return Ok(Self {
                kind: variant.name(),
                sizes,
                changes: Vec::new(),
                run: run(variant),
                bends: 0.0,
                appears: Vec::new(),
            });
        }
        let played = |size: f64| -> Result<(f64, Vec<Dataset>), CannotPlay> {
            let planted = [Planted { variant: variant.clone(), size }];
            let seeds = (0..budget.runs).into_par_iter().map(|i| Seed(FIRST_SEED + i));
            let runs = seeds.map(|seed| play(nominal, &planted, seed, budget.run_s));
            Ok((size, runs.collect::<Result<_, _>>()?))
        };
        let all = |sizes: Vec<f64>| sizes.into_par_iter().map(played).collect::<Result<Vec<_>, _>>();
        let mut runs: Vec<(f64, Vec<Dataset>)> = all(sizes)?;
        let entry = Self::of(base, variant, &runs);
        let between = entry.sizes_between(base, &runs);
        if between.is_empty() {
            return Ok(entry);
        }
        runs.extend(all(between)?);
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Self::of(base, variant, &runs))
    }

    /// What one kind of effect changes, as runs at several sizes, increasing, show it.
    #[must_use]
    pub fn of(base: &Base, variant: &Variant, runs: &[(f64, Vec<Dataset>)]) -> Self {
        let sizes: Vec<f64> = runs.iter().map(|(size, _)| *size).collect();
        let greatest = sizes.last().copied().unwrap_or(1.0);
        let runs: Vec<(f64, &[Dataset])> = runs.iter().map(|(size, runs)| (size / greatest, runs.as_slice())).collect();
        let free = Free { wear: variant.block() == Block::Drift };
        let nominal = (&base.rhythm, base.alike.as_slice());
        let smooth = run(variant) == Run::Polynomial;
        let responses = changed(&base.shape, nominal, &runs, free, Touch::of(variant), smooth);
        let change = |(with, runs): (Vec<f64>, &[Dataset])| {
            let change = with.iter().zip(&base.alike).map(|(with, without)| with - without).collect();
            base.played(change, runs, Touch::of(variant))
        };
        let runs: Vec<&[Dataset]> = runs.into_iter().map(|(_, runs)| runs).collect();
        let changes: Vec<Vec<f64>> = responses.into_iter().zip(runs.iter().copied()).map(change).collect();
        let run = match run(variant) {
            Run::Logarithms => Run::Logarithms,
            // Where sizes are polished one by one, each has errors of its own, and none lies on one polynomial with the others.
            _ if base.memory.sways() => Run::Smooth,
            run => run,
        };
        let bends = if run == Run::Smooth { bends(base, &changes, &runs) } else { 0.0 };
        let entry = Self { kind: variant.name(), sizes, changes, run, bends, appears: Vec::new() };
        Self { appears: gauge(base, &entry, &runs), ..entry }
    }

    /// Whether the effect is one of noise.
    pub(crate) fn is_of_noise(&self) -> bool {
        let name = self.kind.split(['+', '-']).next().unwrap_or_default();
        catalogue().iter().any(|about| about.name == name && about.block == Block::Noise)
    }

    /// Takes out what it changes of some numbers.
    pub(crate) fn leaves(&mut self, numbers: std::ops::Range<usize>) {
        self.changes.iter_mut().for_each(|change| change[numbers.clone()].fill(0.0));
    }

    /// The size as which one appears, between those that were played and as the nearest of them beyond.
    fn appearing(&self, size: f64) -> f64 {
        let (Some(least), Some(greatest)) = (self.sizes.first(), self.sizes.last()) else { return size };
        let weights = straight(&self.sizes, size.clamp(*least, *greatest), ln);
        size * exp(weights.iter().zip(&self.appears).fold(0.0, |sum, (weight, ln_ratio)| sum + weight * ln_ratio))
    }

    /// Adds the change at a size to `numbers`.
    pub fn add(&self, shape: &Shape, size: f64, numbers: &mut [f64]) {
        let size = self.appearing(size);
        let n = self.sizes.len();
        let even = || straight(&self.sizes, size, |size| size);
        // Log-odds of shares and logarithms of noise go rather with the size's own logarithm.
        let rest = match self.run {
            Run::Logarithms => curved(&self.sizes, size, ln),
            Run::Smooth => smoothed(&self.sizes, size, self.bends),
            _ => straight(&self.sizes, size, ln),
        };
        // Curves of sensing are learned size by size: between sizes they are what they are there.
        let (motion, sensing) = match self.run {
            Run::Polynomial => (through(&self.sizes, n.saturating_sub(3)..n, size), even()),
            Run::Parabolas => {
                let above = self.sizes.partition_point(|it| *it < size).clamp(1, n - 1);
                let parabola = through(&self.sizes, above - 1..above + 1, size);
                (parabola.clone(), parabola)
            }
            Run::Straight => (even(), even()),
            Run::Logarithms | Run::Smooth => (rest.clone(), rest.clone()),
        };
        for group in ORDER {
            let weights = match group {
                Numbers::Motion => &motion,
                Numbers::Size | Numbers::Bearing | Numbers::Moved => &sensing,
                _ => &rest,
            };
            for (weight, change) in weights.iter().zip(&self.changes).filter(|(weight, _)| **weight != 0.0) {
                let of = shape.range(group);
                for (number, change) in numbers[of.clone()].iter_mut().zip(&change[of]) {
                    *number += weight * change;
                }
            }
        }
    }
}

/// Whether logs show such an effect at all. A robot that knows where it is by a single landmark cannot tell that the landmark stands
/// elsewhere; and not every sensor has what an effect is of.
fn shows(nominal: &dyn Nominal, shape: &Shape, variant: &Variant, until_s: f64) -> Result<bool, CannotPlay> {
    if variant.place() != Place::Sensing {
        return Ok(shape.landmarks > 1 || variant.place() != Place::Scene);
    }
    let seen = |planted: &[Planted]| Ok(play(nominal, planted, Seed(FIRST_SEED), until_s)?.log.sightings);
    Ok(seen(&[Planted { variant: variant.clone(), size: variant.sizes().1 }])? != seen(&[])?)
}

/// How an effect's changes run over its sizes: delays cross from one age to the next, and what sensing does is seen so
/// clearly that one polynomial for all sizes would smooth away more than it steadies.
fn run(variant: &Variant) -> Run {
    match variant.place() {
        _ if variant.block() == Block::Timing => Run::Straight,
        _ if variant.block() == Block::Noise => Run::Logarithms,
        Place::Sensing | Place::Scene => Run::Parabolas,
        Place::Actuation | Place::Dynamics => Run::Polynomial,
    }
}
