//! Commands and the motion that came of them.

use asami_dataset::{Action, Dataset};
use asami_math::statistics::median;

use super::late::{ALL, Free, Lags, Late, NOTHING, Ways};
use super::starts::{self, Started};
use super::steady::Proportions;
use super::{Capture, LEAST, OUTLIER, ROUNDS, Together, Window};

/// Between the wheels of a Create.
const BASE_M: f64 = 0.258;

/// What a delay and a lag are called that capture shows.
const DELAY: &str = "command_delay.delay_s";
const LAG: &str = "wheel_lag.lag_s";
/// And what is beside them where it starts later than it stops.
const START: &str = "late_start";
/// What hangs on whether a scale of commands is named.
const SCALE: &str = "command_scale";
const BASE: &str = "wheel_base.ratio";
const SLOWING: &str = "turn_slowing.loss_s2";

/// What is done in proportion to what is told is `steady`, and that of all windows where there is none.
pub(super) fn motion(
    dataset: &Dataset,
    windows: &mut [Window],
    steady: Option<Proportions>,
    own_lag_s: f64,
    capture: &mut Capture,
) {
    let commands = &dataset.log.commands;
    if windows.len() < LEAST || !commands.iter().any(|it| matches!(it.action, Action::Wheels { .. })) {
        return;
    }
    let lags = Lags::new(commands);
    let ways = Ways::all();
    let both = &ways.both;
    for _ in 0..ROUNDS {
        let Some(found) = lags.best(windows, both, ALL, None) else { return };
        for k in 0..2 {
            let usual = median(&found.off.iter().map(|off| off[k].abs()).collect::<Vec<f64>>()).unwrap_or(0.0);
            windows.iter_mut().zip(&found.off).for_each(|(it, off)| it.counts[k] = off[k].abs() <= OUTLIER * usual);
        }
    }
    let windows = &*windows;
    let Some(found) = lags.best(windows, both, ALL, None) else { return };
    let scale = Some(found.squares);
    let off = |late: &[Late], free: Free| {
        lags.best(windows, late, free, scale).map_or(f64::INFINITY, |it| it.over(found.squares))
    };
    let at_once = [Late::default()];
    let (none, least) = (off(&at_once, NOTHING), off(both, ALL));
    let share = |off: f64| ((none - off) / (none - least).max(1e-12)).clamp(0.0, 1.0);
    let alone = |late: &[Late], free: Free| share(off(late, free));
    capture.shares = vec![
        ("scale", alone(&at_once, Free { scaled: true, ..NOTHING })),
        ("slowing", alone(&at_once, Free { slowed: true, ..NOTHING })),
        ("slight turns", alone(&at_once, Free { quicker: true, ..NOTHING })),
        ("bend", alone(&at_once, Free { bent: true, ..NOTHING })),
        ("delay", alone(&ways.delayed, NOTHING)),
        ("lag", alone(&ways.lagged, NOTHING)),
        ("late start", share(starts::alone(commands, windows, found.squares))),
    ];
    capture.shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let own = |lag_s: f64| (lag_s - own_lag_s).max(0.0);
    let late = |lags: &Lags, late: &[Late]| lags.best(windows, late, ALL, scale).map_or(Late::default(), |it| it.late);
    let [delayed, lagged] = [&ways.delayed, &ways.lagged].map(|ways| late(&lags, ways));
    let of_all = || {
        let unscaled = lags.fit(windows, found.late, Free { scaled: false, ..ALL });
        Proportions {
            forward: found.forward,
            turn: found.turn,
            loss_s2: found.loss_s2,
            unscaled_loss_s2: unscaled.map_or(f64::NAN, |it| it.loss_s2),
            slight_gain: found.slight_gain,
            bend_rad_per_m: found.bend_rad_per_m,
        }
    };
    let Proportions { forward, turn, loss_s2, unscaled_loss_s2, slight_gain, bend_rad_per_m } =
        steady.unwrap_or_else(of_all);
    for (name, value) in [
        ("command_scale.y_ratio", forward),
        ("command_scale.theta_ratio", turn),
        (BASE, 1.0 / turn),
        (SLOWING, loss_s2),
        ("slight_turns.gain_share", slight_gain),
        ("unequal_wheels.ratio", 1.0 + BASE_M * bend_rad_per_m),
        (DELAY, delayed.delay_s),
        (LAG, own(lagged.lag_s)),
    ] {
        if value.is_finite() {
            capture.values.insert(name.to_owned(), value);
        }
    }
    let of_late = [(DELAY, found.late.delay_s), (LAG, own(found.late.lag_s))];
    let scaled = [(BASE, forward / turn), ("command_scale.theta_ratio", forward)];
    let unscaled = [(SLOWING, unscaled_loss_s2)];
    let values = |of: &[(&str, f64)]| {
        let shown = of.iter().filter(|(_, value)| value.is_finite());
        shown.map(|(name, value)| ((*name).to_owned(), *value)).collect()
    };
    capture.together.extend([
        Together { of: &["command_delay", "wheel_lag"], values: values(&of_late), ..Together::default() },
        // A scale of commands is one of turns, too.
        Together { of: &[SCALE, "wheel_base"], values: values(&scaled), ..Together::default() },
        // Of what a robot is ahead of its commands it seems to lose less in turns.
        Together { of: &["turn_slowing"], without: Some(SCALE), values: values(&unscaled) },
    ]);
    let Some(Started { start_s, beside: [delayed, lagged, both] }) =
        starts::started(commands, windows, found.late, found.squares, &ways)
    else {
        return;
    };
    capture.values.insert(format!("{START}.start_s"), start_s);
    let of_late = |delay_s: f64, lag_s: f64| values(&[(DELAY, delay_s), (LAG, own(lag_s))]);
    let beside = |of, values| Together { of, values, ..Together::default() };
    capture.together.extend([
        beside(&[START], of_late(delayed.delay_s, lagged.lag_s)),
        beside(&[START, "command_delay", "wheel_lag"], of_late(both.delay_s, both.lag_s)),
    ]);
}
