//! The response library: how the nominal world answers commands and looks at landmarks, and how each
//! effect changes that, by its size.

use asami_dataset::{Dataset, Log, Seed};
use asami_math::elementary::ln;
use asami_sim::effect::{Block, Place};
use asami_sim::effects::catalogue;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::aside::Aside;
use crate::blocks::polished;
use crate::columns::Group;
use crate::drive::Drives;
use crate::fit::{self, Free, changed, remembered};
use crate::judge::Judge;
use crate::memory::Memory;
use crate::nominal::{CannotPlay, Nominal};
use crate::plant::{Planted, Variant};
use crate::rhythm::Rhythm;
use crate::shape::{Numbers, ORDER, Shape};
use crate::sighted::Sighted;
use crate::sizes::{curved, spaced, straight, through};
use crate::touch::Touch;
use crate::view::CannotSee;

/// How much is played for a library.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Nominal runs.
    pub nominal_runs: u64,
    /// Runs with each kind of effect at each size.
    pub runs: u64,
    /// Sizes of each kind of effect, log-spaced from its least to its greatest; of delays twice as many.
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
            // Rapier takes 3.3 s of a core for 150 s: with 41 kinds, 18 minutes of one.
            Self { runs: 2, ..Self::default() }
        } else if robot == "create" {
            // Rapier takes 0.35 s of a core for 150 s of two wheels.
            Self { nominal_runs: 32, runs: 8, sizes: 5, ..Self::default() }
        } else {
            Self::default()
        }
    }

    /// How many sizes of a kind of effect are played: what comes a step later does so at once, between sizes as well.
    fn sizes_of(&self, variant: &Variant) -> usize {
        let by = if variant.block() == Block::Timing { 2 } else { 1 };
        by * self.sizes.max(3)
    }
}

/// Seeds of a library's runs begin here: no case is ever given one of them.
pub(crate) const FIRST_SEED: u64 = 7_000_000_000;

/// In these blocks, one after another.
const POLISHED_BLOCKS: [&str; 6] = ["noise", "sensor", "timing", "noise", "sensor", "timing"];
/// What an effect changes, in these.
const PLAYED_BLOCKS: [&str; 5] = ["noise", "sensor", "static_motion", "timing", "noise"];
/// Of so many nominal logs the likelihood is made greatest.
const POLISHED: usize = 16;

/// The nominal response, and what effects change of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Library {
    /// Nominally.
    pub base: Base,
    /// Kinds of effects.
    pub entries: Vec<Entry>,
    /// Where the log at hand said how noisy it is: what was learned from is not scored.
    #[serde(skip)]
    pub aside: Option<Aside>,
    /// Spans of time, from and to, in which the robot of this log does not do what it is told; of nominal logs none.
    #[serde(skip)]
    pub astray: Vec<[f64; 2]>,
}

/// The nominal response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// What the numbers mean.
    pub shape: Shape,
    /// The numbers.
    pub numbers: Vec<f64>,
    /// What the runs with their truth show of them, from which effects' changes are counted.
    fitted: Vec<f64>,
    /// What of every log is taken away first.
    pub rhythm: Rhythm,
    /// How innovations hang on those before them.
    pub memory: Memory,
}

/// What one kind of effect changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// [`Variant::name`].
    pub kind: String,
    /// Sizes played, increasing.
    pub sizes: Vec<f64>,
    /// Changes of the nominal numbers at these sizes.
    changes: Vec<Vec<f64>>,
    /// How changes run from size to size.
    run: Run,
}

/// How changes of means run over sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Run {
    /// All on one polynomial of third degree through 0.
    Polynomial,
    /// On parabolas through the nearest sizes.
    Parabolas,
    /// In straight lines.
    Straight,
    /// Not at all: what scatters more lies where it lay. Noise and shares run on curves in the size's logarithm.
    Logarithms,
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

impl Base {
    /// Plays and learns the nominal response.
    ///
    /// # Errors
    /// If the world cannot be played, or nothing is seen in it.
    pub fn learn(nominal: &dyn Nominal, budget: &Budget) -> Result<Self, CannotLearn> {
        let seeds: Vec<u64> = (0..budget.nominal_runs).collect();
        let runs: Result<Vec<Dataset>, CannotPlay> =
            seeds.into_par_iter().map(|i| play(nominal, &[], Seed(FIRST_SEED + i), budget.run_s)).collect();
        Self::of(&runs?).ok_or(CannotLearn::Blind)
    }

    /// The response that runs of the nominal world show; `None` where no landmark is seen in them.
    #[must_use]
    pub fn of(runs: &[Dataset]) -> Option<Self> {
        let shape = fit::shape(runs)?;
        let shape = Shape { columns: shape.columns.knowing(&fit::motion_alone(&shape, runs)), ..shape };
        let rhythm = fit::rhythm(&shape, runs);
        let numbers = fit::nominal(&shape, &rhythm, runs);
        let memory = remembered(&shape, &rhythm, &numbers, runs);
        let mut base = Self { shape, fitted: numbers.clone(), numbers, rhythm, memory };
        base.memory.spread = base.spread(runs);
        base.numbers = base.polished(&base.numbers, runs, &POLISHED_BLOCKS);
        // None seen in nominal runs is no proof that there are none: the least share that was counted stays.
        let of_false = base.shape.range(Numbers::False);
        base.numbers[of_false.clone()].copy_from_slice(&base.fitted[of_false]);
        base.memory.spread = [1.0; 2];
        base.memory.spread = base.spread(runs);
        Some(base)
    }

    /// The numbers near these that make logs most likely, block by block: how a head that follows a landmark answers to a
    /// sway, and what is left of a rhythm, shows in what a filter expects, and not in runs with their truth.
    fn polished(&self, numbers: &[f64], runs: &[Dataset], of: &[&'static str]) -> Vec<f64> {
        let alone = Library { base: self.clone(), entries: Vec::new(), aside: None, astray: Vec::new() };
        let judges: Vec<Sighted<'_>> =
            runs.iter().take(POLISHED).filter_map(|run| Sighted::new(&run.log, &alone).ok()).collect();
        let judges: Vec<&dyn Judge> = judges.iter().map(|judge| judge as &dyn Judge).collect();
        of.iter().fold(numbers.to_vec(), |numbers, block| polished(&judges, &numbers, block))
    }

    /// What an effect changes, of which runs with their truth gave `change`: made most likely on the same logs where sightings
    /// sway. A fit to the truth then takes for the effect's what the filter, which must tell a sway from a turn and from noise,
    /// does not make of it, and costs true causes tens of nats: it is only trusted with curves, wear and shares.
    fn played(&self, change: Vec<f64>, runs: &[Dataset]) -> Vec<f64> {
        if !self.memory.sways() {
            return change;
        }
        let columns = &self.shape.columns;
        let of_sway = [Group::Lingering, Group::Held].map(|group| columns.range(group));
        let moved = (0..3)
            .flat_map(|axis| of_sway.clone().map(|of| axis * columns.len() + of.start..axis * columns.len() + of.end));
        let sensed = [Numbers::MotionNoise, Numbers::Size, Numbers::Bearing, Numbers::SizeNoise, Numbers::BearingNoise];
        let mut plus: Vec<f64> = self.numbers.iter().zip(&change).map(|(number, change)| number + change).collect();
        for of in moved.chain(sensed.map(|group| self.shape.range(group))) {
            plus[of.clone()].copy_from_slice(&self.numbers[of]);
        }
        let polished = self.polished(&plus, runs, &PLAYED_BLOCKS);
        polished.iter().zip(&self.numbers).map(|(with, without)| with - without).collect()
    }

    /// How far the nominal logs' innovations scatter, once sways are taken into account.
    fn spread(&self, runs: &[Dataset]) -> [f64; 2] {
        let alone = Library { base: self.clone(), entries: Vec::new(), aside: None, astray: Vec::new() };
        let (mut squares, mut n) = ([0.0; 2], 0.0);
        for judge in runs.iter().filter_map(|run| Sighted::new(&run.log, &alone).ok()) {
            for it in judge.filtered(&self.numbers).innovations.iter().filter(|it| it.genuine > 0.5) {
                (0..2).for_each(|k| squares[k] += it.white[k] * it.white[k]);
                n += 1.0;
            }
        }
        squares.map(|sum| if n > 0.0 { (sum / n).sqrt().max(0.1) } else { 1.0 })
    }
}

impl Entry {
    /// Plays one kind of effect at its sizes, with the seeds of the first nominal runs, and learns what it changes.
    ///
    /// # Errors
    /// If the world cannot be played.
    pub fn learn(nominal: &dyn Nominal, base: &Base, variant: &Variant, budget: &Budget) -> Result<Self, CannotPlay> {
        let sizes = spaced(variant, budget.sizes_of(variant));
        let mut runs: Vec<(f64, Vec<Dataset>)> = Vec::with_capacity(sizes.len());
        for size in sizes {
            let planted = [Planted { variant: variant.clone(), size }];
            let of_size: Result<Vec<Dataset>, CannotPlay> =
                (0..budget.runs).map(|i| play(nominal, &planted, Seed(FIRST_SEED + i), budget.run_s)).collect();
            runs.push((size, of_size?));
        }
        Ok(Self::of(base, variant, runs))
    }

    /// What one kind of effect changes, as runs at several sizes, increasing, show it.
    #[must_use]
    pub fn of(base: &Base, variant: &Variant, mut runs: Vec<(f64, Vec<Dataset>)>) -> Self {
        let sizes: Vec<f64> = runs.iter().map(|(size, _)| *size).collect();
        let greatest = sizes.last().copied().unwrap_or(1.0);
        runs.iter_mut().for_each(|(size, _)| *size /= greatest);
        let free = Free { wear: variant.block() == Block::Drift };
        let nominal = (&base.rhythm, base.fitted.as_slice());
        let smooth = run(variant) == Run::Polynomial;
        let responses = changed(&base.shape, nominal, &runs, free, Touch::of(variant), smooth);
        let change = |(with, runs): (Vec<f64>, &[Dataset])| {
            let change = with.iter().zip(&base.fitted).map(|(with, without)| with - without).collect();
            base.played(change, runs)
        };
        let runs = runs.iter().map(|(_, runs)| runs.as_slice());
        let changes = responses.into_iter().zip(runs).map(change).collect();
        Self { kind: variant.name(), sizes, changes, run: run(variant) }
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

    /// Adds the change at a size to `numbers`.
    pub fn add(&self, shape: &Shape, size: f64, numbers: &mut [f64]) {
        let n = self.sizes.len();
        let even = || straight(&self.sizes, size, |size| size);
        // Curves of sensing are learned size by size: between sizes they are what they are there.
        let (motion, sensing) = match self.run {
            Run::Polynomial => (through(&self.sizes, n.saturating_sub(3)..n, size), even()),
            Run::Parabolas => {
                let above = self.sizes.partition_point(|it| *it < size).clamp(1, n - 1);
                let parabola = through(&self.sizes, above - 1..above + 1, size);
                (parabola.clone(), parabola)
            }
            Run::Straight => (even(), even()),
            Run::Logarithms => (Vec::new(), Vec::new()),
        };
        // Log-odds of shares and logarithms of noise go rather with the size's own logarithm.
        let rest = if self.run == Run::Logarithms { curved } else { straight }(&self.sizes, size, ln);
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

impl Library {
    /// Plays and learns all of it.
    ///
    /// # Errors
    /// If the world cannot be played, or nothing is seen in it.
    pub fn learn(nominal: &dyn Nominal, variants: &[Variant], budget: &Budget) -> Result<Self, CannotLearn> {
        let base = Base::learn(nominal, budget)?;
        let learn = |variant: &Variant| Entry::learn(nominal, &base, variant, budget);
        let entries: Result<Vec<Entry>, CannotPlay> = variants.par_iter().map(learn).collect();
        Ok(Self { entries: entries?, base, aside: None, astray: Vec::new() })
    }

    /// The entry of a kind of effect.
    #[must_use]
    pub fn entry(&self, variant: &Variant) -> Option<&Entry> {
        let name = variant.name();
        self.entries.iter().find(|entry| entry.kind == name)
    }

    /// The response with these effects in it; one that the library does not know changes nothing.
    #[must_use]
    pub fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        let mut numbers = self.base.numbers.clone();
        for Planted { variant, size } in planted {
            if let Some(entry) = self.entry(variant) {
                entry.add(&self.base.shape, *size, &mut numbers);
            }
        }
        numbers
    }
}
