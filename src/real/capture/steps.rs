//! What share a robot makes of what slight turns lack of a whole step.
//!
//! Streams of slight turns are short and of many rates, so that no stretch of one rate says it: it is told by turns over windows, beside turns in
//! proportion to what is told and to the way.

use asami_dataset::{Action, Command, Dataset};
use asami_sim::effects::turn_step::lacks_rad_per_s;

use super::robust::{Row, fitted};
use super::{LEAST, window};
use crate::real::commanded::Commanded;

/// Length of a window.
const WINDOW_S: f64 = 3.0;
/// Windows in which less is lacking say nothing of it.
const LACKS_RAD: f64 = 0.01;

/// By commands that act so much later; `None` where slight turns are hardly told.
pub(super) fn turn_step(dataset: &Dataset, late_s: f64) -> Option<f64> {
    let commands = &dataset.log.commands;
    let (first, last) = (commands.first()?, commands.last()?);
    let [turning, lacking] = [&commands[..], &lacking(commands)].map(|it| Commanded::new(it, 0.0, 0.0));
    let n = ((last.t_s - first.t_s) / WINDOW_S) as usize;
    let row = |i: usize| -> Option<Row<3>> {
        let from_s = first.t_s + i as f64 * WINDOW_S;
        let made = window(&dataset.truth.track, from_s + late_s, WINDOW_S)?;
        let [told_rad, lacks_rad] = [&turning, &lacking].map(|it| it.over(from_s, WINDOW_S)[1]);
        Some(([told_rad, lacks_rad, made.moved(0)], made.moved(1)))
    };
    let rows: Vec<Row<3>> = (0..n).filter_map(row).collect();
    let telling = rows.iter().filter(|(x, _)| x[1].abs() >= LACKS_RAD).count();
    if telling < LEAST {
        return None;
    }
    let ([_, share, _], _) = fitted(&rows)?;
    Some(share)
}

/// To turn, at each command, by what that lacks of a whole step.
fn lacking(commands: &[Command]) -> Vec<Command> {
    let lacks = |command: &Command| {
        let [v_m_per_s, omega_rad_per_s] = command.action.velocity()?;
        let omega_rad_per_s = lacks_rad_per_s(v_m_per_s, omega_rad_per_s);
        Some(Command { action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s }, ..*command })
    };
    commands.iter().filter_map(lacks).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Log, TruePose, Truth};
    use asami_math::elementary::sin_cos;

    use super::*;

    /// Turns 0.97 times as fast as told, of slight turns makes a share of what they lack, bends by 0.01 rad/m, and is 0.2 s late.
    fn log(share: f64, most_slight: usize) -> Dataset {
        let told = |i: usize| match i % 7 {
            k if k < most_slight => 0.006 * (i * 5 % 9) as f64 - 0.02,
            k if k < 6 => 0.0,
            _ => 0.4,
        };
        let command = |i: usize| {
            let action = Action::Wheels { id: None, v_m_per_s: 0.07, omega_rad_per_s: told(i) };
            Command { t_s: 0.45 * i as f64, action }
        };
        let commands: Vec<Command> = (0..1400).map(command).collect();
        let mut pose = TruePose { t_s: 0.0, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let mut track = vec![pose];
        for k in 0..63_000 {
            let at = commands.partition_point(|it| it.t_s <= pose.t_s - 0.2 + 1e-9);
            let [v, omega] = at.checked_sub(1).and_then(|at| commands[at].action.velocity()).unwrap_or_default();
            let turned = 0.01 * (0.97 * omega + share * lacks_rad_per_s(v, omega) + 0.01 * v);
            let (sin, cos) = sin_cos(pose.theta_rad + 0.5 * turned);
            (pose.x_m, pose.y_m) = (pose.x_m - 0.01 * v * sin, pose.y_m + 0.01 * v * cos);
            (pose.t_s, pose.theta_rad) = (0.01 * f64::from(k + 1), pose.theta_rad + turned);
            track.push(pose);
        }
        let log = Log { commands: commands.into(), ..Log::default() };
        Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
    }

    #[test]
    fn the_share_that_was_made_is_shown() {
        for share in [0.0, 0.6, 1.0] {
            let found = turn_step(&log(share, 4), 0.2);
            // Of slight turns themselves 0.97 is made as well.
            assert!(found.is_some_and(|it| (it - share).abs() < 0.02), "{found:?}, not {share}");
        }
        assert_eq!(turn_step(&log(1.0, 0), 0.2), None, "no slight turn is told");
    }
}
