//! What drives in the nominal world's towns say, and what effects change of the scanner's statistics.
//!
//! Of the car's motion nothing needs to be kept but how what is left of it scatters: a log's own commands are played with
//! each effect when the log is read.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use asami_dataset::{Channel as Rows, Command, Dataset, Firings, Log, Seed};
use asami_math::elementary::ln;
use asami_sim::effect::Place;
use asami_sim::effects::Effects;
use asami_sim::knobs::Knobs;
use asami_sim::robots::car::CarConfig;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::between::{self, Between, CLOCK_STEP_S, Column, Nominally, apart_s, scatter};
use super::driven::Driven;
use super::flexible;
use super::gears::Gears;
use super::law::{Law, plain_mean};
use super::memory::Memory;
use super::motion::{CannotFollow, Moved, Step};
use super::read::Read;
use super::road::Ride;
use super::scanner::{COUNT, IN_LOGARITHMS, Segment, segments};
use crate::judge::Judge;
use crate::library::{Budget, CannotLearn, FIRST_SEED, Responds, play};
use crate::nominal::{CannotPlay, Nominal};
use crate::plant::{Planted, Variant};
use crate::shrink::stands_out;
use crate::sizes::{spaced, straight};
use crate::view::CannotSee;

/// The nominal car, and what its drives say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// The car.
    pub car: CarConfig,
    /// Effects that are nominally on.
    pub effects: Effects,
    /// How far the times of motions are ahead of the commands' even so: what matching scans does to the beginning of a step.
    pub ahead_s: f64,
    /// One turn of the scanner's head.
    pub turn_s: f64,
    /// How what is left of speed and turning rate scatters.
    pub memory: [Memory; 2],
    /// What drives differ in.
    pub between: Between,
    /// How the scanner's statistics do.
    pub law: Law,
    /// The statistics of the first drives, by segment: what effects are held against.
    pub first: Vec<Vec<[Option<f64>; COUNT]>>,
}

/// What one kind of effect changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// [`Variant::name`].
    pub kind: String,
    /// Sizes played, increasing.
    pub sizes: Vec<f64>,
    /// By how much it moves each statistic at these sizes; empty where it does not act on the scanner.
    pub moved: Vec<[f64; COUNT]>,
    /// Standard deviations by which drives differ in that.
    pub further: Vec<[f64; COUNT]>,
}

/// The library of a car's world.
#[derive(Debug)]
pub struct Drives {
    /// Nominally.
    pub base: Base,
    /// Kinds of effects.
    pub entries: Vec<Entry>,
    /// Logs that were read last: to read one takes far longer than to hold it against a response.
    lately: Lately,
}

/// The last few logs.
#[derive(Default)]
struct Lately(Mutex<Vec<(Arc<Firings>, Arc<Read>)>>);

/// Nominal drives last so many times as long as those with effects: the first corner comes late.
const LONGER: f64 = 2.0;

/// Heads turn so fast unless the log says otherwise.
const USUAL_HZ: f64 = 10.0;
/// So often the clocks are set by what is left.
const CLOCK_ROUNDS: usize = 3;
/// As many.
const LATELY: usize = 4;

impl std::fmt::Debug for Lately {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("_")
    }
}

/// Motion and statistics of one drive.
#[derive(Clone, Debug)]
struct Drive {
    commands: Rows<Command>,
    steps: Vec<Step>,
    gears: Gears,
    left: Vec<[f64; 2]>,
    segments: Vec<Segment>,
    turn_s: f64,
}

impl Drive {
    fn of(run: &Dataset) -> Result<Self, CannotLearn> {
        let (moved, segments) = scanned(&run.log)?;
        Ok(Self {
            commands: run.log.commands.clone(),
            steps: moved.steps,
            gears: Gears::default(),
            left: Vec::new(),
            segments,
            turn_s: 1.0 / turn_rate_hz(&run.log),
        })
    }

    fn ride<'a>(&'a self, car: &'a CarConfig) -> Ride<'a> {
        Ride { car, commands: &self.commands, steps: &self.steps }
    }
}

fn turn_rate_hz(log: &Log) -> f64 {
    log.known.velodyne.as_ref().map_or(USUAL_HZ, |unit| unit.turn_rate_hz)
}

/// A log's motion and statistics.
pub(super) fn scanned(log: &Log) -> Result<(Moved<'_>, Vec<Segment>), CannotFollow> {
    let moved = Moved::read(log)?;
    let height_m = log.known.velodyne.as_ref().map_or(2.0, |unit| unit.sensor_height_m);
    let segments = segments(&moved, turn_rate_hz(log), height_m);
    Ok((moved, segments))
}

/// Finds the gears of every drive.
fn find_gears(car: &CarConfig, effects: &Effects, drives: &mut [Drive], ahead_s: f64) -> Result<(), CannotPlay> {
    drives.par_iter_mut().with_max_len(1).try_for_each(|it| {
        it.gears = Gears::found(&it.ride(car), effects, ahead_s)?;
        Ok(())
    })
}

/// What the drives leave with the scanner's clock so far ahead, and the ways in which it may be off.
fn nominally<'a>(
    car: &CarConfig,
    effects: &Effects,
    drives: &'a mut [Drive],
    ahead_s: f64,
) -> Result<Vec<Nominally<'a>>, CannotPlay> {
    let columns = drives.par_iter_mut().with_max_len(1).map(|it| {
        let left = |ahead_s: f64| it.ride(car).left(effects, ahead_s, &it.gears);
        let later = left(ahead_s + CLOCK_STEP_S)?;
        it.left = left(ahead_s)?;
        Ok(between::columns(&flexible::columns(&it.steps, &it.commands), &it.left, &later))
    });
    let columns: Vec<Vec<Column>> = columns.collect::<Result<_, CannotPlay>>()?;
    let all = drives.iter().zip(columns);
    Ok(all.map(|(it, columns)| Nominally { steps: &it.steps, left: &it.left, columns }).collect())
}

impl Base {
    /// Plays and learns the nominal drives.
    ///
    /// # Errors
    /// If the world cannot be played, or no drive can be read.
    pub fn learn(nominal: &dyn Nominal, budget: &Budget) -> Result<Self, CannotLearn> {
        let car = nominal.car().ok_or_else(|| CannotPlay("its robot is no car".to_owned()))?;
        let effects = nominal.effects();
        let seeds: Vec<u64> = (0..budget.nominal_runs).collect();
        let drive = |i: u64| -> Result<Option<Drive>, CannotLearn> {
            let run = play(nominal, &[], Seed(FIRST_SEED + i), LONGER * budget.run_s)?;
            // A drive that stands at a stop line all the time says nothing.
            Ok(Drive::of(&run).ok())
        };
        let drives: Vec<Option<Drive>> =
            seeds.into_par_iter().with_max_len(1).map(drive).collect::<Result<_, CannotLearn>>()?;
        Self::of(car, effects, drives, budget.runs as usize)
    }

    /// What nominal drives say; the first `kept` of them are what effects are held against.
    fn of(car: &CarConfig, effects: &Effects, drives: Vec<Option<Drive>>, kept: usize) -> Result<Self, CannotLearn> {
        let first = drives.iter().take(kept).map(|drive| {
            let values = |segment: &Segment| segment.values.map(|it| it.is_finite().then_some(it));
            drive.as_ref().map_or_else(Vec::new, |drive| drive.segments.iter().map(values).collect())
        });
        let first = first.collect();
        let mut drives: Vec<Drive> = drives.into_iter().flatten().collect();
        if drives.len() < 3 {
            return Err(CannotLearn::Blind);
        }
        let turn_s = drives.first().map_or(1.0 / USUAL_HZ, |drive| drive.turn_s);
        let mut ahead_s = 0.0;
        find_gears(car, effects, &mut drives, ahead_s)?;
        for _ in 0..CLOCK_ROUNDS {
            ahead_s -= apart_s(&nominally(car, effects, &mut drives, ahead_s)?);
        }
        find_gears(car, effects, &mut drives, ahead_s)?;
        let (memory, between) = scatter(&nominally(car, effects, &mut drives, ahead_s)?);
        let law = Law::learn(&drives.into_iter().map(|it| it.segments).collect::<Vec<_>>());
        Ok(Self { car: car.clone(), effects: effects.clone(), ahead_s, turn_s, memory, between, law, first })
    }
}

/// Where a kind of effect may show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shows {
    /// In how the car moves.
    pub in_motion: bool,
    /// In what the scanner says of itself.
    pub in_scans: bool,
    /// How far it puts the scanner's clock ahead.
    pub ahead_s: f64,
    /// And by how many turns of its head: what is given as seen when the turn began is seen half a turn late.
    pub ahead_turns: f64,
}

impl Shows {
    /// By what the effects do to the world's knobs.
    pub fn of(effects: &Effects, place: Place) -> Self {
        let (mut knobs, nominal) = (Knobs::default(), Knobs::default());
        effects.iter().for_each(|effect| effect.tune(0.0, &mut knobs));
        let ahead_s = knobs.velodyne.ahead_s;
        let ahead_turns = 0.5 * knobs.velodyne.compensated;
        let loaded = knobs.vehicle.luggage_kg != 0.0 || knobs.vehicle.mass_ratio != 1.0;
        knobs.velodyne.ahead_s = 0.0;
        let senses = matches!(place, Place::Sensing | Place::Scene);
        Self {
            in_motion: !senses || ahead_s != 0.0 || ahead_turns != 0.0,
            in_scans: loaded || knobs.velodyne != nominal.velodyne || (senses && ahead_s == 0.0),
            ahead_s,
            ahead_turns,
        }
    }
}

/// The nominal effects with one more.
pub(super) fn with(effects: &Effects, variant: &Variant, size: f64) -> Effects {
    let mut effects = effects.clone();
    variant.plant(size, &mut effects);
    effects
}

impl Entry {
    /// Plays one kind of effect at its sizes, with the seeds of the first nominal drives, and learns what it changes.
    ///
    /// # Errors
    /// If the world cannot be played.
    pub fn learn(nominal: &dyn Nominal, base: &Base, variant: &Variant, budget: &Budget) -> Result<Self, CannotPlay> {
        let greatest = variant.sizes().1;
        let sizes = spaced(variant, budget.sizes.max(2));
        let n = sizes.len();
        let mut entry = Self { kind: variant.name(), sizes, moved: Vec::new(), further: Vec::new() };
        if !Shows::of(&with(&base.effects, variant, greatest), variant.place()).in_scans {
            return Ok(entry);
        }
        let runs: Vec<(usize, u64)> = (0..n).flat_map(|i| (0..budget.runs).map(move |run| (i, run))).collect();
        let sizes = &entry.sizes;
        let change = |(i, run): (usize, u64)| -> Result<Option<[f64; COUNT]>, CannotPlay> {
            let planted = [Planted { variant: variant.clone(), size: sizes[i] }];
            let played = play(nominal, &planted, Seed(FIRST_SEED + run), budget.run_s)?;
            let Ok((_, segments)) = scanned(&played.log) else { return Ok(None) };
            let nominal = base.first.get(run as usize).map_or(&[][..], Vec::as_slice);
            let off = |k: usize| {
                let pairs = segments.iter().zip(nominal);
                plain_mean(pairs.map(|(with, without)| with.values[k] - without[k].unwrap_or(f64::NAN)))
            };
            Ok(Some(std::array::from_fn(off)))
        };
        let changes: Vec<Option<[f64; COUNT]>> =
            runs.par_iter().with_max_len(1).map(|at| change(*at)).collect::<Result<_, CannotPlay>>()?;
        for of_size in changes.chunks(budget.runs.max(1) as usize) {
            let told: [(f64, f64); COUNT] = std::array::from_fn(|k| {
                told(of_size.iter().flatten().map(|change| change[k]).filter(|it| it.is_finite()).collect())
            });
            entry.moved.push(told.map(|it| it.0));
            entry.further.push(told.map(|it| it.1));
        }
        Ok(entry)
    }

    /// What it adds to the statistics' means and spreads at a size. Logarithms run straight in the size's logarithm, the
    /// rest in the size.
    pub fn add(&self, size: f64, moved: &mut [f64], further: &mut [f64]) {
        if self.moved.is_empty() {
            return;
        }
        let (plain, logarithmic) = (straight(&self.sizes, size, |size| size), straight(&self.sizes, size, ln));
        for k in 0..COUNT {
            let weights = if IN_LOGARITHMS[k] { &logarithmic } else { &plain };
            for (i, weight) in weights.iter().enumerate() {
                moved[k] += weight * self.moved[i][k];
                further[k] += weight * self.further[i][k];
            }
        }
    }
}

/// What some drives' changes tell: their mean, as far as it is more than chance, and their spread.
fn told(changes: Vec<f64>) -> (f64, f64) {
    let n = changes.len() as f64;
    if n < 2.0 {
        return (changes.first().copied().unwrap_or(0.0), 0.0);
    }
    let mean = plain_mean(changes.iter().copied());
    let variance = changes.iter().fold(0.0, |sum, it| sum + (it - mean) * (it - mean)) / (n - 1.0);
    (stands_out(mean, variance / n), (variance * (1.0 + 1.0 / n)).sqrt())
}

impl Drives {
    /// Of parts that were learned.
    #[must_use]
    pub fn new(base: Base, entries: Vec<Entry>) -> Self {
        Self { base, entries, lately: Lately::default() }
    }

    /// Of a car whose motion is told by its odometry: nothing is known of a scanner, nor yet of how what is left scatters.
    #[must_use]
    pub fn of_motion(car: &CarConfig, effects: &Effects) -> Self {
        let base = Base {
            car: car.clone(),
            effects: effects.clone(),
            ahead_s: 0.0,
            turn_s: 1.0 / USUAL_HZ,
            memory: [Memory::default(); 2],
            between: Between::default(),
            law: Law::learn(&[]),
            first: Vec::new(),
        };
        Self::new(base, Vec::new())
    }

    /// Has these kinds of effects played when a log is read, as far as they act on how a car moves.
    pub fn play(&mut self, variants: &[Variant]) {
        let entry = |variant: &Variant| Entry {
            kind: variant.name(),
            sizes: Vec::new(),
            moved: Vec::new(),
            further: Vec::new(),
        };
        self.entries = variants.iter().map(entry).collect();
    }

    /// The entries by kind.
    pub(super) fn kinds(&self) -> BTreeMap<&str, &Entry> {
        self.entries.iter().map(|entry| (entry.kind.as_str(), entry)).collect()
    }
}

impl Responds for Drives {
    fn judge<'a>(&'a self, log: &Log) -> Result<Box<dyn Judge + 'a>, CannotSee> {
        let known = |firings: &Arc<Firings>| {
            let lately = self.lately.0.lock().unwrap_or_else(PoisonError::into_inner);
            let found = lately.iter().find(|(its, read)| Arc::ptr_eq(its, firings) && read.commands == log.commands);
            found.map(|(_, read)| Arc::clone(read))
        };
        let firings = log.firings.as_ref();
        if let Some(read) = firings.and_then(known) {
            return Ok(Box::new(Driven::new(self, read)));
        }
        let read = Arc::new(Read::new(self, log)?);
        if let Some(firings) = firings {
            let mut lately = self.lately.0.lock().unwrap_or_else(PoisonError::into_inner);
            lately.insert(0, (Arc::clone(firings), Arc::clone(&read)));
            lately.truncate(LATELY);
        }
        Ok(Box::new(Driven::new(self, read)))
    }
}
