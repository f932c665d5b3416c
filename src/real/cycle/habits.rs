//! How long after it was taken up whoever drives has a turn end.
//!
//! Who steers by what the robot does learns of it once in a cycle, and ends a turn so long after the look that took it up: where that was
//! late the turn is told for longer, and it lasts the same. So how long turns are told for says when looks are, as bearings do.

use asami_dataset::Command;
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, exp, hypot, ln, sin_cos};
use asami_sim::effects::slight_turns::is_slight;

use super::evidence::{PHASES, looks_s};
use crate::real::commanded::of_a_kind;

/// Turns that are told for less than this share of a cycle, and pauses in them, are none.
const FLICKERS: f64 = 0.25;
/// Turns last no cycle, one, two, or more.
const LASTS: usize = 4;
/// So many turns are thought of that end whenever, beside those that are there.
const EVENLY: f64 = 20.0;

/// While a turn is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    begins_s: f64,
    ends_s: f64,
}

/// When turns end.
#[derive(Clone, Debug, PartialEq)]
pub struct Habits {
    /// By how much more of them than by chance last so many cycles, as a logarithm.
    lasts: [f64; LASTS],
    /// The same of how many that are taken up end so long after a look.
    ends: [f64; PHASES],
}

/// Turns to one side that are told; slight ones are none.
pub fn turns(commands: &[Command], period_s: f64) -> Vec<Turn> {
    let side = |command: &Command| {
        let omega = command.action.velocity().map_or(0.0, |[_, omega]| if is_slight(omega) { 0.0 } else { omega });
        if omega == 0.0 { 0.0 } else { omega.signum() }
    };
    let mut turns: Vec<(f64, Turn)> = Vec::new();
    for (first, [begins_s, ends_s]) in of_a_kind(commands, side) {
        let side = side(first);
        match turns.last_mut() {
            _ if side == 0.0 => {}
            Some((of, last)) if *of == side && begins_s - last.ends_s < FLICKERS * period_s => last.ends_s = ends_s,
            _ => turns.push((side, Turn { begins_s, ends_s })),
        }
    }
    turns.into_iter().map(|it| it.1).filter(|it| it.ends_s - it.begins_s >= FLICKERS * period_s).collect()
}

impl Turn {
    /// The cycle in which it ends, from a time on.
    fn cycle(&self, began_s: f64, period_s: f64) -> usize {
        ((self.ends_s - began_s) / period_s).max(0.0) as usize
    }

    /// How many cycles it lasts if looks are of this phase, and how long after a look it ends, in parts of a cycle.
    fn lasts(&self, began_s: f64, period_s: f64, phase: usize) -> [usize; 2] {
        let looks_s = looks_s(began_s, period_s, phase);
        let [begins, ends] = [self.begins_s, self.ends_s].map(|t_s| (t_s - looks_s) / period_s);
        let lasts = (ends.floor() - begins.floor()) as usize;
        let after = ((ends - ends.floor()) * PHASES as f64) as usize;
        [lasts.min(LASTS - 1), after.min(PHASES - 1)]
    }
}

impl Habits {
    /// As turns show them where each phase is so probable.
    pub fn learn(turns: &[Turn], began_s: f64, period_s: f64, phases: &[[f64; PHASES]]) -> Self {
        let (mut lasts, mut by_chance) = ([0.0; LASTS], [0.0; LASTS]);
        let (mut x, mut y) = (0.0, 0.0);
        for turn in turns {
            let probable = phases.get(turn.cycle(began_s, period_s));
            for (phase, share) in probable.into_iter().flatten().enumerate() {
                let [cycles, after] = turn.lasts(began_s, period_s, phase);
                lasts[cycles] += share;
                by_chance[cycles] += 1.0 / PHASES as f64;
                if cycles > 0 {
                    let (sin, cos) = sin_cos(angle(after));
                    (x, y) = (x + share * cos, y + share * sin);
                }
            }
        }
        let all: f64 = by_chance.iter().sum();
        let more = |n: usize| {
            let evenly = (EVENLY * by_chance[n] / all).max(1e-9);
            ln((lasts[n] + evenly) / (by_chance[n] + evenly))
        };
        let taken_up: f64 = lasts[1..].iter().sum();
        let (mean, length) = (atan2(y, x), hypot(x, y) / (taken_up + EVENLY));
        Self { lasts: std::array::from_fn(more), ends: von_mises(mean, length) }
    }

    /// Adds what turns say of the phase in each cycle.
    pub fn add(&self, turns: &[Turn], began_s: f64, period_s: f64, evidence: &mut [[f64; PHASES]]) {
        for turn in turns {
            let Some(evidence) = evidence.get_mut(turn.cycle(began_s, period_s)) else { continue };
            let of = |phase: usize| {
                let [cycles, after] = turn.lasts(began_s, period_s, phase);
                self.lasts[cycles] + if cycles > 0 { self.ends[after] } else { 0.0 }
            };
            let said: [f64; PHASES] = std::array::from_fn(of);
            let even = ln(said.iter().map(|it| exp(*it)).sum::<f64>() / PHASES as f64);
            evidence.iter_mut().zip(said).for_each(|(evidence, said)| *evidence += said - even);
        }
    }
}

/// Von Mises' law whose mean is in this direction and so long, in units of what is even, as a logarithm (Banerjee et al. 2005, *Clustering on
/// the unit hypersphere using von Mises-Fisher distributions*, eq. 4.4, on a circle).
fn von_mises(mean: f64, length: f64) -> [f64; PHASES] {
    let concentration = length * (2.0 - length * length) / (1.0 - length * length);
    let more: [f64; PHASES] = std::array::from_fn(|after| concentration * sin_cos(wrap_rad(angle(after) - mean)).1);
    let even = ln(more.iter().map(|it| exp(*it)).sum::<f64>() / PHASES as f64);
    more.map(|it| it - even)
}

/// In the middle of a part of a cycle.
fn angle(after: usize) -> f64 {
    std::f64::consts::TAU * (after as f64 + 0.5) / PHASES as f64
}
