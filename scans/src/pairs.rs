//! How far apart in azimuth pairs of lasers look: lags between what they see.

use asami_math::correlation::{Correlogram, Peak, correlograms, lags_to};

use crate::drive::Drive;

/// Two lasers and how they correlate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairLag {
    /// The lower laser.
    pub a: usize,
    /// The upper laser.
    pub b: usize,
    /// `theta_b - theta_a`, to the step of the firings.
    pub step_angle_rad: f64,
    /// The same to a fraction of a step.
    pub angle_rad: f64,
    /// The peak it was taken from.
    pub peak: Peak,
}

/// Pairs `(l, l + k)` for k from 1 to `reach`, those of the lowest lasers first.
#[must_use]
pub fn pairs(lasers: usize, reach: usize) -> Vec<(usize, usize)> {
    (0..lasers).flat_map(|a| (a + 1..lasers.min(a + reach + 1)).map(move |b| (a, b))).collect()
}

/// The lag of each pair; `None` where the pair has none. Lags up to `most_rad` to both sides; only those at which at least
/// `least_share` of the most firings overlap. Between the steps of the firings only if `sub_step`.
#[must_use]
pub fn pair_lags(
    drive: &Drive<'_>,
    signals: &[Vec<i16>],
    pairs: &[(usize, usize)],
    most_rad: f64,
    least_share: f64,
    sub_step: bool,
) -> Vec<Option<PairLag>> {
    let lags = lags_to(drive.firings_in(most_rad));
    // A peak that lies within the width of an edge of the first is the same one.
    let apart = drive.firings_in(8f64.to_radians()).max(1);
    let slices: Vec<&[i16]> = signals.iter().map(Vec::as_slice).collect();
    let peak = |(correlogram, &(a, b)): (&Correlogram, &(usize, usize))| {
        let peak = Peak::of(correlogram, signals.get(a)?, signals.get(b)?, least_share, apart)?;
        let peak = if sub_step { peak.refined(correlogram, &signals[a], &signals[b]) } else { peak };
        let step = drive.step_rad;
        Some(PairLag { a, b, step_angle_rad: peak.lag as f64 * step, angle_rad: peak.fine_lag() * step, peak })
    };
    correlograms(&slices, pairs, lags).iter().zip(pairs).map(peak).collect()
}
