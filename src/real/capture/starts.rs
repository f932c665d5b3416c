//! Starts after a rest, which may come later than all else.

use asami_dataset::{Action, Command};

use super::late::{ALL, FINE_S, Free, Lags, Late, MOST_BOTH_S, MOST_LATE_S, NOTHING, Ways, fit, up_to};
use super::{WINDOW_S, Window};
use crate::real::commanded::Commanded;

/// Starts are tried beside delays up to so many steps shorter and longer than the best.
const NEAR: i32 = 10;
/// Fewer say nothing.
const FEWEST: usize = 5;
/// By turns a start is sought beside how late all commands act, and that beside the start.
const TURNS: usize = 3;

/// By how much it starts later than it stops.
pub(super) struct Started {
    pub start_s: f64,
    /// How late all commands act beside that: by a delay, by a lag, by both.
    pub beside: [Late; 3],
}

/// What leaves least of windows, in units of `scale`; `None` where it is hardly ever told to go after it was told to stand.
pub(super) fn started(
    commands: &[Command],
    windows: &[Window],
    mut late: Late,
    scale: [f64; 2],
    ways: &Ways,
) -> Option<Started> {
    if count(commands, windows) < FEWEST {
        return None;
    }
    let (mut start_s, mut lags) = (0.0, Lags::new(commands));
    for _ in 0..TURNS {
        let near = |by: i32| Late { delay_s: late.delay_s + FINE_S * f64::from(by), ..late };
        let delays: Vec<Late> = (-NEAR..=NEAR).map(near).filter(|it| it.delay_s >= 0.0).collect();
        start_s = least(commands, windows, &delays, ALL, scale).0;
        lags = Lags::new(&after_rests(commands, start_s));
        late = lags.best(windows, &ways.both, ALL, Some(scale))?.late;
    }
    let beside = |late: &[Late]| Some(lags.best(windows, late, ALL, Some(scale))?.late);
    Some(Started { start_s, beside: [beside(&ways.delayed)?, beside(&ways.lagged)?, late] })
}

/// What is left where nothing but its starts is late, in units of `scale`.
pub(super) fn alone(commands: &[Command], windows: &[Window], scale: [f64; 2]) -> f64 {
    least(commands, windows, &[Late::default()], NOTHING, scale).1
}

/// How late starts leave least, and how much, beside any of these ways to be late, which are one lag's.
fn least(commands: &[Command], windows: &[Window], late: &[Late], free: Free, scale: [f64; 2]) -> (f64, f64) {
    let lag_s = late.first().map_or(0.0, |late| late.lag_s);
    let left = |start_s: f64| {
        let commanded = Commanded::new(&after_rests(commands, start_s), lag_s, MOST_LATE_S);
        let fits = late.iter().map(|late| fit(&commanded, windows, *late, free).over(scale));
        (start_s, fits.fold(f64::INFINITY, f64::min))
    };
    up_to(MOST_BOTH_S, FINE_S).map(left).fold((0.0, f64::INFINITY), |a, b| if b.1 < a.1 { b } else { a })
}

/// Commands as a robot has them that starts so much later after it was told to stand, but by no more than it was told to stand for
/// ([`asami_sim::effects::late_start`]).
pub(super) fn after_rests(commands: &[Command], start_s: f64) -> Vec<Command> {
    let mut acted = Vec::with_capacity(commands.len());
    let (mut stands_from_s, mut until_s): (Option<f64>, f64) = (None, f64::NEG_INFINITY);
    let mut held: Option<Action> = None;
    for command in commands {
        if let Some(action) = held.take_if(|_| command.t_s >= until_s) {
            acted.push(Command { t_s: until_s, action });
        }
        if stands(command) {
            held = None;
            stands_from_s.get_or_insert(command.t_s);
            acted.push(*command);
            continue;
        }
        if let Some(from_s) = stands_from_s.take() {
            until_s = command.t_s + start_s.min(command.t_s - from_s);
        }
        if command.t_s < until_s {
            held = Some(command.action);
        } else {
            acted.push(*command);
        }
    }
    acted.extend(held.map(|action| Command { t_s: until_s, action }));
    acted
}

/// In how many windows that count it is told to go after it was told to stand.
fn count(commands: &[Command], windows: &[Window]) -> usize {
    let starts: Vec<f64> =
        commands.windows(2).filter(|pair| stands(&pair[0]) && !stands(&pair[1])).map(|pair| pair[1].t_s).collect();
    let within = |window: &&Window| {
        let first = starts.partition_point(|t_s| *t_s < window.from_s);
        window.counts[0] && starts.get(first).is_some_and(|t_s| *t_s < window.from_s + WINDOW_S)
    };
    windows.iter().filter(within).count()
}

fn stands(command: &Command) -> bool {
    command.action.velocity() == Some([0.0; 2])
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Rng, Seed};
    use asami_sim::effect::{Effect, Stage};
    use asami_sim::effects::late_start::LateStart;

    use super::*;

    fn wheels(t_s: f64, v_m_per_s: f64) -> Command {
        Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s: 0.0 } }
    }

    /// As the simulator's effect has it, tick for tick.
    #[test]
    fn starts_are_as_late_as_in_the_simulator() {
        let rng = || -> Rng { Seed(1).stream("starts") };
        let told = [
            (0.0, 0.1),
            (1.0, 0.0),
            (1.5, 0.2),
            (1.55, 0.3),
            (3.0, 0.0),
            (3.04, 0.1),
            (4.0, 0.0),
            (4.5, 0.0),
            (5.0, 0.1),
            (5.1, 0.0),
            (5.15, 0.2),
            (6.0, 0.0),
            (9.0, 0.2),
        ];
        let commands: Vec<Command> = told.iter().map(|(t_s, v)| wheels(*t_s, *v)).collect();
        let acted = after_rests(&commands, 0.2);
        let Some(Stage::Command(mut stage)) = (LateStart { start_s: 0.2 }).stage(rng()) else {
            panic!("it has a stage")
        };
        let at = |commands: &[Command], t_s: f64| {
            commands.iter().take_while(|it| it.t_s <= t_s + 5e-7).last().map(|it| it.action)
        };
        for tick in 0..1000 {
            let t_s = 0.01 * f64::from(tick);
            let expected = at(&commands, t_s).map(|action| stage(t_s, action));
            assert_eq!(
                at(&acted, t_s).and_then(|it| it.velocity()),
                expected.and_then(|it| it.velocity()),
                "at {t_s} s"
            );
        }
        assert_eq!(after_rests(&commands, 0.0), commands);
    }
}
