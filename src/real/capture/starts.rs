//! By how much later a robot's speed comes than it goes.
//!
//! Of single stops and starts, for windows over which many commands come and go tell neither.

use asami_dataset::{Command, TruePose};
use asami_sim::effects::slight_turns::is_slight;

use super::robust::{Row, fitted};
use super::steady::Proportions;
use super::window;
use crate::real::commanded::{Commanded, of_a_kind};

/// Told to stand for less it may not come to stand.
const SHORTEST_S: f64 = 0.2;
/// Told to stand for so long it stands in the end.
const RESTS_S: f64 = 0.6;
/// Told to go for so long it has started, and goes as fast as it will.
const GOES_S: f64 = 0.8;
/// And goes so before a stop.
const WENT_S: f64 = 0.4;
/// What is slower is no going, in m/s.
const SLOWEST_M_PER_S: f64 = 0.03;
/// Fewer starts say nothing.
const FEWEST: usize = 5;

/// While it is told to go ahead with one speed, or to stand.
struct Run {
    from_s: f64,
    to_s: f64,
    /// Told with any but slight turns it is of no use.
    speed_m_per_s: Option<f64>,
}

impl Run {
    fn rests(&self) -> bool {
        self.speed_m_per_s == Some(0.0) && self.length_s() >= SHORTEST_S
    }

    fn goes(&self, for_s: f64) -> bool {
        self.speed_m_per_s.is_some_and(|it| it >= SLOWEST_M_PER_S) && self.length_s() >= for_s
    }

    fn length_s(&self) -> f64 {
        self.to_s - self.from_s
    }
}

/// By how much later than it goes its speed comes, in seconds, after what is told. Beyond what it would have made by its proportions the
/// robot makes the way that a stop comes late, at the speed before, and misses that which a start does, at the speed after. `None` of a robot
/// that is hardly ever told to stand.
pub(super) fn late_start(given: &[Command], track: &[TruePose], does: &Proportions) -> Option<f64> {
    let watched = Watched { track, commanded: Commanded::new(given, 0.0, 0.0), does };
    let runs = runs(given);
    let rows: Vec<Row<2>> = runs.windows(3).flat_map(|it| watched.rest(&it[0], &it[1], &it[2])).flatten().collect();
    let starts = rows.iter().filter(|(speeds, _)| speeds[1] != 0.0).count();
    if starts < FEWEST {
        return None;
    }
    let ([_, later_s], _) = fitted(&rows)?;
    Some(later_s)
}

/// What a robot made, and what it should have made.
struct Watched<'a> {
    track: &'a [TruePose],
    commanded: Commanded,
    does: &'a Proportions,
}

impl Watched<'_> {
    /// A stop and a start, each by itself where the robot stands between them.
    fn rest(&self, before: &Run, rest: &Run, after: &Run) -> [Option<Row<2>>; 2] {
        if !rest.rests() {
            return [None; 2];
        }
        let before = before.goes(WENT_S).then(|| self.told_m(rest.from_s - WENT_S, WENT_S) / WENT_S);
        let after = after.goes(GOES_S).then(|| self.told_m(rest.to_s, GOES_S) / GOES_S);
        if rest.length_s() < RESTS_S {
            let both = before.zip(after);
            return [both.and_then(|speeds| self.row(rest.from_s, rest.length_s() + GOES_S, speeds)), None];
        }
        let stop = before.and_then(|speed| self.row(rest.from_s, RESTS_S, (speed, 0.0)));
        [stop, after.and_then(|speed| self.row(rest.to_s, GOES_S, (0.0, speed)))]
    }

    /// What hangs on how late a stop is, and on how much later a start is, from one speed to another; and the way in m that is made beyond
    /// what should be.
    fn row(&self, from_s: f64, length_s: f64, (before, after): (f64, f64)) -> Option<Row<2>> {
        let made = window(self.track, from_s, length_s)?;
        Some(([before - after, -after], made.moved(0) - self.told_m(from_s, length_s)))
    }

    fn told_m(&self, from_s: f64, length_s: f64) -> f64 {
        self.does.way_m(&self.commanded.over(from_s, length_s))
    }
}

/// What is told, by stretches of one speed.
fn runs(commands: &[Command]) -> Vec<Run> {
    let told = |command: &Command| {
        let [v, omega] = command.action.velocity()?;
        (omega == 0.0 || v != 0.0 && is_slight(omega)).then_some(v)
    };
    of_a_kind(commands, told)
        .into_iter()
        .map(|(first, [from_s, to_s])| Run { from_s, to_s, speed_m_per_s: told(first) })
        .collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Seed};
    use asami_sim::effect::Effect as _;
    use asami_sim::effect::Stage;
    use asami_sim::effects::late_start::LateStart;

    use super::*;

    const EXACT: Proportions = Proportions {
        forward: 0.98,
        turn: 1.0,
        loss_s2: 2.5,
        unscaled_loss_s2: 2.5,
        slight_gain: 0.06,
        bend_rad_per_m: 0.0,
    };

    /// Does so after 0.15 s, and starts later by `late`'s; told to stand every `rests`-th time, for half a second or longer, and turns every
    /// fourth.
    fn log(late: &LateStart, rests: usize) -> (Vec<Command>, Vec<TruePose>) {
        let told = |i: usize| match i {
            _ if i.is_multiple_of(rests) => (0.0, 0.0),
            _ if i % 4 == 1 => (0.08, 0.3),
            _ if i % 4 == 2 => (0.07, 0.05),
            _ => (0.1, 0.0),
        };
        let command = |i: usize| {
            let (v_m_per_s, omega_rad_per_s) = told(i);
            // What follows every other rest comes early.
            let early_s = if i % rests == 1 && i / rests % 2 == 1 { 1.2 } else { 0.0 };
            Command { t_s: 1.7 * i as f64 - early_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } }
        };
        let commands: Vec<Command> = (0..120).map(command).collect();
        let Some(Stage::Command(mut stage)) = late.stage(Seed(1).stream("late")) else { panic!("no stage") };
        let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let mut track = vec![pose];
        for i in 0..20_000 {
            let t_s = 0.01 * f64::from(i);
            let at = commands.partition_point(|it| it.t_s <= t_s - 0.15 + 1e-9);
            let done = at.checked_sub(1).map(|at| stage(t_s, commands[at].action));
            let [v, omega] = done.and_then(|it| it.velocity()).unwrap_or_default();
            let won = if is_slight(omega) { 0.06 } else { 0.0 };
            pose.y_m += 0.01 * 0.98 * v * (1.0 + won - 2.5 * omega * omega);
            pose.t_s = t_s + 0.01;
            track.push(pose);
        }
        (commands, track)
    }

    fn shown((given, track): &(Vec<Command>, Vec<TruePose>)) -> Option<f64> {
        late_start(given, track, &EXACT)
    }

    #[test]
    fn starts_are_as_late_as_they_were_made() {
        for start_s in [0.02, 0.12, 0.3] {
            let found = shown(&log(&LateStart { start_s }, 3));
            assert!(found.is_some_and(|it| (it - start_s).abs() < 0.011), "{found:?}, not {start_s}");
        }
    }

    #[test]
    fn a_robot_that_is_hardly_told_to_stand_shows_nothing() {
        let late = LateStart { start_s: 0.2 };
        assert!(shown(&log(&late, 7)).is_some());
        assert_eq!(shown(&log(&late, 40)), None);
    }
}
