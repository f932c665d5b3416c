//! Times of firings out of the stamps of packets, and packets such that it works.

use super::payload::FIRINGS;

/// Firings of one laser a second where a capture does not tell (Stronger 2008, section 2.5.2).
const RATE_HZ: f64 = 7800.0;
/// How far a firing of an uneven clock may come back from its time.
const TOLERANCE_NS: f64 = 100.0;

/// A packet's time and how many firings it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    pub ns: u64,
    pub count: usize,
}

impl Stamp {
    /// From one firing of this packet to the next if they fill the time to the next packet.
    fn step_ns(&self, next: &Stamp) -> f64 {
        (next.ns - self.ns) as f64 / self.count as f64
    }
}

/// From one firing to the next, by the packets that are full.
pub(super) fn period_ns(stamps: &[Stamp]) -> f64 {
    let pairs = stamps.windows(2).filter(|pair| pair[0].count == FIRINGS);
    median(pairs.map(|pair| pair[0].step_ns(&pair[1])).collect()).unwrap_or(1e9 / RATE_HZ)
}

/// Whether so much time passes from one packet to the next that others were lost in between.
pub(super) fn is_gap(pair: &[Stamp], period_ns: f64) -> bool {
    pair[0].step_ns(&pair[1]) > 1.5 * period_ns
}

/// The time of each firing, counted from `start_ns`. Stamps do not decrease.
pub(super) fn times_s(stamps: &[Stamp], start_ns: u64) -> Vec<f64> {
    let period_ns = period_ns(stamps);
    let mut times = Vec::with_capacity(stamps.iter().map(|stamp| stamp.count).sum());
    for (i, stamp) in stamps.iter().enumerate() {
        let next = stamps.get(i + 1).map(|next| stamp.step_ns(next));
        let step_ns = next.filter(|step| *step <= 1.5 * period_ns).unwrap_or(period_ns);
        let first_ns = stamp.ns.saturating_sub(start_ns) as f64;
        times.extend((0..stamp.count).map(|j| (first_ns + j as f64 * step_ns) / 1e9));
    }
    times
}

/// Packets whose stamps give back the times of firings, which lie within what a capture can stamp.
pub(super) fn stamps(t_s: &[f64]) -> Vec<Stamp> {
    let period_s = median(t_s.windows(2).map(|pair| pair[1] - pair[0]).collect()).unwrap_or(0.0);
    let mut stamps = Vec::with_capacity(t_s.len().div_ceil(FIRINGS));
    let mut first = 0;
    for (i, t) in t_s.iter().enumerate() {
        let due = t_s[first] + (i - first) as f64 * period_s;
        if i == first + FIRINGS || (t - due).abs() * 1e9 > 0.5 * TOLERANCE_NS {
            stamps.push(Stamp { ns: nanoseconds(t_s[first]), count: i - first });
            first = i;
        }
    }
    if first < t_s.len() {
        stamps.push(Stamp { ns: nanoseconds(t_s[first]), count: t_s.len() - first });
    }
    let off = |(a, b): (&f64, &f64)| (a - b).abs() * 1e9 > TOLERANCE_NS;
    if times_s(&stamps, 0).iter().zip(t_s).any(off) {
        // A firing a packet: every one has its stamp.
        stamps = t_s.iter().map(|t| Stamp { ns: nanoseconds(*t), count: 1 }).collect();
    }
    stamps
}

fn nanoseconds(t_s: f64) -> u64 {
    (t_s * 1e9).round() as u64
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
