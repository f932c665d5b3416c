//! How far each laser sits off the axis, to the side of its ray: near edges are seen at another angle than far ones.
//!
//! A laser that sits `o` to the counter-clockwise side sees what is at range `r` along `theta + o / r`. Correlated within windows of range,
//! the lag of a pair is a straight line in `1 / r`, with the difference of the two offsets as its slope.

use asami_dataset::firings::RANGE_STEP_M;
use asami_math::correlation::ABSENT;

use crate::drive::Drive;
use crate::pairs::{pair_lags, pairs};
use crate::sensor::Sensor;
use crate::signal::Shaping;

/// What is taken for known of the offsets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offsets {
    /// All lasers sit on the axis, as published.
    None,
    /// By turns on either side, all as far; how far is learned.
    Alternating,
    /// All as far to either side; which on which, and how far, are learned.
    Sides,
}

/// Windows of range, metres: wide enough for edges, narrow enough to tell near from far.
const WINDOWS_M: [(f64, f64); 6] = [(2.5, 5.0), (4.0, 7.0), (5.5, 10.0), (8.0, 15.0), (12.0, 25.0), (20.0, 80.0)];

/// Lags farther than this from what all ranges together say are of other edges.
const ASTRAY_RAD: f64 = 0.03;

/// The slope of a pair's lags over inverse range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// The lower laser.
    pub a: usize,
    /// The upper laser.
    pub b: usize,
    /// Offset of `b` less that of `a`.
    pub slope_m: f64,
    /// How much it counts.
    pub weight: f64,
}

/// Slopes of pairs up to `reach` lasers apart, about the angles that all ranges together gave.
#[must_use]
pub fn slopes(sensor: &Sensor, drive: &Drive<'_>, angles_rad: &[f64], reach: usize) -> Vec<Slope> {
    let pairs = pairs(drive.lasers(), reach);
    let windows: Vec<_> = WINDOWS_M
        .iter()
        .map(|&(near_m, far_m)| {
            let shaping = Shaping { near_m, window_m: Some((near_m, far_m)), ..sensor.shaping };
            let signals = sensor.signals(drive, &shaping, &[]);
            let lags = pair_lags(drive, &signals, &pairs, sensor.most_lag_rad, sensor.least_share, true);
            let inverse: Vec<Option<f64>> = signals
                .iter()
                .enumerate()
                .map(|(laser, signal)| edge_inverse(&sensor.sampled(drive, &drive.firings.range_2mm[laser], 0), signal))
                .collect();
            (lags, inverse)
        })
        .collect();
    let slope = |(i, &(a, b)): (usize, &(usize, usize))| {
        let rows: Vec<[f64; 3]> = windows
            .iter()
            .filter_map(|(lags, inverse)| {
                let lag = lags[i]?;
                let off_rad = lag.angle_rad - (angles_rad[b] - angles_rad[a]);
                let near = off_rad.abs() < ASTRAY_RAD && lag.peak.coefficient > 0.1;
                // Error of a peak: what is left unexplained, over how sharp the peak is.
                let weight = lag.peak.curvature / (1.0 - lag.peak.coefficient * lag.peak.coefficient).max(1e-3);
                near.then_some([(inverse[a]? + inverse[b]?) / 2.0, off_rad, weight.max(1e-6)])
            })
            .collect();
        line(&rows).map(|(slope_m, weight)| Slope { a, b, slope_m, weight })
    };
    pairs.iter().enumerate().filter_map(slope).collect()
}

/// Mean inverse range of the near sides of the edges that a signal holds, each counting as high as it is.
fn edge_inverse(ranges: &[u16], signal: &[i16]) -> Option<f64> {
    let (mut sum, mut weight) = (0.0, 0.0);
    for (r, s) in ranges.windows(2).zip(signal.windows(2)) {
        if s[0] != ABSENT && s[1] != ABSENT && r[0] > 0 && r[1] > 0 {
            let height = (f64::from(s[1]) - f64::from(s[0])).abs();
            sum += height / (f64::from(r[0].min(r[1])) * RANGE_STEP_M);
            weight += height;
        }
    }
    (weight > 0.0).then(|| sum / weight)
}

/// Slope of weighted rows `[x, y, weight]`, and what it weighs; `None` where the rows do not hold it.
fn line(rows: &[[f64; 3]]) -> Option<(f64, f64)> {
    let sum = |of: &dyn Fn(&[f64; 3]) -> f64| rows.iter().fold(0.0, |sum, row| sum + row[2] * of(row));
    let w = sum(&|_| 1.0);
    let (x, y) = (sum(&|row| row[0]) / w, sum(&|row| row[1]) / w);
    let xx = sum(&|row| (row[0] - x) * (row[0] - x));
    let xy = sum(&|row| (row[0] - x) * (row[1] - y));
    (rows.len() >= 3 && xx > 1e-9).then(|| (xy / xx, xx))
}

/// Offsets are believed in if they leave no more than this share of the misfit that lasers on the axis leave.
const TOLD: f64 = 0.35;

/// Offsets of all lasers that fit the slopes best: all as far off, on the sides that `offsets` says or the slopes tell. Zeros where
/// lasers on the axis do about as well.
#[must_use]
pub fn from_slopes(lasers: usize, slopes: &[Slope], offsets: Offsets) -> Vec<f64> {
    let sides = match offsets {
        Offsets::None => return vec![0.0; lasers],
        Offsets::Alternating => (0..lasers).map(|l| if l % 2 == 0 { 1.0 } else { -1.0 }).collect(),
        Offsets::Sides => regular(lasers, slopes),
    };
    let a_m = distance(slopes, &sides);
    let on_axis = misfit(slopes, 0.0, |_| 1.0, None);
    let told = misfit(slopes, a_m, |l| sides[l], None) <= TOLD * on_axis;
    sides.iter().map(|side| if told { side * a_m } else { 0.0 }).collect()
}

/// How far off the axis, if lasers sit on these sides: the weighted median over the pairs with a laser on each.
fn distance(slopes: &[Slope], sides: &[f64]) -> f64 {
    let mut halves: Vec<(f64, f64)> = slopes
        .iter()
        .filter(|slope| sides[slope.a] != sides[slope.b])
        .map(|slope| (slope.slope_m / (sides[slope.b] - sides[slope.a]), slope.weight))
        .collect();
    halves.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = halves.iter().fold(0.0, |sum, row| sum + row.1) / 2.0;
    let mut below = 0.0;
    halves
        .iter()
        .find(|row| {
            below += row.1;
            below >= half
        })
        .map_or(0.0, |row| row.0)
}

/// A pattern that repeats every four lasers or fewer may fit so much worse than free sides, and is still the likelier.
const REGULAR: f64 = 1.2;

/// The sides of all lasers: a pattern that repeats, if one fits about as well as free sides do. Where a laser sees few edges at different
/// ranges, its neighbours' pattern tells more than its own slopes.
fn regular(lasers: usize, slopes: &[Slope]) -> Vec<f64> {
    let cost = |sides: &[f64]| misfit(slopes, distance(slopes, sides), |k| sides[k], None);
    let free = sides(lasers, slopes);
    let mut best = (f64::INFINITY, Vec::new());
    for period in 1..=4usize {
        for pattern in 0..1usize << (period - 1) {
            let side = |l: usize| if pattern >> (l % period) & 1 == 0 { 1.0 } else { -1.0 };
            let sides: Vec<f64> = (0..lasers).map(side).collect();
            let cost = cost(&sides);
            if cost < best.0 {
                best = (cost, sides);
            }
        }
    }
    if best.0 <= REGULAR * cost(&free) { best.1 } else { free }
}

/// The sides on which the slopes put the lasers: from the lowest up by the signs of the slopes, then each laser to the side
/// that the slopes of all its pairs fit better, until none changes. The lowest laser's is 1 or, if that makes the distance negative, the other.
fn sides(lasers: usize, slopes: &[Slope]) -> Vec<f64> {
    let mut sizes: Vec<f64> = slopes.iter().map(|slope| slope.slope_m.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    // Pairs on one side have no slope, those on both twice the distance: the upper quartile is one of the latter.
    let upper = sizes.get(3 * sizes.len() / 4).copied().unwrap_or(0.0);
    let mut best = (f64::INFINITY, vec![1.0; lasers]);
    // How far is not known beforehand: several are tried, and the best fit is kept.
    for a_m in [0.2, 0.35, 0.5, 0.65].map(|share| share * upper) {
        let mut sides = vec![0.0; lasers];
        for _ in 0..20 {
            let before = sides.clone();
            for l in 0..lasers {
                let cost =
                    |side: f64, sides: &[f64]| misfit(slopes, a_m, |k| if k == l { side } else { sides[k] }, Some(l));
                sides[l] = if cost(1.0, &sides) <= cost(-1.0, &sides) { 1.0 } else { -1.0 };
            }
            if sides == before {
                break;
            }
        }
        let a_m = distance(slopes, &sides);
        let cost = misfit(slopes, a_m, |k| sides[k], None);
        if cost < best.0 {
            best = (cost, sides);
        }
    }
    best.1
}

/// Weighted sum of absolute residuals of the pairs of one laser, or of all; of a laser that has no side yet, none.
fn misfit(slopes: &[Slope], a_m: f64, side: impl Fn(usize) -> f64, of: Option<usize>) -> f64 {
    let counts = |slope: &&Slope| {
        of.is_none_or(|l| slope.a == l || slope.b == l) && side(slope.a) != 0.0 && side(slope.b) != 0.0
    };
    let residual = |slope: &Slope| (slope.slope_m - a_m * (side(slope.b) - side(slope.a))).abs();
    slopes.iter().filter(counts).fold(0.0, |sum, slope| sum + slope.weight * residual(slope))
}
