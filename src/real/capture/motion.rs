//! Commands and the motion that came of them.

use asami_dataset::{Action, Command, Dataset};
use asami_math::statistics::median;

use super::steady::Proportions;
use super::{Capture, LEAST, OUTLIER, ROUNDS, Together, WINDOW_S, Window};
use crate::real::commanded::Commanded;

/// Delays and lags that are tried.
const MOST_LATE_S: f64 = 0.8;
/// So far apart.
const FINE_S: f64 = 0.01;
/// Where both are free, neither is longer, and they are so far apart.
const MOST_BOTH_S: f64 = 0.4;
const COARSE_S: f64 = 0.02;
/// Between the wheels of a Create.
const BASE_M: f64 = 0.258;

/// How commands come to act: so long after they were given, and through a lag of this time constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Late {
    delay_s: f64,
    lag_s: f64,
}

/// What may be off, beside when.
#[derive(Clone, Copy)]
struct Free {
    /// Speeds are in proportion to commanded ones, forward and turning each.
    scaled: bool,
    /// Forward speed is lost in turns.
    slowed: bool,
    /// Turns are in proportion to the way, too.
    bent: bool,
}

const NOTHING: Free = Free { scaled: false, slowed: false, bent: false };
const ALL: Free = Free { scaled: true, slowed: true, bent: true };

/// What a delay and a lag are called that capture shows.
const DELAY: &str = "command_delay.delay_s";
const LAG: &str = "wheel_lag.lag_s";
/// What hangs on whether a scale of commands is named.
const SCALE: &str = "command_scale";
const BASE: &str = "wheel_base.ratio";
const SLOWING: &str = "turn_slowing.loss_s2";

/// Commands behind every lag that is tried, the shortest first.
struct Lags(Vec<Commanded>);

impl Lags {
    fn new(commands: &[Command]) -> Self {
        Self(up_to(MOST_LATE_S, FINE_S).map(|lag_s| Commanded::new(commands, lag_s, MOST_LATE_S)).collect())
    }

    /// The best of a few ways to be late, by squares in units of `scale`; where there is none, of the least that any
    /// of them leaves.
    fn best(&self, windows: &[Window], late: &[Late], free: Free, scale: Option<[f64; 2]>) -> Option<Left> {
        let fits: Vec<Left> = late.iter().filter_map(|late| self.fit(windows, *late, free)).collect();
        let scale = scale.unwrap_or_else(|| least_squares_left(fits.iter()));
        fits.into_iter().reduce(|a, b| if b.over(scale) < a.over(scale) { b } else { a })
    }

    fn fit(&self, windows: &[Window], late: Late, free: Free) -> Option<Left> {
        let commanded = self.0.get((late.lag_s / FINE_S).round() as usize)?;
        let over: Vec<[f64; 3]> =
            windows.iter().map(|window| commanded.over(window.from_s - late.delay_s, WINDOW_S)).collect();
        let squares = |k: usize| over.iter().fold(0.0, |sum, it| sum + it[k] * it[k]);
        let (turns, slows) = (squares(1) > 1e-9, squares(2) > 1e-12);
        let fitted = |axis: usize, of: &dyn Fn(&[f64; 3]) -> [f64; 2], free: [bool; 2]| {
            let counting = windows.iter().zip(&over).filter(|(window, _)| window.counts[axis]);
            weights(counting.map(|(window, it)| (of(it), window.moved(axis))), free)
        };
        let [forward, more] = fitted(0, &|it| [it[0], it[2]], [free.scaled, free.slowed && slows]);
        let way_m = |it: &[f64; 3]| forward * it[0] + more * it[2];
        let [turn, bend_rad_per_m] = fitted(1, &|it| [it[1], way_m(it)], [free.scaled && turns, free.bent]);
        let made = |it: &[f64; 3]| [way_m(it), turn * it[1] + bend_rad_per_m * way_m(it)];
        let off = |(window, it): (&Window, &[f64; 3])| [0, 1].map(|k| window.moved(k) - made(it)[k]);
        let off: Vec<[f64; 2]> = windows.iter().zip(&over).map(off).collect();
        let left = |k: usize| {
            let counting = windows.iter().zip(&off).filter(|(window, _)| window.counts[k]);
            counting.fold(0.0, |sum, (_, off)| sum + off[k] * off[k])
        };
        // A robot that is never told to turn shows nothing of how it turns.
        let shown = |shows: bool, value: f64| if shows { value } else { f64::NAN };
        let (turn, loss_s2) = (shown(turns, turn), shown(slows, -more / forward));
        Some(Left { late, forward, turn, loss_s2, bend_rad_per_m, squares: [0, 1].map(left), off })
    }
}

/// Times from 0 to the greatest.
fn up_to(most_s: f64, apart_s: f64) -> impl Iterator<Item = f64> {
    (0..=(most_s / apart_s).round() as usize).map(move |i| i as f64 * apart_s)
}

/// Weights of two columns, by least squares; where it is not free, the first's is 1 and the second's 0.
pub(super) fn weights(rows: impl Iterator<Item = ([f64; 2], f64)>, free: [bool; 2]) -> [f64; 2] {
    let (mut aa, mut ab, mut bb, mut ay, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for ([a, b], y) in rows {
        (aa, ab, bb, ay, by) = (aa + a * a, ab + a * b, bb + b * b, ay + a * y, by + b * y);
    }
    match free {
        [true, true] => {
            let determinant = (aa * bb - ab * ab).max(1e-24);
            [(ay * bb - by * ab) / determinant, (by * aa - ay * ab) / determinant]
        }
        [true, false] => [ay / aa.max(1e-12), 0.0],
        [false, true] => [1.0, (by - ab) / bb.max(1e-12)],
        [false, false] => [1.0, 0.0],
    }
}

/// What is left of ways and turns.
struct Left {
    late: Late,
    forward: f64,
    turn: f64,
    loss_s2: f64,
    bend_rad_per_m: f64,
    /// Sums of squares.
    squares: [f64; 2],
    /// By window.
    off: Vec<[f64; 2]>,
}

impl Left {
    /// What is left, ways and turns each in units of what may be left of them.
    fn over(&self, scale: [f64; 2]) -> f64 {
        (0..2).map(|k| self.squares[k] / scale[k].max(1e-12)).sum()
    }
}

/// The least that is left of ways, and of turns.
fn least_squares_left<'a>(fits: impl Iterator<Item = &'a Left>) -> [f64; 2] {
    fits.fold([f64::INFINITY; 2], |least, it| [least[0].min(it.squares[0]), least[1].min(it.squares[1])])
}

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
    let delayed = up_to(MOST_LATE_S, FINE_S).map(|delay_s| Late { delay_s, lag_s: 0.0 }).collect::<Vec<Late>>();
    let lagged = up_to(MOST_LATE_S, FINE_S).map(|lag_s| Late { delay_s: 0.0, lag_s }).collect::<Vec<Late>>();
    let both = || up_to(MOST_BOTH_S, COARSE_S);
    let both: Vec<Late> = both().flat_map(|delay_s| both().map(move |lag_s| Late { delay_s, lag_s })).collect();
    for _ in 0..ROUNDS {
        let Some(found) = lags.best(windows, &both, ALL, None) else { return };
        for k in 0..2 {
            let usual = median(&found.off.iter().map(|off| off[k].abs()).collect::<Vec<f64>>()).unwrap_or(0.0);
            windows.iter_mut().zip(&found.off).for_each(|(it, off)| it.counts[k] = off[k].abs() <= OUTLIER * usual);
        }
    }
    let windows = &*windows;
    let Some(found) = lags.best(windows, &both, ALL, None) else { return };
    let scale = Some(found.squares);
    let off = |late: &[Late], free: Free| {
        lags.best(windows, late, free, scale).map_or(f64::INFINITY, |it| it.over(found.squares))
    };
    let at_once = [Late::default()];
    let (none, least) = (off(&at_once, NOTHING), off(&both, ALL));
    let alone = |late: &[Late], free: Free| ((none - off(late, free)) / (none - least).max(1e-12)).clamp(0.0, 1.0);
    capture.shares = vec![
        ("scale", alone(&at_once, Free { scaled: true, ..NOTHING })),
        ("slowing", alone(&at_once, Free { slowed: true, ..NOTHING })),
        ("bend", alone(&at_once, Free { bent: true, ..NOTHING })),
        ("delay", alone(&delayed, NOTHING)),
        ("lag", alone(&lagged, NOTHING)),
    ];
    capture.shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let own = |lag_s: f64| (lag_s - own_lag_s).max(0.0);
    let [delayed, lagged] =
        [&delayed, &lagged].map(|late| lags.best(windows, late, ALL, scale).map_or(Late::default(), |it| it.late));
    let of_all = || {
        let unscaled = lags.fit(windows, found.late, Free { scaled: false, ..ALL });
        Proportions {
            forward: found.forward,
            turn: found.turn,
            loss_s2: found.loss_s2,
            unscaled_loss_s2: unscaled.map_or(f64::NAN, |it| it.loss_s2),
            bend_rad_per_m: found.bend_rad_per_m,
        }
    };
    let Proportions { forward, turn, loss_s2, unscaled_loss_s2, bend_rad_per_m } = steady.unwrap_or_else(of_all);
    for (name, value) in [
        ("command_scale.y_ratio", forward),
        ("command_scale.theta_ratio", turn),
        (BASE, 1.0 / turn),
        (SLOWING, loss_s2),
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
}
