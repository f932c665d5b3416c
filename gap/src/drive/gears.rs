//! Which gear a log's car was in, told by its speeds.
//!
//! A car that cruises next to the speed of a change takes one gear or the other by a hair, and stays in it for long: played
//! again it takes the other, and what that leaves of its speeds looks like drag or a dead pedal. So the gears are found once,
//! of plays that change a little earlier and later, and every other play is told them.

use asami_sim::effects::Effects;
use asami_sim::robots::car::drivetrain::Gear;

use super::road::{Play, Ride, Shifts};
use crate::nominal::CannotPlay;

/// The gearbox of each play changes as if the car were so much faster than it was seen to be.
const FASTER_M_PER_S: [f64; 9] = [0.0, -0.06, 0.06, -0.12, 0.12, -0.25, 0.25, -0.5, 0.5];
/// Plays that are in the same gear and part by less agree.
const AGREE_M_PER_S: f64 = 0.02;
/// The times of changes are tried so many of the engine's steps later.
const PROBE_STEPS: isize = 20;
/// And moved by no more at once.
const MOST_STEPS: f64 = 60.0;
/// So often.
const ROUNDS: usize = 3;
/// A change is timed by so many steps of the log.
const SHOWS_IN: usize = 4;
/// No jump counts for more.
const MOST_JUMP_M_PER_S: f64 = 0.2;

/// When a car changes gear, up and down by turns, first up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gears {
    /// Steps of the physics engine.
    changes: Vec<usize>,
    /// With the scanner's clock so far ahead of the commands': it is the scanner who saw them.
    ahead_s: f64,
}

impl Gears {
    /// Those in which a car with `effects` moves most nearly as it was seen to. The scanner's clock is `ahead_s` ahead of
    /// the commands'.
    ///
    /// # Errors
    /// If the car cannot be built.
    pub fn found(ride: &Ride<'_>, effects: &Effects, ahead_s: f64) -> Result<Self, CannotPlay> {
        let one = |faster_m_per_s: &f64| ride.play(effects, ahead_s, Shifts::AsIfFaster(*faster_m_per_s));
        let plays: Vec<Play> = FASTER_M_PER_S.iter().map(one).collect::<Result<_, CannotPlay>>()?;
        let play = |gears: &Self| ride.play(effects, ahead_s, Shifts::Told(gears));
        let mut found = Self::of(&stitched(&plays), ahead_s);
        for _ in 0..ROUNDS {
            let told = play(&found)?;
            let probed = play(&found.moved(&vec![PROBE_STEPS; found.changes.len()]))?;
            let mut by: Vec<isize> = found.changes.iter().map(|at| timed(&told, &probed, *at)).collect();
            let tried = play(&found.moved(&by))?;
            for (by, at) in by.iter_mut().zip(&found.changes) {
                if jumps(&tried, *at) >= jumps(&told, *at) {
                    *by = 0;
                }
            }
            found = found.moved(&by);
        }
        Ok(found)
    }

    fn of(gears: &[Gear], ahead_s: f64) -> Self {
        let before = [Gear::First].iter().chain(gears);
        let changes = before.zip(gears).enumerate().filter(|(_, (before, now))| before != now);
        Self { changes: changes.map(|(at, _)| at).collect(), ahead_s }
    }

    /// Each change later by so many steps of the engine, as far as those before and after it let it.
    fn moved(&self, by: &[isize]) -> Self {
        let mut moved = self.changes.clone();
        for (i, by) in by.iter().enumerate() {
            let earliest = i.checked_sub(1).map_or(0, |before| moved[before] + 1);
            let latest = moved.get(i + 1).map_or(usize::MAX, |after| after - 1);
            moved[i] = moved[i].saturating_add_signed(*by).min(latest).max(earliest);
        }
        Self { changes: moved, ..*self }
    }

    /// By step of the engine, until the last change, with the scanner's clock so far ahead.
    pub(super) fn by_step(&self, ahead_s: f64, time_step_s: f64) -> Vec<Gear> {
        let later = ((self.ahead_s - ahead_s) / time_step_s).round() as isize;
        let changes: Vec<usize> = self.changes.iter().map(|at| at.saturating_add_signed(later)).collect();
        let gear = |at: usize| {
            if changes.partition_point(|change| *change <= at).is_multiple_of(2) { Gear::First } else { Gear::Second }
        };
        (0..=changes.last().copied().unwrap_or(0)).map(gear).collect()
    }
}

impl Play {
    /// By how much what is left of the speed jumps with a step.
    fn jump(&self, i: usize) -> f64 {
        self.left[i][0] - i.checked_sub(1).map_or(0.0, |before| self.left[before][0])
    }

    /// The steps in which a change of gear shows.
    fn after(&self, change: usize) -> std::ops::Range<usize> {
        let first = self.ends.partition_point(|end| *end <= change);
        first..(first + SHOWS_IN).min(self.left.len())
    }

    /// Whether at the end of a step another play is as fast and in the same gear.
    fn agrees(&self, other: &Self, step: usize) -> bool {
        let gear = |play: &Self| play.gears.get(play.ends[step].saturating_sub(1)).copied();
        gear(self) == gear(other) && (self.left[step][0] - other.left[step][0]).abs() < AGREE_M_PER_S
    }
}

/// How much a play's speed jumps where a change of gear shows.
fn jumps(play: &Play, change: usize) -> f64 {
    play.after(change).fold(0.0, |sum, i| sum + play.jump(i) * play.jump(i))
}

/// How much later a change fits best, told by a play in which it was [`PROBE_STEPS`] later: least squares of the jumps.
fn timed(told: &Play, probed: &Play, change: usize) -> isize {
    let (mut both, mut own) = (0.0, f64::MIN_POSITIVE);
    for i in told.after(change) {
        let less = told.jump(i) - probed.jump(i);
        both += less * told.jump(i);
        own += less * less;
    }
    (PROBE_STEPS as f64 * both / own).clamp(-MOST_STEPS, MOST_STEPS).round() as isize
}

/// The gears of the smoothest way through several plays of the same commands.
fn stitched(plays: &[Play]) -> Vec<Gear> {
    let way = smoothest(plays);
    let (ends, all) = (&plays[0].ends, plays[0].gears.len());
    let of = |at: usize| {
        let step = ends.partition_point(|end| *end <= at).min(way.len().saturating_sub(1));
        plays[way.get(step).copied().unwrap_or(0)].gears[at]
    };
    (0..all).map(of).collect()
}

/// By step, of several plays the one to go by for the speeds to part from what was seen with the fewest jumps; from one to another
/// it goes only where they agree (Viterbi 1967).
fn smoothest(plays: &[Play]) -> Vec<usize> {
    let (n, steps) = (plays.len(), plays[0].left.len());
    let jump = |k: usize, i: usize| {
        let jump = plays[k].jump(i).clamp(-MOST_JUMP_M_PER_S, MOST_JUMP_M_PER_S);
        jump * jump
    };
    let mut costs = vec![0.0; n];
    let mut came_from: Vec<Vec<usize>> = Vec::with_capacity(steps);
    let least = |costs: &[f64], a: usize, b: usize| if costs[b] < costs[a] { b } else { a };
    for i in 0..steps {
        let agrees = |k: usize, j: usize| i == 0 || plays[k].agrees(&plays[j], i - 1);
        let from = |k: usize| (0..n).filter(|j| agrees(k, *j)).fold(k, |a, b| least(&costs, a, b));
        let from: Vec<usize> = (0..n).map(from).collect();
        costs = (0..n).map(|k| costs[from[k]] + jump(k, i)).collect();
        came_from.push(from);
    }
    let mut k = (0..n).fold(0, |a, b| least(&costs, a, b));
    let mut way = vec![0; steps];
    for i in (0..steps).rev() {
        way[i] = k;
        k = came_from[i][k];
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speeds left by step, two of the engine's to each, in one gear.
    fn constant(left: &[f64], gear: Gear) -> Play {
        Play {
            left: left.iter().map(|v| [*v, 0.0]).collect(),
            gears: vec![gear; 2 * left.len() + 1],
            ends: (1..=left.len()).map(|i| 2 * i).collect(),
        }
    }

    #[test]
    fn the_way_goes_from_one_play_to_another_where_they_agree() {
        // The first leaps at the third step, the second at the first.
        let mut other = constant(&[0.4, 0.01, 0.0, 0.0], Gear::First);
        let first = constant(&[0.0, 0.0, 0.5, 1.0], Gear::First);
        other.gears[4..].fill(Gear::Second);
        let plays = [first, other];
        assert_eq!(smoothest(&plays), [0, 0, 1, 1]);
        assert_eq!(Gears::of(&stitched(&plays), 0.0).changes, [4]);
    }

    #[test]
    fn plays_that_part_or_are_in_other_gears_are_not_mixed() {
        let plays = [constant(&[0.0, 0.3, 0.3, 0.0], Gear::First), constant(&[0.1, 0.1, 0.1, 0.1], Gear::First)];
        assert_eq!(smoothest(&plays), [1; 4]);
        let plays = [constant(&[0.0, 0.0, 0.5, 1.0], Gear::First), constant(&[0.1, 0.01, 0.0, 0.0], Gear::Second)];
        assert_eq!(smoothest(&plays), [1; 4]);
    }

    #[test]
    fn changes_keep_their_order() {
        let gears = |changes: &[usize]| Gears { changes: changes.to_vec(), ahead_s: 0.5 };
        let some = gears(&[10, 12, 40]);
        assert_eq!(some.moved(&[5, 5, 5]), gears(&[11, 17, 45]));
        assert_eq!(some.moved(&[-20, -9, -60]), gears(&[0, 3, 4]));
        assert_eq!(Gears::of(&some.by_step(0.5, 0.01), 0.5), some);
        assert_eq!(Gears::of(&some.by_step(0.7, 0.1), 0.5), gears(&[8, 10, 38]), "earlier by the commands' clock");
        assert_eq!(Gears::default().by_step(0.0, 0.01), [Gear::First]);
    }
}
