//! Commands that are taken up once in a cycle: whoever passes them on to the wheels sleeps in between, and the newest one is in force
//! until the next look. A turn that is told for less than a cycle lasts all of one, or none.
//!
//! Nobody writes down when the looks are; a cycle takes as long as it takes, so that their phase wanders. From one sighting of a landmark
//! to the next its bearing turns by as much as the robot does, and that hangs on the phase: a hidden Markov chain
//! ([`asami_math::wandering`]) says at every look how probable each phase is, and with it which command was in force. Where who drives ends
//! turns so long after they were taken up, how long they are told for says when looks are, too (`habits`); but whether there is a cycle at
//! all, and how long it is, is for bearings alone to say.

mod evidence;
mod habits;
mod pictures;

use asami_dataset::{Action, Command, Log};

use super::clock::Told;
use evidence::{Evidence, PHASES};
pub use pictures::dated_like_others;

/// What is taken up acts up to so much later, and times are tried so far apart.
const MOST_LATE_S: f64 = 0.3;
const LATE_APART_S: f64 = 0.02;
/// Least and greatest share of a turn that is made of what is told, and how far apart shares are tried.
const TURNS: [f64; 2] = [0.86, 1.1];
const TURNS_APART: f64 = 0.02;
/// By which shares of a cycle its phase may wander from one to the next, as a standard deviation: where it may by more, cycles of any
/// length are as likely.
const WANDERS: [f64; 3] = [0.0125, 0.025, 0.05];
/// How many times as far off as straight on bearings may be in turns.
const OFFS: [f64; 6] = [0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// A cycle is as long as it is said to be within this share, and lengths are tried by these, coarsely and then finely.
const OFF: f64 = 0.1;
const APART: f64 = 0.01;
const FINELY_APART: f64 = 0.001;
/// Cycles of robots of one make part by no more than this share.
const OTHERS_OFF: f64 = 0.02;
/// Lengths that are this share off the likeliest, and not twice as far from what is said as that may be, show what any cycle makes of
/// the log.
const BESIDE: f64 = 0.05;
/// By how much the cycle is to be likelier than that, and than any delay and lag, in nats.
const LEAST_NATS: f64 = 10.0;
/// Commands as they are taken up are given in steps of this length.
const STEP_S: f64 = 0.05;
/// What is less probable is not given.
const LEAST_SHARE: f64 = 0.01;
/// Commands that part by less are one: m/s and rad/s.
const ALIKE: [f64; 2] = [0.006, 0.03];

/// How commands are taken up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// From one look to the next.
    pub period_s: f64,
    /// From a look to when the wheels do what was taken up.
    pub late_s: f64,
    /// Share of turns that is made.
    pub turns: f64,
    /// By what share of the period a cycle is longer or shorter, as a standard deviation.
    pub wanders: f64,
    /// How far most of what is read of bearings is off.
    pub off_rad: f64,
}

impl Cycle {
    /// About so long, as far as nothing else is known; bearings are off by so much.
    fn about(period_s: f64, off_rad: f64) -> Self {
        Self { period_s, late_s: 0.1, turns: 1.0, wanders: WANDERS[1], off_rad }
    }
}

/// A cycle, and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Heard {
    /// The likeliest.
    pub cycle: Cycle,
    /// By how much it makes bearings likelier than the likeliest delay and lag do, in nats.
    pub nats: f64,
    /// The same of the likeliest cycle of another length.
    pub by_chance_nats: f64,
    /// How probable each phase is, cycle by cycle.
    phases: Vec<[f64; PHASES]>,
}

impl Heard {
    /// Whether the log tells it from a delay and a lag, and from cycles of another length.
    #[must_use]
    pub fn is_told(&self) -> bool {
        self.is_told_of_others() && self.nats >= self.by_chance_nats + LEAST_NATS
    }

    /// Whether it tells it from a delay and a lag. Where others of its make say how long the cycle is, it need not say that again.
    #[must_use]
    pub fn is_told_of_others(&self) -> bool {
        self.nats >= LEAST_NATS
    }

    /// The log so, and the same in words.
    fn told(&self, log: &Log, whose: &str) -> Told {
        let Self { cycle: Cycle { period_s, wanders, .. }, nats, by_chance_nats, .. } = self;
        let said = format!(
            "commands are taken up once in {period_s:.4} s{whose}, give or take {:.4} s: each is given as it was, as far as bearings \
             and how long turns are told for tell ({nats:.0} nats over any delay and lag, cycles of another length {by_chance_nats:.0})",
            period_s * wanders
        );
        Told { log: self.taken_up(log), period_s: Some(*period_s), said }
    }
}

/// The same of a robot whose own log does not tell how long a cycle is, where others of its make have it be so long; `None` where it does not
/// tell that either.
#[must_use]
pub fn taken_up_like_others(log: &Log, of_others_s: f64) -> Option<Told> {
    let heard = heard_within(log, of_others_s, OTHERS_OFF).filter(Heard::is_told_of_others)?;
    Some(heard.told(log, ", as long as others of its make take"))
}

/// The log with its wheels' commands as they were taken up, where it tells when those in cycles of about this length were.
#[must_use]
pub fn taken_up(log: &Log, about_s: f64) -> Told {
    match heard(log, about_s) {
        Some(heard) if heard.is_told() => heard.told(log, ""),
        heard => {
            let why = heard.map_or_else(
                || "too few landmarks are seen in turns".to_owned(),
                |it| {
                    format!(
                        "{:.0} nats over any delay and lag, cycles of another length {:.0}",
                        it.nats, it.by_chance_nats
                    )
                },
            );
            let said = format!(
                "when commands were taken up in cycles of about {about_s} s the log does not tell ({why}): they stay as they were given"
            );
            Told { log: log.clone(), period_s: None, said }
        }
    }
}

/// The likeliest cycle of about this length, by the bearings of a log and its commands to wheels alone; `None` where too few landmarks
/// are seen in turns.
#[must_use]
pub fn heard(log: &Log, about_s: f64) -> Option<Heard> {
    heard_within(log, about_s, OFF)
}

/// The same, by no more than a share of another length.
fn heard_within(log: &Log, about_s: f64, within: f64) -> Option<Heard> {
    if !log.commands.iter().all(|it| matches!(it.action, Action::Wheels { .. })) {
        return None;
    }
    let evidence = Evidence::of(log)?;
    let none = evidence.by_delay_and_lag();
    let (likely, cycle) = settled(&evidence, Cycle::about(about_s, evidence.straight_rad), within);
    let others = spaced(1.0 - 2.0 * OFF, 1.0 + 2.0 * OFF, APART).map(|by| Cycle { period_s: by * about_s, ..cycle });
    let others = others.filter(|it| (it.period_s / cycle.period_s - 1.0).abs() > BESIDE);
    let by_chance = evidence.likeliest(others.collect()).0;
    let found = evidence.by_cycle(&cycle);
    let (nats, by_chance_nats) = (likely - none, by_chance - none);
    Some(Heard { cycle, nats, by_chance_nats, phases: evidence.by_habits(&cycle, found).probable })
}

/// The likeliest cycle near one, no more than a share longer or shorter, and how likely it makes bearings.
fn settled(evidence: &Evidence<'_>, mut cycle: Cycle, within: f64) -> (f64, Cycle) {
    let mut likely = f64::NEG_INFINITY;
    for (off, apart) in [(within, APART), (APART, FINELY_APART)] {
        let late = spaced(0.0, MOST_LATE_S, LATE_APART_S).map(|late_s| Cycle { late_s, ..cycle });
        cycle = evidence.likeliest(late.collect()).1;
        let offs = OFFS.map(|off| Cycle { off_rad: off * evidence.straight_rad, ..cycle });
        cycle = evidence.likeliest(offs.into()).1;
        cycle = evidence.likeliest(WANDERS.map(|wanders| Cycle { wanders, ..cycle }).into()).1;
        let turns = spaced(TURNS[0], TURNS[1], TURNS_APART).map(|turns| Cycle { turns, ..cycle });
        cycle = evidence.likeliest(turns.collect()).1;
        let lengths = spaced(1.0 - off, 1.0 + off, apart).map(|by| Cycle { period_s: by * cycle.period_s, ..cycle });
        (likely, cycle) = evidence.likeliest(lengths.collect());
    }
    (likely, cycle)
}

/// From the least to the greatest.
fn spaced(least: f64, greatest: f64, apart: f64) -> impl Iterator<Item = f64> {
    (0..=((greatest - least) / apart).round() as usize).map(move |i| least + i as f64 * apart)
}

/// A velocity, forward and turning, and how probable it is that it was in force.
type Probable = ([f64; 2], f64);

impl Heard {
    /// The log with its commands as they were taken up: where several are probable, each for its share of a short time, so that whatever
    /// comes of them in proportion to time is what is to be expected.
    fn taken_up(&self, log: &Log) -> Log {
        let (Some(first), Some(last)) = (log.commands.first(), log.commands.last()) else { return log.clone() };
        // The last is taken up within a cycle.
        let steps = ((last.t_s + self.cycle.period_s - first.t_s) / STEP_S) as usize + 1;
        let mut given = vec![*first];
        let mut in_force = first.action.velocity().unwrap_or_default();
        for step in 0..steps {
            let from_s = first.t_s + step as f64 * STEP_S;
            let mut probable = self.probable(&log.commands, from_s + 0.5 * STEP_S);
            // What is in force goes on first.
            let goes_on = probable.iter().position(|it| alike(it.0, in_force)).unwrap_or(0);
            probable[..=goes_on].rotate_right(1);
            let all: f64 = probable.iter().map(|it| it.1).sum();
            let mut t_s = from_s;
            for (velocity, share) in probable {
                if velocity != in_force && t_s > first.t_s {
                    let [v_m_per_s, omega_rad_per_s] = velocity;
                    given.push(Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } });
                    in_force = velocity;
                }
                t_s += STEP_S * share / all;
            }
        }
        Log { commands: given.into(), ..log.clone() }
    }

    /// What may be in force at a time, the most probable first.
    fn probable(&self, commands: &[Command], t_s: f64) -> Vec<Probable> {
        let period_s = self.cycle.period_s;
        let began_s = commands.first().map_or(0.0, |first| first.t_s);
        let cycle = (((t_s - began_s) / period_s) as usize).min(self.phases.len().saturating_sub(1));
        let mut found: Vec<Probable> = Vec::new();
        for (phase, share) in self.phases.get(cycle).into_iter().flatten().enumerate() {
            let looks_s = evidence::looks_s(began_s, period_s, phase);
            let look_s = looks_s + ((t_s - looks_s) / period_s).floor() * period_s;
            let given = commands.partition_point(|it| it.t_s <= look_s).max(1) - 1;
            let taken = commands[given].action.velocity().unwrap_or_default();
            match found.iter_mut().find(|it| alike(it.0, taken)) {
                Some((velocity, of)) => {
                    for k in 0..2 {
                        velocity[k] += share / (*of + share).max(1e-12) * (taken[k] - velocity[k]);
                    }
                    *of += share;
                }
                None => found.push((taken, *share)),
            }
        }
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        let kept = found.iter().filter(|it| it.1 >= LEAST_SHARE).count().max(1);
        found.truncate(kept);
        found
    }
}

fn alike(a: [f64; 2], b: [f64; 2]) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() < ALIKE[k])
}

#[cfg(test)]
mod tests;
