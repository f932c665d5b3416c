//! A scanner's log under hypotheses on its table.

use asami_math::optimise::golden_section;

use super::lasers::{Laser, Lasers, Off, Said};
use super::seen::{Mean, Seen};
use crate::directions::Direction;
use crate::judge::{Channel, Innovation, Judge, Moment, Reading, Regime};
use crate::plant::{Planted, Variant};

/// A response's numbers: variances of single lasers' vertical angles and ranges, where lasers stand, curves of their ranges.
const NUMBERS: usize = 6;
const VERTICAL: usize = 0;
const RANGE: usize = 1;
const ASIDE: usize = 2;
const APART: usize = 3;
const CURVE: usize = 4;

/// How far an effect that is in nobody's list may move them.
const UNITS: [f64; NUMBERS] = [1e-6, 4e-4, 0.01, 0.03, 0.02, 0.02];

/// Logarithms of how much louder chance may be than blocks one after another say, at least and at most.
const LOUDER: [f64; 2] = [-0.7, 1.5];

/// What is measured, in the order of [`super::seen::What::kind`].
const MEASURED: [&str; 3] = ["road_m", "walls_m", "sides_m"];

/// A log that tells how likely it is under a table of the lasers.
pub struct Table {
    seen: Seen,
    /// Of every mean: each is a step of its own, since one is as good as independent of those before it, once it is whitened.
    moments: Vec<Moment>,
    /// Logarithms of louder chance: of the road, walls, sides.
    louder: [f64; 3],
}

impl Table {
    /// A log that was seen.
    #[must_use]
    pub fn new(seen: Seen) -> Self {
        let moment = |t_s: f64| move |_: &Mean| Moment { t_s, seen: 1 };
        let moments = seen.blocks.iter().flat_map(|block| block.means.iter().map(moment(block.t_s))).collect();
        Self { seen, moments, louder: [0.0; 3] }
    }

    /// Takes chance to be as loud as is most likely with these effects.
    pub fn listen(&mut self, planted: &[Planted]) {
        let numbers = self.numbers(planted);
        for kind in 0..self.louder.len() {
            let likely = |louder: f64| {
                let mut off = self.off(&numbers);
                off.louder[kind] = louder;
                -self.said(off).flatten().fold(0.0, |sum, said| sum + said.log_likelihood())
            };
            self.louder[kind] = golden_section(likely, LOUDER[0], LOUDER[1], 0.02).x;
        }
    }

    /// What the blocks say, one after another.
    fn said(&self, off: Off) -> impl Iterator<Item = Vec<Said>> {
        let mut lasers = Lasers::new(&self.seen, off);
        let lost = Said { plain_m: 0.0, white: f64::INFINITY, ln_scale: 0.0 };
        self.seen.blocks.iter().map(move |block| lasers.take(block).unwrap_or_else(|| vec![lost; block.means.len()]))
    }

    fn off(&self, numbers: &[f64]) -> Off {
        Off {
            vertical_rad2: numbers[VERTICAL].max(0.0),
            range_m2: numbers[RANGE].max(0.0),
            aside_m: numbers[ASIDE],
            apart_m: numbers[APART],
            range_curve_m: [numbers[CURVE], numbers[CURVE + 1]],
            louder: self.louder,
        }
    }

    /// What each laser is off by, with these effects.
    #[must_use]
    pub fn lasers(&self, planted: &[Planted]) -> Vec<Laser> {
        let mut lasers = Lasers::new(&self.seen, self.off(&self.numbers(planted)));
        for block in &self.seen.blocks {
            lasers.take(block);
        }
        lasers.known()
    }
}

/// Where a response's numbers change with an effect's parameter, and whether by its square; what is not here does not show.
pub(super) fn shows(effect: &str, parameter: &str) -> Option<(usize, bool)> {
    match (effect, parameter) {
        ("vertical_angle_bias", "spread_rad") => Some((VERTICAL, true)),
        ("range_bias", "spread_m") => Some((RANGE, true)),
        ("laser_origin_offsets", "aside_m") => Some((ASIDE, false)),
        ("laser_origin_offsets", "apart_m") => Some((APART, false)),
        _ => None,
    }
}

impl Judge for Table {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        let mut numbers = vec![0.0; NUMBERS];
        for Planted { variant, size } in planted {
            for (parameter, value) in variant.values(*size) {
                if let Some((at, squared)) = shows(variant.about.name, parameter) {
                    numbers[at] += if squared { value * value } else { value };
                }
            }
        }
        numbers
    }

    fn knows(&self, variant: &Variant) -> bool {
        variant.about.parameters.iter().any(|parameter| shows(variant.about.name, parameter.name).is_some())
    }

    fn read(&self, numbers: &[f64]) -> Reading {
        let mut reading = Reading::default();
        let means = self.seen.blocks.iter().flat_map(|block| &block.means);
        for (mean, said) in means.zip(self.said(self.off(numbers)).flatten()) {
            reading.log_likelihoods.push(said.log_likelihood());
            reading.expected.push(said.expected());
            reading.innovations.push(Innovation {
                channel: mean.what.kind(),
                plain: said.plain_m,
                white: said.white,
                ln_scale: said.ln_scale,
                genuine: true,
            });
        }
        reading.observations = reading.innovations.len();
        reading
    }

    fn steps(&self) -> &[Moment] {
        &self.moments
    }

    fn length_s(&self) -> f64 {
        self.seen.length_s
    }

    fn measured(&self) -> Vec<&'static str> {
        MEASURED.to_vec()
    }

    fn directions(&self, _numbers: &[f64], block: &str) -> Vec<Direction> {
        if block != "sensor" {
            return Vec::new();
        }
        let one = |at: usize| (0..NUMBERS).map(|i| if i == at { UNITS[at] } else { 0.0 }).collect();
        (0..NUMBERS).map(one).collect()
    }

    fn channels(&self) -> Vec<Channel> {
        vec![
            Channel { name: "lidar_angle", means: vec![VERTICAL, ASIDE, APART], noise: Vec::new() },
            Channel { name: "lidar_range", means: vec![RANGE, CURVE, CURVE + 1], noise: Vec::new() },
        ]
    }

    fn regimes(&self) -> Vec<Regime> {
        let middle_s = self.seen.blocks[self.seen.blocks.len() / 2].t_s;
        let of = |second: bool| self.moments.iter().map(|it| (it.t_s >= middle_s) == second).collect();
        vec![("the first half of the log", of(false)), ("the second half of the log", of(true))]
    }

    fn held_out_s(&self) -> (f64, f64) {
        (self.seen.block_s, 0.0)
    }
}
