//! What a robot does while it has been told the same for a while.
//!
//! A log says when a command was given, and wheels take it up when they come to it: what is told for less than their cycle lasts a whole
//! one, or none. Where most of what is told is shorter than a log can date, proportions of what is done to what is told are wrong over all
//! of it, and right where the same is told for long. Of slight turns ([`asami_sim::effects::slight_turns`]) one is as good as another: streams of
//! corrections are long, and each of them is short.

use asami_dataset::{Command, Dataset};
use asami_sim::effects::slight_turns::is_slight;

use super::robust::{Row, fitted};
use super::{LEAST, Window, window};
use crate::real::commanded::{Commanded, of_a_kind};

/// What was told for less is done by then.
const SETTLES_S: f64 = 0.7;
/// What is looked at lasts no less.
const SHORTEST_S: f64 = 0.3;
/// Fewer stretches of turns say nothing of turns, and fewer of slight ones nothing of those.
const FEWEST_TURNS: usize = 5;
/// What turns turns by more, in rad/s.
const TURNS_RAD_PER_S: f64 = 0.02;

/// In proportion to what it is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Proportions {
    /// Its speed.
    pub forward: f64,
    /// Its turning rate.
    pub turn: f64,
    /// Share of the speed that is lost at 1 rad/s, in s².
    pub loss_s2: f64,
    /// The same of a robot that goes as fast as it is told where it does not turn.
    pub unscaled_loss_s2: f64,
    /// Share of the speed that is won in slight turns; no number where there are none.
    pub slight_gain: f64,
    /// To the left, in rad/m.
    pub bend_rad_per_m: f64,
}

impl Proportions {
    /// The way forward that it makes of what [`Commanded`] sums, in m.
    pub(super) fn way_m(&self, told: &[f64; 4]) -> f64 {
        let won = if self.slight_gain.is_finite() { self.slight_gain * told[3] } else { 0.0 };
        self.forward * (told[0] - self.loss_s2 * told[2] + won)
    }
}

/// A stretch in which one speed is told, and one turning rate or slight ones.
struct Stretch {
    made: Window,
    /// What [`Commanded`] sums of it.
    told: [f64; 4],
    omega_rad_per_s: f64,
}

/// `None` where too little is told for long.
pub(super) fn steady(dataset: &Dataset) -> Option<Proportions> {
    let stretches = stretches(dataset);
    let (slight, other): (Vec<&Stretch>, Vec<&Stretch>) =
        stretches.iter().partition(|it| is_slight(it.omega_rad_per_s));
    let turning = other.iter().filter(|it| it.omega_rad_per_s.abs() > TURNS_RAD_PER_S).count();
    if other.len() < LEAST || turning < FEWEST_TURNS {
        return None;
    }
    let [forward, more] = of(&other, |it| ([it.told[0], it.told[2]], it.made.moved(0)))?;
    let [unscaled] = of(&other, |it| ([it.told[2]], it.made.moved(0) - it.told[0]))?;
    let won = of(&slight, |it| ([it.told[3]], it.made.moved(0) - forward * it.told[0] - more * it.told[2]));
    let [won] = won.filter(|_| slight.len() >= FEWEST_TURNS).unwrap_or([f64::NAN]);
    let [turn, bend_rad_per_m] = of(&other, |it| ([it.told[1], it.made.moved(0)], it.made.moved(1)))?;
    Some(Proportions {
        forward,
        turn,
        loss_s2: -more / forward,
        unscaled_loss_s2: -unscaled,
        slight_gain: won / forward,
        bend_rad_per_m,
    })
}

fn of<const N: usize>(stretches: &[&Stretch], row: impl Fn(&Stretch) -> Row<N>) -> Option<[f64; N]> {
    Some(fitted(&stretches.iter().map(|it| row(it)).collect::<Vec<_>>())?.0)
}

/// Where the same has been told for long enough, until something else is.
fn stretches(dataset: &Dataset) -> Vec<Stretch> {
    let commands = &dataset.log.commands;
    // One slight turn is as good as another.
    let kind = |command: &Command| {
        let told = command.action.velocity();
        told.map(|[v, omega]| (v, is_slight(omega), if is_slight(omega) { 0.0 } else { omega }))
    };
    let commanded = Commanded::new(commands, 0.0, 0.0);
    let stretch = |(first, [told_s, to_s]): (&Command, [f64; 2])| {
        let from_s = told_s + SETTLES_S;
        let length_s = to_s - from_s;
        let made = if length_s < SHORTEST_S { None } else { window(&dataset.truth.track, from_s, length_s) };
        let [_, omega_rad_per_s] = first.action.velocity()?;
        Some(Stretch { made: made?, told: commanded.over(from_s, length_s), omega_rad_per_s })
    };
    of_a_kind(commands, kind).into_iter().filter_map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Log, TruePose, Truth};
    use asami_math::elementary::sin_cos;

    use super::*;
    use crate::real::capture::capture;

    /// Goes 1.01 times as fast as told, by 0.06 of that faster in slight turns, and loses 2.6 s² in turns, turns 0.97 times as fast; every other command is a burst of a turn
    /// that is told for 0.05 to 0.4 s, and lasts 0.216 s.
    fn bursts(seconds: f64) -> Dataset {
        let (mut told, mut done) = (Vec::new(), Vec::new());
        let (mut t_s, mut i) = (0.0, 0);
        while t_s < seconds {
            let (omega, long_s) = (if i % 5 == 2 { 0.4 } else { 0.0 }, 2.0 + 0.3 * f64::from(i % 4));
            // What follows a slight turn may be another.
            if i % 7 == 3 {
                let slight = (0..10).map(|k| (t_s + 0.2 * f64::from(k), 0.09, 0.01 * f64::from(k % 3) - 0.025));
                told.extend(slight.clone());
                done.extend(slight);
                t_s += 2.0;
            }
            told.push((t_s, 0.09, omega));
            done.push((t_s, 0.09, omega));
            t_s += long_s;
            let burst_s = 0.05 + 0.05 * f64::from(i * 3 % 8);
            told.push((t_s, 0.07, -0.4));
            done.push((t_s, 0.07, -0.4));
            // The next is taken up a whole cycle later.
            told.push((t_s + burst_s, 0.09, 0.0));
            done.push((t_s + 0.216, 0.09, 0.0));
            t_s += 2.0;
            i += 1;
        }
        let wheels = |(t_s, v_m_per_s, omega_rad_per_s): &(f64, f64, f64)| Command {
            t_s: *t_s,
            action: Action::Wheels { id: None, v_m_per_s: *v_m_per_s, omega_rad_per_s: *omega_rad_per_s },
        };
        let commands: Vec<Command> = told.iter().map(wheels).collect();
        let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let mut track = vec![pose];
        for k in 0..(seconds / 0.01) as usize {
            let at = done.partition_point(|it| it.0 <= pose.t_s - 0.2 + 1e-9);
            let (_, v, omega) = at.checked_sub(1).map_or((0.0, 0.0, 0.0), |at| done[at]);
            let won = if is_slight(omega) { 0.06 } else { 0.0 };
            let (v, turned) = (1.01 * v * (1.0 + won - 2.6 * omega * omega), 0.01 * 0.97 * omega);
            let (sin, cos) = sin_cos(pose.theta_rad + 0.5 * turned);
            (pose.x_m, pose.y_m) = (pose.x_m - 0.01 * v * sin, pose.y_m + 0.01 * v * cos);
            (pose.t_s, pose.theta_rad) = (0.01 * (k + 1) as f64, pose.theta_rad + turned);
            track.push(pose);
        }
        let log = Log { commands: commands.into(), ..Log::default() };
        Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
    }

    /// Bursts that a log dates badly make neither a scale nor a wheel base.
    #[test]
    fn what_is_told_for_long_is_told_right() {
        let log = bursts(300.0);
        let found = capture(&log, &log.log.commands, 0.0).values;
        let near = |name: &str, expected: f64, tolerance: f64| {
            let value = found.get(name).copied().unwrap_or(f64::NAN);
            assert!((value - expected).abs() < tolerance, "{name}: {value}, not {expected}: {found:?}");
        };
        near("command_scale.y_ratio", 1.01, 0.002);
        near("turn_slowing.loss_s2", 2.6, 0.03);
        near("slight_turns.gain_share", 0.06, 0.003);
        near("wheel_base.ratio", 1.0 / 0.97, 0.005);
    }

    /// Where nothing is told for long there is nothing to be seen of this.
    #[test]
    fn without_long_commands_nothing_is_shown() {
        let mut short = bursts(300.0);
        let every = |i: usize| {
            let t_s = 0.4 * i as f64;
            Command { t_s, action: Action::Wheels { id: None, v_m_per_s: 0.1, omega_rad_per_s: 0.3 * (i % 3) as f64 } }
        };
        short.log.commands = (0..700).map(every).collect::<Vec<_>>().into();
        assert_eq!(steady(&short), None);
        assert!(steady(&bursts(300.0)).is_some() && steady(&bursts(20.0)).is_none());
    }
}
