//! Commands and the motion that came of them.

use asami_dataset::{Action, Command, Dataset};
use asami_math::elementary::exp;
use asami_math::statistics::median;

use super::{Capture, LEAST, OUTLIER, ROUNDS, STEP_S, WINDOW_S, Window};

/// Delays and lags that are tried.
const MOST_LATE_S: f64 = 0.8;
/// So far apart.
const FINE_S: f64 = 0.01;
/// Between the wheels of a Create.
const BASE_M: f64 = 0.258;

/// Commanded speed and turning rate, every so often from a time on.
struct Commanded {
    from_s: f64,
    /// Integrals from the beginning.
    sums: Vec<[f64; 2]>,
}

/// How commands come to act.
#[derive(Clone, Copy, PartialEq)]
enum Late {
    /// So long after they were given.
    Delay(f64),
    /// Through a lag of this time constant.
    Lag(f64),
}

impl Commanded {
    fn new(commands: &[Command], late: Late) -> Self {
        let (from_s, to_s) = commands.first().zip(commands.last()).map_or((0.0, 0.0), |(a, b)| (a.t_s, b.t_s));
        let steps = ((to_s - from_s + MOST_LATE_S) / STEP_S) as usize + 1;
        let (mut next, mut given, mut acting) = (0, [0.0; 2], [0.0; 2]);
        let mut sums = vec![[0.0; 2]];
        let share = if let Late::Lag(lag_s) = late { 1.0 - exp(-STEP_S / lag_s.max(1e-6)) } else { 1.0 };
        for i in 0..steps {
            let t_s = from_s + (i as f64 + 0.5) * STEP_S - if let Late::Delay(delay_s) = late { delay_s } else { 0.0 };
            while let Some(command) = commands.get(next).filter(|command| command.t_s <= t_s) {
                if let Action::Wheels { v_m_per_s, omega_rad_per_s, .. } = command.action {
                    given = [v_m_per_s, omega_rad_per_s];
                }
                next += 1;
            }
            let last = sums[i];
            for k in 0..2 {
                acting[k] += share * (given[k] - acting[k]);
            }
            sums.push([last[0] + STEP_S * acting[0], last[1] + STEP_S * acting[1]]);
        }
        Self { from_s, sums }
    }

    /// The integrals over a window.
    fn over(&self, from_s: f64) -> [f64; 2] {
        let at = |t_s: f64| {
            let step = ((t_s - self.from_s) / STEP_S).clamp(0.0, self.sums.len() as f64 - 1.0);
            let (i, share) = (step as usize, step.fract());
            let [a, b] = [i, i + 1].map(|i| self.sums[i.min(self.sums.len() - 1)]);
            [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
        };
        let (before, after) = (at(from_s), at(from_s + WINDOW_S));
        [after[0] - before[0], after[1] - before[1]]
    }
}

/// Sums of squares that are left of way and turn: with the speeds in proportion and a turn in proportion to the way where
/// these are free.
struct Left {
    late: Late,
    forward: f64,
    turn: f64,
    bend_rad_per_m: f64,
    squares: [f64; 2],
    /// By window.
    off: Vec<[f64; 2]>,
}

fn fit(commands: &[Command], windows: &[Window], late: Late, [scaled, bent]: [bool; 2]) -> Left {
    let commanded = Commanded::new(commands, late);
    let over: Vec<[f64; 2]> = windows.iter().map(|window| commanded.over(window.from_s)).collect();
    let sum = |k: usize, of: &dyn Fn(usize) -> f64| {
        (0..windows.len()).filter(|i| windows[*i].counts[k]).fold(0.0, |sum, i| sum + of(i))
    };
    let (v, omega) = (|i: usize| over[i][0], |i: usize| over[i][1]);
    let (way, turned) = (|i: usize| windows[i].forward_m, |i: usize| windows[i].turn_rad);
    // Least squares in two unknowns, of which either may be held.
    let (vv, oo, vo) = (sum(1, &|i| v(i) * v(i)), sum(1, &|i| omega(i) * omega(i)), sum(1, &|i| v(i) * omega(i)));
    let (vt, ot) = (sum(1, &|i| v(i) * turned(i)), sum(1, &|i| omega(i) * turned(i)));
    let forward = if scaled { sum(0, &|i| v(i) * way(i)) / sum(0, &|i| v(i) * v(i)).max(1e-12) } else { 1.0 };
    let (turn, bend) = match (scaled, bent) {
        (true, true) => {
            let determinant = (vv * oo - vo * vo).max(1e-18);
            ((ot * vv - vt * vo) / determinant, (vt * oo - ot * vo) / determinant)
        }
        (true, false) => (ot / oo.max(1e-12), 0.0),
        (false, true) => (1.0, (vt - vo) / vv.max(1e-12)),
        (false, false) => (1.0, 0.0),
    };
    let off: Vec<[f64; 2]> =
        (0..windows.len()).map(|i| [way(i) - forward * v(i), turned(i) - turn * omega(i) - bend * v(i)]).collect();
    let squares = [0, 1].map(|k| sum(k, &|i| off[i][k] * off[i][k]));
    // A robot that is never told to turn shows nothing of how it turns.
    let turn = if oo > 1e-9 { turn } else { f64::NAN };
    Left { late, forward, turn, bend_rad_per_m: bend, squares, off }
}

/// The best and the lag and the delay that are best, with everything free, of the windows that count.
fn best_of(commands: &[Command], windows: &[Window], [delays, lags]: [&[Late]; 2]) -> Option<[Left; 2]> {
    let all =
        |late: &[Late]| late.iter().map(|late| fit(commands, windows, *late, [true, true])).collect::<Vec<Left>>();
    let (delayed, lagged) = (all(delays), all(lags));
    let scale = least_squares_left(delayed.iter().chain(&lagged));
    let best = |fits: Vec<Left>| fits.into_iter().reduce(|a, b| if b.over(scale) < a.over(scale) { b } else { a });
    Some([best(delayed)?, best(lagged)?])
}

/// The least that is left of ways, and of turns.
fn least_squares_left<'a>(fits: impl Iterator<Item = &'a Left>) -> [f64; 2] {
    fits.fold([f64::INFINITY; 2], |least, it| [least[0].min(it.squares[0]), least[1].min(it.squares[1])])
}

impl Left {
    /// What is left, ways and turns each in units of what may be left of them.
    fn over(&self, scale: [f64; 2]) -> f64 {
        (0..2).map(|k| self.squares[k] / scale[k].max(1e-12)).sum()
    }
}

pub(super) fn motion(dataset: &Dataset, windows: &mut [Window], own_lag_s: f64, capture: &mut Capture) {
    let commands = &dataset.log.commands;
    if windows.len() < LEAST || !commands.iter().any(|it| matches!(it.action, Action::Wheels { .. })) {
        return;
    }
    let times_s = || (0..=(MOST_LATE_S / FINE_S) as usize).map(|i| i as f64 * FINE_S);
    let (delays, lags): (Vec<Late>, Vec<Late>) =
        (times_s().map(Late::Delay).collect(), times_s().map(Late::Lag).collect());
    for _ in 0..ROUNDS {
        let Some([delayed, lagged]) = best_of(commands, windows, [&delays, &lags]) else { return };
        let scale = least_squares_left([&delayed, &lagged].into_iter());
        let found = if lagged.over(scale) < delayed.over(scale) { lagged } else { delayed };
        for k in 0..2 {
            let usual = median(&found.off.iter().map(|off| off[k].abs()).collect::<Vec<f64>>()).unwrap_or(0.0);
            windows.iter_mut().zip(&found.off).for_each(|(it, off)| it.counts[k] = off[k].abs() <= OUTLIER * usual);
        }
    }
    let windows = &*windows;
    let Some([delayed, lagged]) = best_of(commands, windows, [&delays, &lags]) else { return };
    let at_once = Late::Delay(0.0);
    let scale = least_squares_left([&delayed, &lagged].into_iter());
    let found = if lagged.over(scale) < delayed.over(scale) { &lagged } else { &delayed };
    let off = |it: &Left| it.over(scale);
    let best = |free: [bool; 2], late: &[Late]| {
        let fits = late.iter().map(|late| fit(commands, windows, *late, free));
        fits.reduce(|a, b| if off(&b) < off(&a) { b } else { a })
    };
    let none = fit(commands, windows, at_once, [false, false]);
    let alone = |free: [bool; 2], late: &[Late]| {
        let left = best(free, late).map_or(f64::INFINITY, |it| off(&it));
        ((off(&none) - left) / (off(&none) - off(found)).max(1e-12)).clamp(0.0, 1.0)
    };
    capture.shares = vec![
        ("scale", alone([true, false], &[at_once])),
        ("bend", alone([false, true], &[at_once])),
        ("delay", alone([false, false], &delays)),
        ("lag", alone([false, false], &lags)),
    ];
    capture.shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut value = |name: &str, value: f64| {
        if value.is_finite() {
            capture.values.insert(name.to_owned(), value);
        }
    };
    value("command_scale.y_ratio", found.forward);
    value("command_scale.theta_ratio", found.turn);
    value("wheel_base.ratio", found.forward / found.turn);
    value("unequal_wheels.ratio", 1.0 + BASE_M * found.bend_rad_per_m / found.forward);
    for late in [delayed.late, lagged.late] {
        match late {
            Late::Delay(delay_s) => value("command_delay.delay_s", delay_s),
            Late::Lag(lag_s) => value("wheel_lag.lag_s", (lag_s - own_lag_s).max(0.0)),
        }
    }
}
