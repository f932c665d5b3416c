//! What of a laser's ranges is correlated.

use asami_dataset::firings::RANGE_STEP_M;
use asami_math::correlation::ABSENT;
use asami_math::elementary::ln;

use crate::drive::Drive;

/// Fixed-point units of a logarithm or a scaled inverse range.
const UNITS: f64 = 16_384.0;

/// A function of the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Signal {
    /// The range itself, as published.
    Range,
    /// Its logarithm: a near edge counts as much as a far one.
    LogRange,
    /// Its inverse, of ranges from 2 m on.
    InverseRange,
}

/// What is done to the ranges ahead of correlating them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaping {
    /// The function of the range.
    pub signal: Signal,
    /// A running mean over this angle to both sides is taken off; 0: none is.
    pub high_pass_rad: f64,
    /// What is left is clipped to this much to either side, in nats (of `LogRange`).
    pub clip_nat: f64,
    /// Nearer returns, of the car itself say, are left out.
    pub near_m: f64,
    /// Ranges are clipped to this span: only edges within it are seen.
    pub window_m: Option<(f64, f64)>,
}

impl Shaping {
    /// As published: all returns, as they are.
    #[must_use]
    pub fn published() -> Self {
        Self { signal: Signal::Range, high_pass_rad: 0.0, clip_nat: 0.0, near_m: 0.0, window_m: None }
    }

    /// The signal of one laser, a value per firing. A laser that sits `offset_m` to the counter-clockwise side of
    /// its ray has each return shifted to the firing at which a laser on the axis would have seen it.
    #[must_use]
    pub fn of(&self, drive: &Drive<'_>, laser: usize, offset_m: f64) -> Vec<i16> {
        let Some(ranges) = drive.firings.range_2mm.get(laser) else { return Vec::new() };
        let shifted = if offset_m == 0.0 { None } else { Some(shifted(ranges, -offset_m / drive.step_rad)) };
        let ranges = shifted.as_ref().unwrap_or(ranges);
        let least = (self.near_m / RANGE_STEP_M).clamp(1.0, 65_535.0) as u16;
        if self.signal == Signal::Range && self.high_pass_rad <= 0.0 && self.window_m.is_none() {
            // The whole of a 16-bit range, less 0 for no return, fits a signal.
            let value = |r: u16| if r < least { ABSENT } else { (i32::from(r) - 32_768) as i16 };
            return ranges.iter().map(|r| value(*r)).collect();
        }
        let table = self.table();
        if self.high_pass_rad <= 0.0 {
            return ranges
                .iter()
                .map(|&r| if r < least { ABSENT } else { narrow(table[usize::from(r)] / 3) })
                .collect();
        }
        let around = drive.firings_in(self.high_pass_rad);
        high_passed(ranges, &table, least, around, (self.clip_nat * UNITS) as i64)
    }

    /// The function at every range there is, in fixed point.
    fn table(&self) -> Vec<i32> {
        let (low_m, high_m) = self.window_m.unwrap_or((RANGE_STEP_M, 65_535.0 * RANGE_STEP_M));
        let value = |steps: u16| {
            let range_m = (f64::from(steps.max(1)) * RANGE_STEP_M).max(low_m).min(high_m);
            (UNITS
                * match self.signal {
                    Signal::Range => range_m / 25.0,
                    Signal::LogRange => ln(range_m),
                    Signal::InverseRange => 8.0 / range_m.max(2.0),
                })
            .round() as i32
        };
        (0..=u16::MAX).map(value).collect()
    }
}

fn narrow(value: i32) -> i16 {
    value.clamp(i32::from(ABSENT) + 1, i32::from(i16::MAX)) as i16
}

/// Values less the mean of those within `around` firings, clipped.
fn high_passed(ranges: &[u16], table: &[i32], least: u16, around: usize, clip: i64) -> Vec<i16> {
    let value = |r: u16| (r >= least).then(|| i64::from(table[usize::from(r)]));
    let n = ranges.len();
    let (mut sum, mut count) = (0i64, 0i64);
    let mut add = |i: usize, sign: i64| {
        if let Some(v) = ranges.get(i).and_then(|r| value(*r)) {
            sum += sign * v;
            count += sign;
        }
        (sum, count)
    };
    (0..around.min(n)).for_each(|i| {
        add(i, 1);
    });
    (0..n)
        .map(|i| {
            if let Some(past) = i.checked_sub(around + 1) {
                add(past, -1);
            }
            let (sum, count) = add(i + around, 1);
            value(ranges[i]).map_or(ABSENT, |v| {
                let clip = clip.min(i64::from(i16::MAX));
                (v - sum / count.max(1)).clamp(-clip, clip) as i16
            })
        })
        .collect()
}

/// Returns moved by `offset_steps_m / range` firings, near ones over far ones.
fn shifted(ranges: &[u16], offset_steps_m: f64) -> Vec<u16> {
    let mut moved = vec![0u16; ranges.len()];
    for (i, &r) in ranges.iter().enumerate().filter(|(_, r)| **r > 0) {
        let by = (offset_steps_m / (f64::from(r) * RANGE_STEP_M)).round() as isize;
        if let Some(place) = i.checked_add_signed(by).and_then(|to| moved.get_mut(to))
            && (*place == 0 || r < *place)
        {
            *place = r;
        }
    }
    moved
}
