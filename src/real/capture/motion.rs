//! Commands and the motion that came of them.

use std::collections::BTreeMap;

use asami_dataset::{Action, Dataset};
use asami_math::statistics::median;

use super::late::{ALL, Free, Lags, Late, Left, NOTHING, Ways};
use super::steady::Proportions;
use super::steps::turn_step;
use super::{Capture, LEAST, OUTLIER, ROUNDS, Together, Window};

/// Between the wheels of a Create.
const BASE_M: f64 = 0.258;

/// What hangs on whether a scale of commands is named.
const SCALE: &str = "command_scale";
const TURNS: &str = "command_scale.theta_ratio";
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
    let (lags, ways) = (Lags::new(commands), Ways::all());
    let Some(found) = counted(&lags, &ways, windows) else { return };
    let late_s = found.late.delay_s + found.late.lag_s;
    let share = turn_step(dataset, late_s);
    capture.values.extend(share.map(|share| ("turn_step.share".to_owned(), share)));
    let told = Told { windows, lags, ways, found, own_lag_s };
    capture.shares = told.shares();
    told.late(capture);
    proportions(&steady.unwrap_or_else(|| told.proportions()), capture);
}

/// What leaves least of windows, where those do not count any more in which a robot does something else altogether.
fn counted(lags: &Lags, ways: &Ways, windows: &mut [Window]) -> Option<Left> {
    for _ in 0..ROUNDS {
        let found = lags.best(windows, &ways.both, ALL, None)?;
        for k in 0..2 {
            let usual = median(&found.off.iter().map(|off| off[k].abs()).collect::<Vec<f64>>()).unwrap_or(0.0);
            windows.iter_mut().zip(&found.off).for_each(|(it, off)| it.counts[k] = off[k].abs() <= OUTLIER * usual);
        }
    }
    lags.best(windows, &ways.both, ALL, None)
}

/// Of a robot that does so in proportion to what it is told.
fn proportions(of: &Proportions, capture: &mut Capture) {
    let Proportions { forward, turn, loss_s2, unscaled_loss_s2, slight_gain, bend_rad_per_m } = of;
    capture.values.extend(shown(&[
        ("command_scale.y_ratio", *forward),
        (TURNS, *turn),
        (BASE, 1.0 / turn),
        (SLOWING, *loss_s2),
        ("slight_turns.gain_share", *slight_gain),
        ("unequal_wheels.ratio", 1.0 + BASE_M * bend_rad_per_m),
    ]));
    // A scale of commands is one of turns, too.
    let scaled = shown(&[(BASE, forward / turn), (TURNS, *forward)]);
    // Of what a robot is ahead of its commands it seems to lose less in turns.
    let unscaled = shown(&[(SLOWING, *unscaled_loss_s2)]);
    capture.together.extend([
        Together { of: &[SCALE, "wheel_base"], values: scaled, without: None },
        Together { of: &["turn_slowing"], values: unscaled, without: Some(SCALE) },
    ]);
}

/// Those that are numbers.
fn shown(values: &[(&str, f64)]) -> BTreeMap<String, f64> {
    values.iter().filter(|it| it.1.is_finite()).map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

/// What a robot was told, what it made of that, and what leaves least of it.
struct Told<'a> {
    windows: &'a [Window],
    lags: Lags,
    ways: Ways,
    found: Left,
    own_lag_s: f64,
}

impl Told<'_> {
    /// How much of what is off each discrepancy explains alone.
    fn shares(&self) -> Vec<(&'static str, f64)> {
        let scale = self.found.squares;
        let off = |late: &[Late], free: Free| {
            let best = self.lags.best(self.windows, late, free, Some(scale));
            best.map_or(f64::INFINITY, |it| it.over(scale))
        };
        let at_once = [Late::default()];
        let (none, least) = (off(&at_once, NOTHING), off(&self.ways.both, ALL));
        let share = |off: f64| ((none - off) / (none - least).max(1e-12)).clamp(0.0, 1.0);
        let mut shares = vec![
            ("scale", share(off(&at_once, Free { scaled: true, ..NOTHING }))),
            ("slowing", share(off(&at_once, Free { slowed: true, ..NOTHING }))),
            ("slight turns", share(off(&at_once, Free { quicker: true, ..NOTHING }))),
            ("bend", share(off(&at_once, Free { bent: true, ..NOTHING }))),
            ("delay", share(off(&self.ways.delayed, NOTHING))),
            ("lag", share(off(&self.ways.lagged, NOTHING))),
        ];
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }

    /// Over all windows.
    fn proportions(&self) -> Proportions {
        let found = &self.found;
        let unscaled = self.lags.fit(self.windows, found.late, Free { scaled: false, ..ALL });
        Proportions {
            forward: found.forward,
            turn: found.turn,
            loss_s2: found.loss_s2,
            unscaled_loss_s2: unscaled.map_or(f64::NAN, |it| it.loss_s2),
            slight_gain: found.slight_gain,
            bend_rad_per_m: found.bend_rad_per_m,
        }
    }

    /// How late commands act, alone and together.
    fn late(&self, capture: &mut Capture) {
        let late = |late: &[Late]| {
            let best = self.lags.best(self.windows, late, ALL, Some(self.found.squares));
            best.map_or(Late::default(), |it| it.late)
        };
        let [delayed, lagged] = [&self.ways.delayed, &self.ways.lagged].map(|ways| late(ways));
        capture.values.append(&mut self.values(delayed.delay_s, lagged.lag_s));
        let both = self.found.late;
        let values = self.values(both.delay_s, both.lag_s);
        capture.together.push(Together { of: &["command_delay", "wheel_lag"], values, without: None });
    }

    /// A delay and a lag, the latter on top of the nominal robot's.
    fn values(&self, delay_s: f64, lag_s: f64) -> BTreeMap<String, f64> {
        shown(&[("command_delay.delay_s", delay_s), ("wheel_lag.lag_s", (lag_s - self.own_lag_s).max(0.0))])
    }
}
