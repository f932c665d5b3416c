//! A scanner's log under hypotheses on its table.

use super::lasers::{Laser, Lasers, Off, Said};
use super::seen::Seen;
use crate::directions::Direction;
use crate::judge::{Channel, Innovation, Judge, Moment, Reading, Regime};
use crate::plant::{Planted, Variant};

/// A response's numbers: variances of single lasers' vertical angles and ranges, where lasers stand, curves of their ranges, louder
/// chance.
const NUMBERS: usize = 9;
const VERTICAL: usize = 0;
const RANGE: usize = 1;
const ASIDE: usize = 2;
const APART: usize = 3;
const CURVE: usize = 4;
const LOUDER: usize = 6;

/// How far an effect that is in nobody's list may move them.
const UNITS: [f64; NUMBERS] = [1e-6, 4e-4, 0.01, 0.03, 0.02, 0.02, 0.5, 0.5, 0.5];

/// What is measured, in the order of [`super::seen::What::kind`].
const MEASURED: [&str; 3] = ["road laser by laser", "walls laser by laser", "sides laser by laser"];

/// A log that tells how likely it is under a table of the lasers.
pub struct Table {
    seen: Seen,
    moments: Vec<Moment>,
}

impl Table {
    /// A log that was seen.
    #[must_use]
    pub fn new(seen: Seen) -> Self {
        let moments = seen.blocks.iter().map(|block| Moment { t_s: block.t_s, seen: block.means.len() }).collect();
        Self { seen, moments }
    }

    /// What each laser is off by, with these effects.
    #[must_use]
    pub fn lasers(&self, planted: &[Planted]) -> Vec<Laser> {
        let mut lasers = Lasers::new(&self.seen, off(&self.numbers(planted)));
        for block in &self.seen.blocks {
            lasers.take(block);
        }
        lasers.known()
    }
}

fn off(numbers: &[f64]) -> Off {
    Off {
        vertical_rad2: numbers[VERTICAL].max(0.0),
        range_m2: numbers[RANGE].max(0.0),
        aside_m: numbers[ASIDE],
        apart_m: numbers[APART],
        range_curve_m: [numbers[CURVE], numbers[CURVE + 1]],
        louder: [0, 1, 2].map(|kind| numbers[LOUDER + kind]),
    }
}

/// Where a response's numbers change with an effect's parameter, and whether by its square; what is not here does not show.
fn shows(effect: &str, parameter: &str) -> Option<(usize, bool)> {
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
        let mut lasers = Lasers::new(&self.seen, off(numbers));
        let mut reading = Reading::default();
        for block in &self.seen.blocks {
            let lost = || Said { log_likelihood: f64::NEG_INFINITY, expected: 0.0, off: Vec::new() };
            let said = lasers.take(block).unwrap_or_else(lost);
            reading.log_likelihoods.push(said.log_likelihood);
            reading.expected.push(said.expected);
            let innovation = |(mean, [plain, white, ln_scale]): (&super::seen::Mean, &[f64; 3])| Innovation {
                channel: mean.what.kind(),
                plain: *plain,
                white: *white,
                ln_scale: *ln_scale,
                genuine: true,
            };
            reading.innovations.extend(block.means.iter().zip(&said.off).map(innovation));
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
        let range = match block {
            "sensor" => 0..LOUDER,
            "noise" => LOUDER..NUMBERS,
            _ => return Vec::new(),
        };
        let one = |at: usize| (0..NUMBERS).map(|i| if i == at { UNITS[at] } else { 0.0 }).collect();
        range.map(one).collect()
    }

    fn channels(&self) -> Vec<Channel> {
        vec![
            Channel { name: "lidar_angle", means: vec![VERTICAL, ASIDE, APART], noise: vec![LOUDER, LOUDER + 2] },
            Channel { name: "lidar_range", means: vec![RANGE, CURVE, CURVE + 1], noise: vec![LOUDER + 1] },
        ]
    }

    fn regimes(&self) -> Vec<Regime> {
        let n = self.moments.len();
        vec![
            ("the first half of the log", (0..n).map(|i| 2 * i < n).collect()),
            ("the second half of the log", (0..n).map(|i| 2 * i >= n).collect()),
        ]
    }

    fn held_out_s(&self) -> (f64, f64) {
        (self.seen.block_s, 0.0)
    }
}
