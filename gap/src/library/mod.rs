//! The response library: how the nominal world answers commands and looks at landmarks, and how each
//! effect changes that, by its size.

mod base;
mod between;
mod entry;
mod gauge;
mod passing;
mod scaling;
mod swaying;

use asami_dataset::{Dataset, Log, Seed};
use asami_sim::effect::Block;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::drive::Drives;
use crate::judge::Judge;
use crate::nominal::{CannotPlay, Nominal};
use crate::plant::{Planted, Variant};
use crate::sighted::Sighted;
use crate::view::CannotSee;
pub use base::Base;
pub use entry::Entry;
use passing::Passing;

/// How much is played for a library.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Nominal runs.
    pub nominal_runs: u64,
    /// Runs with each kind of effect at each size.
    pub runs: u64,
    /// Sizes of each kind of effect, log-spaced from its least to its greatest; of delays twice as many, and half as many more of
    /// noise and shares. Where one is foretold badly by those next to it, there are more between them; where changes run on splines,
    /// the least is left out.
    pub sizes: usize,
    /// Length of a run in seconds.
    pub run_s: f64,
}

impl Default for Budget {
    /// What an engine with contacts can afford: 150 s of it cost seconds.
    fn default() -> Self {
        Self { nominal_runs: 16, runs: 4, sizes: 4, run_s: 150.0 }
    }
}

impl Budget {
    /// What suits a robot. The plain one costs next to nothing, so that its library's own error can be kept well below
    /// what a log of 150 s shows.
    #[must_use]
    pub fn of(robot: &str) -> Self {
        if robot == "car" {
            Self { nominal_runs: 48, runs: 4, sizes: 6, run_s: 40.0 }
        } else if robot == "plain" {
            Self { nominal_runs: 64, runs: 16, sizes: 6, ..Self::default() }
        } else if robot == "aibo" {
            // Rapier takes 2.7 s of a core for 150 s: with 37 kinds that one beacon shows, at three sizes and more, a quarter of an
            // hour of one. Of the nominal world, which is learned but once, there is more: what is wrong with it speaks for some cause
            // in every log.
            Self { nominal_runs: 64, runs: 2, ..Self::default() }
        } else if robot == "create" {
            // Rapier takes 0.35 s of a core for 150 s of two wheels.
            Self { nominal_runs: 32, runs: 8, sizes: 5, ..Self::default() }
        } else {
            Self::default()
        }
    }

    /// How many sizes of a kind of effect are played: what comes a step later does so at once, between sizes as well; and a
    /// share's log-odds bend.
    fn sizes_of(&self, variant: &Variant) -> usize {
        let sizes = self.sizes.max(3);
        match variant.block() {
            Block::Timing => 2 * sizes,
            Block::Noise => sizes + sizes / 2,
            _ => sizes,
        }
    }
}

/// Seeds of a library's runs begin here: no case is ever given one of them.
pub(crate) const FIRST_SEED: u64 = 7_000_000_000;

/// The nominal response, and what effects change of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Library {
    /// Nominally.
    pub base: Base,
    /// Kinds of effects.
    pub entries: Vec<Entry>,
    /// Spans of time, from and to, in which the robot of this log does not do what it is told; of nominal logs none.
    #[serde(skip)]
    pub astray: Vec<[f64; 2]>,
}

/// A library under whose responses logs can be held.
pub trait Responds: Sync {
    /// A log under its responses.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    fn judge<'a>(&'a self, log: &Log) -> Result<Box<dyn Judge + 'a>, CannotSee>;
}

/// The library of any robot's world.
#[derive(Debug)]
pub enum Responses {
    /// Of a robot among landmarks.
    Landmarks(Box<Library>),
    /// Of a car with a laser scanner.
    Drives(Box<Drives>),
    /// Of nothing: a real scanner is held against the table of its own lasers.
    Unplayed,
}

impl Responds for Library {
    fn judge<'a>(&'a self, log: &Log) -> Result<Box<dyn Judge + 'a>, CannotSee> {
        Ok(Box::new(Sighted::new(log, self)?))
    }
}

impl Responds for Responses {
    fn judge<'a>(&'a self, log: &Log) -> Result<Box<dyn Judge + 'a>, CannotSee> {
        match self {
            Self::Landmarks(library) => library.judge(log),
            Self::Drives(drives) => drives.judge(log),
            Self::Unplayed => Err(CannotSee::Unplayed),
        }
    }
}

/// Why there is no library.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CannotLearn {
    /// A world that cannot be played.
    #[error(transparent)]
    Play(#[from] CannotPlay),
    /// Nothing is ever seen in it.
    #[error("in the nominal world's own logs nothing is ever seen: nothing would show a gap")]
    Blind,
    /// Not even one of its own logs can be read.
    #[error(transparent)]
    Follow(#[from] crate::drive::motion::CannotFollow),
}

/// Logs of a nominal world with these effects in it.
///
/// # Errors
/// If the world cannot be played.
pub fn play(nominal: &dyn Nominal, planted: &[Planted], seed: Seed, until_s: f64) -> Result<Dataset, CannotPlay> {
    let mut effects = nominal.effects().clone();
    for Planted { variant, size } in planted {
        variant.plant(*size, &mut effects);
    }
    nominal.dataset(&effects, seed, until_s)
}

impl Library {
    /// Of a nominal response and kinds of effects.
    #[must_use]
    pub fn new(base: Base, entries: Vec<Entry>) -> Self {
        Self { base, entries, astray: Vec::new() }
    }

    /// Plays and learns all of it.
    ///
    /// # Errors
    /// If the world cannot be played, or nothing is seen in it.
    pub fn learn(nominal: &dyn Nominal, variants: &[Variant], budget: &Budget) -> Result<Self, CannotLearn> {
        let base = Base::learn(nominal, budget)?;
        let learn = |variant: &Variant| Entry::learn(nominal, &base, variant, budget);
        let entries: Result<Vec<Entry>, CannotPlay> = variants.par_iter().map(learn).collect();
        Ok(Self::new(base, entries?))
    }

    /// The entry of a kind of effect.
    #[must_use]
    pub fn entry(&self, variant: &Variant) -> Option<&Entry> {
        let name = variant.name();
        self.entries.iter().find(|entry| entry.kind == name)
    }

    /// Whether effects on motion pass through one another, or those on sightings do; what else is of several at once is added up.
    #[must_use]
    pub fn knows_together(&self, motion: bool) -> bool {
        let Base { shape, numbers, .. } = &self.base;
        if motion { Passing::new(&shape.columns, numbers).is_some() } else { shape.proportional().is_some() }
    }

    /// The response with these effects in it; one that the library does not know changes nothing.
    #[must_use]
    pub fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        let Base { shape, numbers: base, .. } = &self.base;
        let passing = if planted.len() > 1 { Passing::new(&shape.columns, base) } else { None };
        let less = |of: &[f64], than: &[f64]| of.iter().zip(than).map(|(a, b)| a - b).collect::<Vec<f64>>();
        let mut numbers = base.clone();
        for (k, Planted { variant, size }) in planted.iter().enumerate() {
            let Some(entry) = self.entry(variant) else { continue };
            let before = numbers.clone();
            entry.add(shape, *size, &mut numbers);
            if k == 0 {
                continue;
            }
            let (others, change) = (less(&before, base), less(&numbers, &before));
            if let Some(passing) = &passing {
                passing.add(&others, &change, &mut numbers);
            }
            scaling::add(shape, base, &others, &change, &mut numbers);
        }
        numbers
    }
}
