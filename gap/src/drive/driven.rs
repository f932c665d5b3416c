//! One drive under many responses.

use super::between::{self, Course, Nominally};
use super::flexible::Flexible;
use super::library::Drives;
use super::memory::Memory;
use super::motion::Step;
use super::read::Read;
use super::road::Left;
use super::scanner::{COUNT, STATISTICS};
use crate::directions::Direction;
use crate::judge::{Channel, Innovation, Judge, Moment, Reading, Regime};
use crate::plant::{Planted, Variant};
use crate::sizes::straight;

/// A log under the responses of a library.
///
/// A response's numbers are weights of what effects were played to change, of speeds and then of turning rates; weights
/// of the flexible columns; moves and further scatter of the scanner's statistics; two logarithms of louder scatter.
pub struct Driven<'a> {
    library: &'a Drives,
    read: std::sync::Arc<Read>,
    /// The steps that are scored, in order.
    scored: Vec<usize>,
    moments: Vec<Moment>,
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
        Self::scoring(library, read, |_| true)
    }

    /// The same, scored in some of its steps only, by their numbers.
    pub(crate) fn scoring(library: &'a Drives, read: std::sync::Arc<Read>, scores: impl Fn(usize) -> bool) -> Self {
        let scored: Vec<usize> = (read.first..read.steps.len()).filter(|i| scores(*i)).collect();
        let moment = |i: &usize| {
            let segments = read.segments.iter().zip(&read.scored_in).filter(|(_, step)| *step == i);
            let seen = segments.flat_map(|(segment, _)| &segment.values).filter(|it| it.is_finite()).count();
            Moment { t_s: read.steps[*i].t_s, seen: 2 + seen }
        };
        let moments = scored.iter().map(moment).collect();
        Self { library, read, scored, moments }
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

impl Driven<'_> {
    /// How what is left at some of the steps scatters with these effects in the world, whatever else may be in it left free there,
    /// so that no gap is taken for noise.
    pub(crate) fn noise(&self, planted: &[Planted], at: &[usize]) -> [Memory; 2] {
        let left = self.left(&self.numbers(planted));
        let steps: Vec<Step> = at.iter().map(|i| self.read.steps[*i]).collect();
        let left: Vec<Left> = at.iter().map(|i| [left[0][*i], left[1][*i]]).collect();
        let there = |it: &Flexible| Flexible { values: at.iter().map(|i| it.values[*i]).collect(), ..it.clone() };
        let flexible: Vec<Flexible> = self.read.flexible.iter().map(there).collect();
        let columns = between::columns(&flexible, &left, &left);
        let (memory, _) = between::scatter(&[Nominally { steps: &steps, left: &left, columns }]);
        memory.map(Memory::about_none)
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
        let mut scored = self.scored.iter().peekable();
        let course = Course { memory: &base.memory, steps: &read.steps, left: &left, rows: &read.differ };
        for i in read.first..read.steps.len() {
            let (mut log_likelihood, mut expected, mut innovations) = (0.0, 0.0, Vec::new());
            for (axis, left) in left.iter().enumerate() {
                let louder = numbers[layout.louder() + axis];
                let fresh = weights.fresh(&course, axis, i, louder);
                log_likelihood += fresh.log_likelihood;
                expected += fresh.expected;
                innovations.push(Innovation {
                    channel: axis,
                    plain: left[i],
                    white: fresh.white,
                    ln_scale: fresh.ln_scale,
                    genuine: fresh.genuine,
                });
            }
            if scored.next_if_eq(&&i).is_none() {
                continue;
            }
            reading.innovations.append(&mut innovations);
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
        // Without scans nothing is known of a scanner.
        let statistics = STATISTICS.iter().filter(|_| !self.read.segments.is_empty());
        ["acceleration", "yaw_rate"].into_iter().chain(statistics.map(|(name, _)| *name)).collect()
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
        let scanner: &[&str] = match &self.read.segments[..] {
            [] => &[],
            _ => &["timing", "lidar_angle", "lidar_range", "detection"],
        };
        [axis("acceleration", 0), axis("yaw_rate", 1)].into_iter().chain(scanner.iter().map(|name| of(name))).collect()
    }

    fn regimes(&self) -> Vec<Regime> {
        let steps = &self.read.steps;
        let of = |what: &dyn Fn(&Step) -> bool| self.scored.iter().map(|i| what(&steps[*i])).collect::<Vec<_>>();
        let gain = |i: &usize| {
            let next = steps.get(i + 1);
            next.map_or(0.0, |next| (next.v_m_per_s - steps[*i].v_m_per_s) / next.dt_s)
        };
        let gains: Vec<f64> = self.scored.iter().map(gain).collect();
        let (n, half) = (self.scored.len(), self.scored.len() / 2);
        vec![
            ("standing", of(&|step| step.v_m_per_s.abs() < 0.3)),
            ("below 4 m/s", of(&|step| (0.3..4.0).contains(&step.v_m_per_s))),
            ("above 4 m/s", of(&|step| step.v_m_per_s >= 4.0)),
            ("pulling away", gains.iter().map(|gain| *gain > 0.5).collect()),
            ("braking", gains.iter().map(|gain| *gain < -0.5).collect()),
            ("turning left", of(&|step| step.omega_rad_per_s > 0.05)),
            ("turning right", of(&|step| step.omega_rad_per_s < -0.05)),
            ("the first half of the log", (0..n).map(|i| i < half).collect()),
            ("the second half of the log", (0..n).map(|i| i >= half).collect()),
        ]
    }
}
