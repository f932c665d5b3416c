//! One drive under many responses.

use asami_dataset::{Action, Channel as Rows, Command, Log};
use asami_sim::effects::Effects;
use rayon::prelude::*;

use super::between::{self, CLOCK_STEP_S, Course, Rows as Differ};
use super::flexible::{Flexible, columns};
use super::library::{Base, Drives, Shows, scanned, with};
use super::memory::Memory;
use super::motion::Step;
use super::road::{Left, left};
use super::scanner::{COUNT, STATISTICS, Segment};
use crate::directions::Direction;
use crate::judge::{Channel, Innovation, Judge, Moment, Reading, Regime};
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
    kind: String,
    sizes: Vec<f64>,
    /// By size: change of what is left of speed and turning rate, by step.
    change: Vec<Vec<Left>>,
}

impl Played {
    /// Plays one kind of effect from its greatest size down, for as long as smaller ones are not in proportion.
    fn new(
        variant: &Variant,
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
        Ok(played)
    }
}

/// How far a change is off a share of another one.
fn bent_nats(base: &Base, steps: &[Step], change: &[Left], other: &[Left], share: f64) -> f64 {
    let of = |(step, (a, b)): (&Step, (&Left, &Left))| {
        let off = |axis: usize| (a[axis] - share * b[axis]) / base.memory[axis].spread_of(step);
        0.5 * (off(0) * off(0) + off(1) * off(1))
    };
    steps.iter().zip(change.iter().zip(other)).map(of).fold(0.0, |sum, it| sum + it)
}

/// A log, read: its motion, what is left of it, its statistics.
#[derive(Debug)]
pub struct Read {
    pub(super) commands: Rows<Command>,
    pub(super) steps: Vec<Step>,
    /// Less than what the nominal car does.
    left: Vec<Left>,
    played: Vec<Played>,
    flexible: Vec<Flexible>,
    /// In what drives differ.
    differ: Differ,
    segments: Vec<Segment>,
    /// The step in which each segment is scored.
    scored_in: Vec<usize>,
    /// The first step that is scored.
    first: usize,
}

/// A log under the responses of a library.
///
/// A response's numbers are weights of what effects were played to change, of speeds and then of turning rates; weights
/// of the flexible columns; moves and further scatter of the scanner's statistics; two logarithms of louder scatter.
pub struct Driven<'a> {
    library: &'a Drives,
    read: std::sync::Arc<Read>,
    moments: Vec<Moment>,
}

impl Read {
    /// Reads a log and plays its commands with every kind of effect.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn new(library: &Drives, log: &Log) -> Result<Self, CannotSee> {
        let pedals = |command: &&Command| matches!(command.action, Action::Pedals { .. });
        if !log.commands.iter().any(|command| pedals(&command)) {
            return Err(CannotSee::NoPedals);
        }
        let (moved, segments) = scanned(log)?;
        let steps = moved.steps;
        let base = &library.base;
        let begins_s = steps.first().map_or(0.0, |step| step.t_s) + SETTLING_S;
        let first = steps.partition_point(|step| step.t_s < begins_s).max(Memory::SILENT);
        if steps.len() < first + LEAST_STEPS {
            return Err(CannotSee::TooShort {
                frames: moved.scans.len(),
                seen: steps.len(),
                least: first + LEAST_STEPS,
            });
        }
        let play =
            |effects: &Effects, ahead_s: f64| left(&base.car, effects, &log.commands, &steps, base.ahead_s + ahead_s);
        let cannot = |error: CannotPlay| CannotSee::Play(error);
        let nominal = play(&base.effects, 0.0).map_err(cannot)?;
        let all = Variant::all("car", 0, &[]);
        let kinds: Vec<&Variant> = all
            .iter()
            .filter(|variant| library.kinds().contains_key(variant.name().as_str()))
            .filter(|variant| Shows::of(&with(&base.effects, variant, variant.sizes().1), variant.place()).in_motion)
            .collect();
        let change = |variant: &Variant, size: f64| -> Result<Vec<Left>, CannotPlay> {
            let effects = with(&base.effects, variant, size);
            let left = play(&effects, Shows::of(&effects, variant.place()).ahead_s)?;
            Ok(left.iter().zip(&nominal).map(|(with, without)| [with[0] - without[0], with[1] - without[1]]).collect())
        };
        let played = kinds
            .par_iter()
            .with_max_len(1)
            .map(|variant| Played::new(variant, base, &steps, &|size| change(variant, size)))
            .collect::<Result<_, CannotPlay>>()
            .map_err(cannot)?;
        let later = play(&base.effects, CLOCK_STEP_S).map_err(cannot)?;
        let flexible = columns(&steps, &log.commands);
        let ways = between::columns(&flexible, &nominal, &later);
        let in_step =
            |segment: &Segment| steps.partition_point(|step| step.t_s < segment.t_s).clamp(first + 1, steps.len()) - 1;
        Ok(Self {
            differ: base.between.rows(&base.memory, &steps, &ways),
            commands: log.commands.clone(),
            flexible,
            scored_in: segments.iter().map(in_step).collect(),
            left: nominal,
            played,
            segments,
            first,
            steps,
        })
    }

    fn played_columns(&self) -> usize {
        self.played.iter().map(|it| it.sizes.len()).sum()
    }
}

/// Where a response's numbers are.
struct Layout {
    played: usize,
    flexible: usize,
}

impl Layout {
    fn flexible(&self) -> usize {
        2 * self.played
    }

    fn moved(&self) -> usize {
        self.flexible() + self.flexible
    }

    fn further(&self) -> usize {
        self.moved() + COUNT
    }

    fn louder(&self) -> usize {
        self.further() + COUNT
    }

    fn len(&self) -> usize {
        self.louder() + 2
    }
}

impl<'a> Driven<'a> {
    /// A log that was read, under a library's responses.
    #[must_use]
    pub fn new(library: &'a Drives, read: std::sync::Arc<Read>) -> Self {
        let mut moments: Vec<Moment> =
            read.steps[read.first..].iter().map(|step| Moment { t_s: step.t_s, seen: 2 }).collect();
        for (segment, step) in read.segments.iter().zip(&read.scored_in) {
            let seen = segment.values.iter().filter(|it| it.is_finite()).count();
            moments[step - read.first].seen += seen;
        }
        Self { library, read, moments }
    }

    fn layout(&self) -> Layout {
        Layout { played: self.read.played_columns(), flexible: self.read.flexible.len() }
    }

    /// What is left of each axis's motion under a response.
    fn left(&self, numbers: &[f64]) -> [Vec<f64>; 2] {
        let (read, layout) = (&*self.read, self.layout());
        let mut left = [0, 1].map(|axis| read.left.iter().map(|it| it[axis]).collect::<Vec<f64>>());
        let changes = read.played.iter().flat_map(|it| &it.change);
        for (i, change) in changes.enumerate() {
            for (axis, left) in left.iter_mut().enumerate() {
                let weight = numbers[axis * layout.played + i];
                if weight != 0.0 {
                    left.iter_mut().zip(change).for_each(|(left, change)| *left += weight * change[axis]);
                }
            }
        }
        for (column, weight) in read.flexible.iter().zip(&numbers[layout.flexible()..]).filter(|(_, w)| **w != 0.0) {
            left[column.axis].iter_mut().zip(&column.values).for_each(|(left, value)| *left -= weight * value);
        }
        left
    }
}

impl Judge for Driven<'_> {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        let layout = self.layout();
        let mut numbers = vec![0.0; layout.len()];
        let kinds = self.library.kinds();
        for Planted { variant, size } in planted {
            let name = variant.name();
            let mut at = 0;
            for played in &self.read.played {
                if played.kind == name {
                    for (i, weight) in straight(&played.sizes, *size, |size| size).into_iter().enumerate() {
                        numbers[at + i] += weight;
                        numbers[layout.played + at + i] += weight;
                    }
                }
                at += played.sizes.len();
            }
            if let Some(entry) = kinds.get(name.as_str()) {
                let (before, further) = numbers.split_at_mut(layout.further());
                entry.add(*size, &mut before[layout.moved()..], further);
            }
        }
        numbers
    }

    fn knows(&self, variant: &Variant) -> bool {
        self.library.kinds().contains_key(variant.name().as_str())
    }

    fn read(&self, numbers: &[f64]) -> Reading {
        let (read, layout) = (&*self.read, self.layout());
        let left = self.left(numbers);
        let law = &self.library.base.law;
        let said = law.read(&read.segments, &numbers[layout.moved()..], &numbers[layout.further()..]);
        let mut reading = Reading::default();
        let base = &self.library.base;
        let mut weights = base.between.unknown();
        let course = Course { memory: &base.memory, steps: &read.steps, left: &left, rows: &read.differ };
        for i in read.first..read.steps.len() {
            let (mut log_likelihood, mut expected) = (0.0, 0.0);
            for (axis, left) in left.iter().enumerate() {
                let louder = numbers[layout.louder() + axis];
                let fresh = weights.fresh(&course, axis, i, louder);
                log_likelihood += fresh.log_likelihood;
                expected += fresh.expected;
                reading.innovations.push(Innovation {
                    channel: axis,
                    plain: left[i],
                    white: fresh.white,
                    ln_scale: fresh.ln_scale,
                    genuine: fresh.genuine,
                });
            }
            for (said, _) in said.iter().zip(&read.scored_in).filter(|(_, step)| **step == i) {
                log_likelihood += said.log_likelihood;
                expected += said.expected;
                let innovation = |&(k, plain, white, ln_scale, genuine): &(usize, f64, f64, f64, bool)| Innovation {
                    channel: 2 + k,
                    plain,
                    white,
                    ln_scale,
                    genuine,
                };
                reading.innovations.extend(said.off.iter().map(innovation));
            }
            reading.log_likelihoods.push(log_likelihood);
            reading.expected.push(expected);
        }
        reading.observations = reading.innovations.len();
        reading
    }

    fn steps(&self) -> &[Moment] {
        &self.moments
    }

    fn length_s(&self) -> f64 {
        let steps = &self.read.steps;
        steps.first().zip(steps.last()).map_or(0.0, |(first, last)| last.t_s + last.dt_s - first.t_s)
    }

    fn measured(&self) -> Vec<&'static str> {
        ["acceleration", "yaw_rate"].into_iter().chain(STATISTICS.iter().map(|(name, _)| *name)).collect()
    }

    fn directions(&self, _numbers: &[f64], block: &str) -> Vec<Direction> {
        let layout = self.layout();
        let one = |at: usize, unit: f64| {
            let mut direction = vec![0.0; layout.len()];
            direction[at] = unit;
            direction
        };
        let columns = self.read.flexible.iter().enumerate().filter(|(_, column)| column.block == block);
        let mut directions: Vec<Direction> =
            columns.map(|(i, column)| one(layout.flexible() + i, column.unit)).collect();
        let statistics = super::scanner::BLOCKS.iter().enumerate().filter(|(_, (of, _))| *of == block);
        directions.extend(statistics.map(|(k, (_, unit))| one(layout.moved() + k, *unit)));
        if block == "noise" {
            directions.extend([0, 1].map(|axis| one(layout.louder() + axis, 0.5)));
        }
        directions
    }

    fn channels(&self) -> Vec<Channel> {
        let layout = self.layout();
        let axis = |name: &'static str, axis: usize| {
            let flexible = self.read.flexible.iter().enumerate();
            let own = flexible.filter(|(_, it)| it.axis == axis).map(|(i, _)| layout.flexible() + i);
            Channel {
                name,
                means: (axis * layout.played..(axis + 1) * layout.played).chain(own).collect(),
                noise: vec![layout.louder() + axis],
            }
        };
        let of = |name: &'static str| {
            let own: Vec<usize> = (0..COUNT).filter(|k| STATISTICS[*k].1 == name).collect();
            Channel {
                name,
                means: own.iter().map(|k| layout.moved() + k).collect(),
                noise: own.iter().map(|k| layout.further() + k).collect(),
            }
        };
        let scanner = ["timing", "lidar_angle", "lidar_range", "detection"].map(of);
        [axis("acceleration", 0), axis("yaw_rate", 1)].into_iter().chain(scanner).collect()
    }

    fn regimes(&self) -> Vec<Regime> {
        let steps = &self.read.steps[self.read.first..];
        let of = |what: &dyn Fn(&Step) -> bool| steps.iter().map(what).collect::<Vec<_>>();
        let gains: Vec<f64> =
            steps.windows(2).map(|pair| (pair[1].v_m_per_s - pair[0].v_m_per_s) / pair[1].dt_s).chain([0.0]).collect();
        let half = steps.len() / 2;
        vec![
            ("standing", of(&|step| step.v_m_per_s.abs() < 0.3)),
            ("below 4 m/s", of(&|step| (0.3..4.0).contains(&step.v_m_per_s))),
            ("above 4 m/s", of(&|step| step.v_m_per_s >= 4.0)),
            ("pulling away", gains.iter().map(|gain| *gain > 0.5).collect()),
            ("braking", gains.iter().map(|gain| *gain < -0.5).collect()),
            ("turning left", of(&|step| step.omega_rad_per_s > 0.05)),
            ("turning right", of(&|step| step.omega_rad_per_s < -0.05)),
            ("the first half of the log", (0..steps.len()).map(|i| i < half).collect()),
            ("the second half of the log", (0..steps.len()).map(|i| i >= half).collect()),
        ]
    }
}
