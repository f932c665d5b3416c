//! A log of a car, read: how it moved, and what its commands bring about in the nominal world and with each kind of effect.

use asami_dataset::{Action, Channel as Rows, Command, Log};
use asami_sim::effects::Effects;
use rayon::prelude::*;

use super::between::{self, CLOCK_STEP_S, Rows as Differ};
use super::flexible::{Flexible, columns};
use super::gears::Gears;
use super::library::{Base, Drives, Shows, scanned, with};
use super::memory::Memory;
use super::motion::Step;
use super::road::{Left, Ride};
use super::scanner::Segment;
use crate::nominal::CannotPlay;
use crate::plant::{Planted, Variant};
use crate::sizes::{spaced, straight};
use crate::view::CannotSee;

/// Nothing is scored before the played car goes as the log's did.
const SETTLING_S: f64 = 5.0;
/// Most sizes at which a log's commands are played, of each kind of effect.
const SIZES: usize = 4;
/// A size that adds less to what a straight line from none to the next greater one says, in nats, is the last.
const STRAIGHT_NATS: f64 = 0.1;
/// Fewer steps say nothing.
const LEAST_STEPS: usize = 20;

/// What the played car does otherwise with an effect in its world.
#[derive(Debug)]
pub(super) struct Played {
    /// [`Variant::name`].
    pub kind: String,
    /// Increasing.
    pub sizes: Vec<f64>,
    /// By size: change of what is left of speed and turning rate, by step.
    pub change: Vec<Vec<Left>>,
}

impl Played {
    /// Plays one kind of effect from its greatest size down, for as long as smaller ones are not in proportion; and at the size
    /// that it is held to have, if any.
    fn new(
        variant: &Variant,
        held: Option<f64>,
        base: &Base,
        steps: &[Step],
        change: &dyn Fn(f64) -> Result<Vec<Left>, CannotPlay>,
    ) -> Result<Self, CannotPlay> {
        let mut played = Self { kind: variant.name(), sizes: Vec::new(), change: Vec::new() };
        for size in spaced(variant, SIZES).into_iter().rev() {
            let change = change(size)?;
            let above = played.sizes.first().zip(played.change.first());
            let bent = above.map(|(its, above)| bent_nats(base, steps, &change, above, size / its));
            played.sizes.insert(0, size);
            played.change.insert(0, change);
            if bent.is_some_and(|nats| nats < STRAIGHT_NATS) {
                break;
            }
        }
        if let Some(size) = held.filter(|size| !played.sizes.contains(size)) {
            let at = played.sizes.partition_point(|it| *it < size);
            played.sizes.insert(at, size);
            played.change.insert(at, change(size)?);
        }
        Ok(played)
    }

    /// What this size changes at a step.
    fn changes(&self, size: f64, i: usize) -> Left {
        let weights = straight(&self.sizes, size, |size| size);
        let of = |axis: usize| self.change.iter().zip(&weights).fold(0.0, |sum, (it, w)| sum + w * it[i][axis]);
        [of(0), of(1)]
    }
}

/// How far a change is off a share of another one.
fn bent_nats(base: &Base, steps: &[Step], change: &[Left], other: &[Left], share: f64) -> f64 {
    let of = |(i, (a, b)): (usize, (&Left, &Left))| {
        let off = |axis: usize| (a[axis] - share * b[axis]) / base.memory[axis].spread_of(steps, i);
        0.5 * (off(0) * off(0) + off(1) * off(1))
    };
    change.iter().zip(other).enumerate().map(of).fold(0.0, |sum, it| sum + it)
}

/// A log, read: its motion, what is left of it, its statistics.
#[derive(Debug)]
pub struct Read {
    pub(super) commands: Rows<Command>,
    /// Of its motion.
    pub(super) steps: Vec<Step>,
    /// Less than what the nominal car does.
    pub(super) left: Vec<Left>,
    pub(super) played: Vec<Played>,
    pub(super) flexible: Vec<Flexible>,
    /// In what drives differ.
    pub(super) differ: Differ,
    pub(super) segments: Vec<Segment>,
    /// The step in which each segment is scored.
    pub(super) scored_in: Vec<usize>,
    /// The first step that is scored.
    pub(super) first: usize,
}

impl Read {
    /// Reads a log by its scans, and plays its commands with every kind of effect.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn new(library: &Drives, log: &Log) -> Result<Self, CannotSee> {
        let pedals = |command: &&Command| matches!(command.action, Action::Pedals { .. });
        if !log.commands.iter().any(|command| pedals(&command)) {
            return Err(CannotSee::NoPedals);
        }
        let (moved, segments) = scanned(log)?;
        let (frames, steps) = (moved.scans.len(), moved.steps);
        let (first, seen) = (settled(&steps), steps.len());
        if seen < first + LEAST_STEPS {
            return Err(CannotSee::TooShort { frames, seen, least: first + LEAST_STEPS });
        }
        Self::of(library, &log.commands, (steps, segments), &[]).map_err(CannotSee::Play)
    }

    /// Plays the commands of a drive of which motion and statistics are known. What each kind of effect changes is played with
    /// `held` in the world: changes are taken for additive, and are so only near there.
    pub(crate) fn of(
        library: &Drives,
        commands: &Rows<Command>,
        (steps, segments): (Vec<Step>, Vec<Segment>),
        held: &[Planted],
    ) -> Result<Self, CannotPlay> {
        let base = &library.base;
        let first = settled(&steps);
        let ride = Ride { car: &base.car, commands, steps: &steps };
        let beside = |name: &str| {
            let others = held.iter().filter(|it| it.variant.about.name != name);
            others.fold(base.effects.clone(), |effects, it| with(&effects, &it.variant, it.size))
        };
        let gears = Gears::found(&ride, &beside(""), base.ahead_s)?;
        let play = |effects: &Effects, ahead_s: f64| ride.left(effects, base.ahead_s + ahead_s, &gears);
        let all = Variant::all("car", 0, &[]);
        let kinds: Vec<&Variant> = all
            .iter()
            .filter(|variant| library.kinds().contains_key(variant.name().as_str()))
            .filter(|variant| Shows::of(&with(&base.effects, variant, variant.sizes().1), variant.place()).in_motion)
            .collect();
        let with_all = play(&beside(""), 0.0)?;
        let played = kinds.par_iter().with_max_len(1).map(|variant| {
            let others = beside(variant.about.name);
            let its = held.iter().find(|it| it.variant.name() == variant.name()).map(|it| it.size);
            let own = held.iter().any(|it| it.variant.about.name == variant.about.name);
            let without = if own { play(&others, 0.0)? } else { with_all.clone() };
            let change = |size: f64| -> Result<Vec<Left>, CannotPlay> {
                let effects = with(&others, variant, size);
                let shows = Shows::of(&effects, variant.place());
                let left = play(&effects, shows.ahead_s + shows.ahead_turns * base.turn_s)?;
                Ok(left
                    .iter()
                    .zip(&without)
                    .map(|(with, without)| [with[0] - without[0], with[1] - without[1]])
                    .collect())
            };
            Played::new(variant, its, base, &steps, &change)
        });
        let played: Vec<Played> = played.collect::<Result<_, CannotPlay>>()?;
        let nominal = less(with_all, held, &played);
        let later = play(&base.effects, CLOCK_STEP_S)?;
        let flexible = columns(&steps, commands);
        let ways = between::columns(&flexible, &nominal, &later);
        let in_step =
            |segment: &Segment| steps.partition_point(|step| step.t_s < segment.t_s).clamp(first + 1, steps.len()) - 1;
        Ok(Self {
            differ: base.between.rows(&base.memory, &steps, &ways),
            commands: commands.clone(),
            flexible,
            scored_in: segments.iter().map(in_step).collect(),
            left: nominal,
            played,
            segments,
            first,
            steps,
        })
    }

    pub(super) fn played_columns(&self) -> usize {
        self.played.iter().map(|it| it.sizes.len()).sum()
    }
}

/// The first step of which enough was seen before.
fn settled(steps: &[Step]) -> usize {
    let begins_s = steps.first().map_or(0.0, |step| step.t_s) + SETTLING_S;
    steps.partition_point(|step| step.t_s < begins_s).max(Memory::SILENT)
}

/// What would be left were nothing held: each effect's change, taken out.
fn less(mut left: Vec<Left>, held: &[Planted], played: &[Played]) -> Vec<Left> {
    for it in held {
        let Some(played) = played.iter().find(|played| played.kind == it.variant.name()) else { continue };
        for (i, left) in left.iter_mut().enumerate() {
            let change = played.changes(it.size, i);
            *left = [left[0] - change[0], left[1] - change[1]];
        }
    }
    left
}
