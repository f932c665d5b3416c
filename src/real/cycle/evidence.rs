//! How likely bearings are where commands are taken up in cycles, and where they are not; and when those cycles are.

use asami_dataset::{Command, Log, Sighting};
use asami_math::elementary::ln;
use asami_math::wandering::{Phases, phases};
use rayon::prelude::*;

use super::Cycle;
use super::habits::{Habits, turns};
use crate::real::clock::{Clock, usual};
use crate::real::commanded::Commanded;
use crate::real::pairs::Pair;

/// A cycle is looked at in so many parts.
pub const PHASES: usize = 36;
/// Fewer pairs of sightings in turns show nothing.
const LEAST: usize = 50;
/// A robot that turns by less between two sightings, or might, shows nothing of when it did.
const TURNS_RAD: f64 = 0.01;
/// Where there is no cycle: delays and lags are tried so far apart, and so many besides none.
const LAGS_APART_S: f64 = 0.05;
const LAGS: u8 = 8;
/// Habits are looked at so often at most, and no more where that says less of bearings, in nats.
const ROUNDS: usize = 20;
const SETTLED_NATS: f64 = 0.1;

/// What a log shows.
pub struct Evidence<'a> {
    commands: &'a [Command],
    from_s: f64,
    pairs: Vec<Pair>,
    /// How far most of what is read of bearings is off while the robot goes straight on.
    pub straight_rad: f64,
}

/// Turns by commands that are taken up at looks of one phase.
struct Held {
    looks_s: f64,
    period_s: f64,
    /// Turning rates from each look on, and how far the robot has turned by then.
    looks: Vec<[f64; 2]>,
}

/// A look of a phase, before a log begins.
pub fn looks_s(began_s: f64, period_s: f64, phase: usize) -> f64 {
    began_s + ((phase as f64 + 0.5) / PHASES as f64 - 1.0) * period_s
}

impl Held {
    fn new(commands: &[Command], [from_s, to_s]: [f64; 2], period_s: f64, phase: usize) -> Self {
        let looks_s = looks_s(from_s, period_s, phase);
        let (mut next, mut omega, mut turned) = (0, 0.0, 0.0);
        let look = |n: usize| {
            turned += omega * period_s;
            let look_s = looks_s + n as f64 * period_s;
            while let Some(command) = commands.get(next).filter(|it| it.t_s <= look_s) {
                omega = command.action.velocity().map_or(0.0, |[_, omega]| omega);
                next += 1;
            }
            [omega, turned]
        };
        let looks = (0..=((to_s - looks_s) / period_s) as usize).map(look).collect();
        Self { looks_s, period_s, looks }
    }

    /// How far the robot has turned by a time.
    fn turned_rad(&self, t_s: f64) -> f64 {
        let cycles = ((t_s - self.looks_s) / self.period_s).max(0.0);
        let look = (cycles as usize).min(self.looks.len() - 1);
        let [omega, turned] = self.looks[look];
        turned + omega * (cycles - look as f64) * self.period_s
    }
}

impl<'a> Evidence<'a> {
    /// Of a log; `None` where too little is seen while the robot turns.
    pub fn of(log: &'a Log) -> Option<Self> {
        let commands: &[Command] = &log.commands;
        let (from_s, to_s) = (commands.first()?.t_s, commands.last()?.t_s);
        let within = |pair: &Pair| pair.at_s().iter().all(|t_s| (from_s..to_s).contains(t_s));
        let pairs: Vec<Pair> = Pair::all(log).into_iter().filter(within).collect();
        let turning = Commanded::new(commands, 0.0, 0.0);
        let most_s = f64::from(LAGS) * LAGS_APART_S;
        // Where the robot may turn at all, turns of either side are none.
        let might_turn = |pair: &Pair| {
            let [a_s, b_s] = pair.at_s();
            let turned_rad = |late_s: f64| turning.over(a_s - late_s, b_s - a_s)[1].abs();
            [0.0, 0.25, 0.5, 0.75, 1.0].iter().any(|share| turned_rad(share * most_s) >= TURNS_RAD)
        };
        let (turn, straight): (Vec<Pair>, Vec<Pair>) = pairs.into_iter().partition(might_turn);
        let aside = |pair: &Pair| pair.aside_rad(pair.at_s().map(|t_s| turning.over(t_s - 0.1, 0.1)[0] / 0.1));
        let straight_rad = usual(straight.iter().map(|pair| pair.turned_rad() - aside(pair)));
        (turn.len() >= LEAST && straight.len() >= LEAST).then_some(Self { commands, from_s, pairs: turn, straight_rad })
    }

    /// The same of what was seen if pictures were taken by a clock.
    pub fn seen_by(&self, clock: &Clock) -> Self {
        let taken = |pair: &Pair| Pair { seen: pair.seen.map(|it| Sighting { t_s: clock.taken_s(it.t_s), ..it }) };
        Self { pairs: self.pairs.iter().map(taken).collect(), ..*self }
    }

    fn ends_s(&self) -> [f64; 2] {
        [self.from_s, self.commands.last().map_or(self.from_s, |it| it.t_s)]
    }

    /// By how much a bearing turned, and where the robot goes straight on would have, at speeds of so long before.
    fn turned_rad(&self, pair: &Pair, late_s: f64) -> f64 {
        let speed = |t_s: f64| {
            let given = self.commands.partition_point(|it| it.t_s <= t_s - late_s);
            self.commands[given.max(1) - 1].action.forward_m_per_s().unwrap_or(0.0)
        };
        pair.turned_rad() - pair.aside_rad(pair.at_s().map(speed))
    }

    /// How likely bearings are by the likeliest delay, lag, share of turns and scatter.
    pub fn by_delay_and_lag(&self) -> f64 {
        let ways = (0..=LAGS).flat_map(|lag| (0..=LAGS).map(move |delay| [lag, delay]));
        let of = |way: [u8; 2]| {
            let [lag_s, delay_s] = way.map(|it| f64::from(it) * LAGS_APART_S);
            let turning = Commanded::new(self.commands, lag_s, delay_s);
            let told = |pair: &Pair| {
                let [a_s, b_s] = pair.at_s();
                [self.turned_rad(pair, lag_s + delay_s), turning.over(a_s - delay_s, b_s - a_s)[1]]
            };
            let told: Vec<[f64; 2]> = self.pairs.iter().map(told).collect();
            let by = |turns: f64, off_rad: f64| {
                told.iter().map(|[seen, told]| likely(seen + turns * told, off_rad)).sum::<f64>()
            };
            let turns = super::spaced(super::TURNS[0], super::TURNS[1], super::TURNS_APART);
            let all = turns.flat_map(|turns| super::OFFS.map(|off| by(turns, off * self.straight_rad)));
            all.fold(f64::NEG_INFINITY, f64::max)
        };
        ways.collect::<Vec<_>>().into_par_iter().map(of).reduce(|| f64::NEG_INFINITY, f64::max)
    }

    /// How likely they are by a cycle, and what they say of its phase.
    pub fn by_cycle(&self, cycle: &Cycle) -> Phases<PHASES> {
        phases(&self.of_bearings(cycle), cycle.wanders)
    }

    /// What they say of it together with how long turns are told for, by habits that both show. Without those it is what `found` says.
    pub fn by_habits(&self, cycle: &Cycle, mut found: Phases<PHASES>) -> Phases<PHASES> {
        let turns = turns(self.commands, cycle.period_s);
        let of_bearings = self.of_bearings(cycle);
        for _ in 0..ROUNDS {
            let habits = Habits::learn(&turns, self.from_s, cycle.period_s, &found.probable);
            let mut evidence = of_bearings.clone();
            habits.add(&turns, self.from_s, cycle.period_s, &mut evidence);
            let before = std::mem::replace(&mut found, phases(&evidence, cycle.wanders));
            if (found.log_likelihood - before.log_likelihood).abs() < SETTLED_NATS {
                break;
            }
        }
        found
    }

    /// The logarithm of how likely bearings are, cycle by cycle, at each phase.
    fn of_bearings(&self, cycle: &Cycle) -> Vec<[f64; PHASES]> {
        let Cycle { period_s, late_s, turns, off_rad, .. } = *cycle;
        let ends_s = self.ends_s();
        let held: Vec<Held> = (0..PHASES).map(|phase| Held::new(self.commands, ends_s, period_s, phase)).collect();
        let cycles = ((ends_s[1] - ends_s[0]) / period_s) as usize + 1;
        let mut evidence = vec![[0.0; PHASES]; cycles];
        for pair in &self.pairs {
            let seen = self.turned_rad(pair, late_s + 0.5 * period_s);
            let [a_s, b_s] = pair.at_s().map(|t_s| t_s - late_s);
            let at = (((b_s - self.from_s) / period_s).max(0.0) as usize).min(cycles - 1);
            for (evidence, held) in evidence[at].iter_mut().zip(&held) {
                *evidence += likely(seen + turns * (held.turned_rad(b_s) - held.turned_rad(a_s)), off_rad);
            }
        }
        evidence
    }

    /// The likeliest of several cycles, and how likely it makes bearings.
    pub fn likeliest(&self, cycles: Vec<Cycle>) -> (f64, Cycle) {
        let of = |cycle: Cycle| (self.by_cycle(&cycle).log_likelihood, cycle);
        let all: Vec<(f64, Cycle)> = cycles.into_par_iter().map(of).collect();
        let none = (f64::NEG_INFINITY, Cycle::default());
        all.into_iter().fold(none, |best, it| if it.0 > best.0 { it } else { best })
    }
}

/// By Cauchy's law, whose tails are as long as those of what a camera takes for a mark; most are off by about so much.
fn likely(by_rad: f64, off_rad: f64) -> f64 {
    let by = by_rad / off_rad;
    -ln(1.0 + by * by) - ln(off_rad)
}
