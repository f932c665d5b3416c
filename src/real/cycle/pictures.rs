//! When a camera took its pictures, of a robot whose log does not tell that by itself, where others of its make tell how many a second they
//! take: held against commands as they are taken up, bearings say more of it than where wheels are thought to lag.

use asami_dataset::Log;
use rayon::prelude::*;

use super::evidence::Evidence;
use super::{Cycle, OTHERS_OFF, settled, spaced};
use crate::real::clock::{Clock, FINE, Told};

/// Cameras of a make differ in rate by no more than this share.
const OFF: f64 = 5e-5;
/// The clock and how commands are taken up are looked for by turns, so often.
const ROUNDS: usize = 4;
/// By how much pictures are to be likelier so than as they are dated, in nats, for of some hundred clocks one is the likeliest.
const LEAST_NATS: f64 = 10.0;

/// The log with what was seen dated by when its picture was taken, where bearings tell that of a camera that takes one in `picture_s` and
/// commands that are taken up once in `cycle_s`, as others of its make have it; `None` where they do not.
#[must_use]
pub fn dated_like_others(log: &Log, picture_s: f64, cycle_s: f64) -> Option<Told> {
    let evidence = Evidence::of(log)?;
    let as_dated = settled(&evidence, Cycle::about(cycle_s, evidence.straight_rad), OTHERS_OFF);
    // Pictures are older than they are dated, by half a period in the mean.
    let mut best = (as_dated.0, Cycle { late_s: (as_dated.1.late_s - 0.5 * picture_s).max(0.0), ..as_dated.1 });
    let mut clock = None;
    for _ in 0..ROUNDS {
        let found = likeliest(&evidence, clocks(log, picture_s)?, &best.1)?;
        best = settled(&evidence.seen_by(&found), best.1, OTHERS_OFF);
        clock = Some(found);
    }
    let nats = best.0 - as_dated.0;
    let clock = clock.filter(|_| nats >= LEAST_NATS)?;
    let said = format!(
        "the camera takes {:.4} pictures a second, as fast as others of its make do, by a clock of its own: what was seen is up to {:.1} ms \
         older than it is dated, and is taken back to when it was ({nats:.0} nats by when commands are taken up)",
        1.0 / clock.period_s,
        1e3 * clock.period_s
    );
    Some(Told { log: clock.taken_back(log), period_s: Some(clock.period_s), said })
}

/// All that are tried.
fn clocks(log: &Log, picture_s: f64) -> Option<Vec<Clock>> {
    let (from_s, to_s) = log.span_s()?;
    let apart = (FINE * picture_s / (to_s - from_s)).min(OFF);
    // The middle of the log is where a phase means the same at all rates.
    let middle_s = 0.5 * (from_s + to_s);
    Some(spaced(1.0 - OFF, 1.0 + OFF, apart).flat_map(|by| Clock::of_period(by * picture_s, middle_s)).collect())
}

fn likeliest(evidence: &Evidence<'_>, clocks: Vec<Clock>, cycle: &Cycle) -> Option<Clock> {
    let of = |clock: Clock| (evidence.seen_by(&clock).by_cycle(cycle).log_likelihood, clock);
    let all: Vec<(f64, Clock)> = clocks.into_par_iter().map(of).collect();
    all.into_iter().reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|it| it.1)
}
