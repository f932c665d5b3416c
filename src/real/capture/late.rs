//! How much later than they were given commands act, and what is left of motion then.

use asami_dataset::Command;
use asami_math::decomposition::{cholesky, cholesky_solve};

use super::{WINDOW_S, Window};
use crate::real::commanded::Commanded;

/// Delays and lags that are tried.
const MOST_LATE_S: f64 = 0.8;
/// So far apart.
const FINE_S: f64 = 0.01;
/// Where both are free, neither is longer, and they are so far apart.
const MOST_BOTH_S: f64 = 0.4;
const COARSE_S: f64 = 0.02;

/// How commands come to act: so long after they were given, and through a lag of this time constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Late {
    pub(super) delay_s: f64,
    pub(super) lag_s: f64,
}

/// What may be off, beside when.
#[derive(Clone, Copy)]
pub(super) struct Free {
    /// Speeds are in proportion to commanded ones, forward and turning each.
    pub(super) scaled: bool,
    /// Forward speed is lost in turns.
    pub(super) slowed: bool,
    /// And won in slight ones.
    pub(super) quicker: bool,
    /// Turns are in proportion to the way, too.
    pub(super) bent: bool,
}

pub(super) const NOTHING: Free = Free { scaled: false, slowed: false, quicker: false, bent: false };
pub(super) const ALL: Free = Free { scaled: true, slowed: true, quicker: true, bent: true };

/// Commands behind every lag that is tried, the shortest first.
pub(super) struct Lags(Vec<Commanded>);

impl Lags {
    pub(super) fn new(commands: &[Command]) -> Self {
        Self(up_to(MOST_LATE_S, FINE_S).map(|lag_s| Commanded::new(commands, lag_s, MOST_LATE_S)).collect())
    }

    /// The best of a few ways to be late, by squares in units of `scale`; where there is none, of the least that any
    /// of them leaves.
    pub(super) fn best(&self, windows: &[Window], late: &[Late], free: Free, scale: Option<[f64; 2]>) -> Option<Left> {
        let fits: Vec<Left> = late.iter().filter_map(|late| self.fit(windows, *late, free)).collect();
        let scale = scale.unwrap_or_else(|| least_squares_left(fits.iter()));
        fits.into_iter().reduce(|a, b| if b.over(scale) < a.over(scale) { b } else { a })
    }

    pub(super) fn fit(&self, windows: &[Window], late: Late, free: Free) -> Option<Left> {
        Some(fit(self.0.get((late.lag_s / FINE_S).round() as usize)?, windows, late, free))
    }
}

/// What a delay, commands behind a lag and what is free leave of windows.
fn fit(commanded: &Commanded, windows: &[Window], late: Late, free: Free) -> Left {
    let over: Vec<[f64; 4]> =
        windows.iter().map(|window| commanded.over(window.from_s - late.delay_s, WINDOW_S)).collect();
    let squares = |k: usize| over.iter().fold(0.0, |sum, it| sum + it[k] * it[k]);
    let (turns, slows, wins) = (squares(1) > 1e-9, squares(2) > 1e-12, squares(3) > 1e-9);
    let counting =
        |axis: usize| windows.iter().zip(&over).filter(move |(window, _)| window.counts[axis]).map(|(a, b)| (b, a));
    let forwards = counting(0).map(|(it, window)| ([it[0], it[2], it[3]], window.moved(0)));
    let [forward, more, won] = weights(forwards, [free.scaled, free.slowed && slows, free.quicker && wins]);
    let way_m = |it: &[f64; 4]| forward * it[0] + more * it[2] + won * it[3];
    let turned = counting(1).map(|(it, window)| ([it[1], way_m(it)], window.moved(1)));
    let [turn, bend_rad_per_m] = weights(turned, [free.scaled && turns, free.bent]);
    let made = |it: &[f64; 4]| [way_m(it), turn * it[1] + bend_rad_per_m * way_m(it)];
    let off = |(window, it): (&Window, &[f64; 4])| [0, 1].map(|k| window.moved(k) - made(it)[k]);
    let off: Vec<[f64; 2]> = windows.iter().zip(&over).map(off).collect();
    let left = |k: usize| {
        let counting = windows.iter().zip(&off).filter(|(window, _)| window.counts[k]);
        counting.fold(0.0, |sum, (_, off)| sum + off[k] * off[k])
    };
    // A robot that is never told to turn shows nothing of how it turns.
    let shown = |shows: bool, value: f64| if shows { value } else { f64::NAN };
    let (turn, loss_s2, slight_gain) = (shown(turns, turn), shown(slows, -more / forward), shown(wins, won / forward));
    Left { late, forward, turn, loss_s2, slight_gain, bend_rad_per_m, squares: [0, 1].map(left), off }
}

/// Ways to be late that are tried.
pub(super) struct Ways {
    pub(super) delayed: Vec<Late>,
    pub(super) lagged: Vec<Late>,
    pub(super) both: Vec<Late>,
}

impl Ways {
    pub(super) fn all() -> Self {
        let alone = || up_to(MOST_LATE_S, FINE_S);
        let both = || up_to(MOST_BOTH_S, COARSE_S);
        Self {
            delayed: alone().map(|delay_s| Late { delay_s, lag_s: 0.0 }).collect(),
            lagged: alone().map(|lag_s| Late { delay_s: 0.0, lag_s }).collect(),
            both: both().flat_map(|delay_s| both().map(move |lag_s| Late { delay_s, lag_s })).collect(),
        }
    }
}

/// Times from 0 to the greatest.
fn up_to(most_s: f64, apart_s: f64) -> impl Iterator<Item = f64> {
    (0..=(most_s / apart_s).round() as usize).map(move |i| i as f64 * apart_s)
}

/// Weights of columns, by least squares; where it is not free, the first's is 1 and the others' are 0.
fn weights<const N: usize>(rows: impl Iterator<Item = ([f64; N], f64)>, free: [bool; N]) -> [f64; N] {
    // Sums, and no factor by row as in `asami_math::regression`: there are thousands of fits to a thousand windows each.
    let (mut squares, mut products) = (vec![vec![0.0; N]; N], [0.0; N]);
    for (row, y) in rows {
        let y = y - if free[0] { 0.0 } else { row[0] };
        for i in (0..N).filter(|i| free[*i]) {
            products[i] += row[i] * y;
            (0..N).filter(|k| free[*k]).for_each(|k| squares[i][k] += row[i] * row[k]);
        }
    }
    // What is not free, or shows nothing, stays at zero.
    for (k, row) in squares.iter_mut().enumerate().filter(|(k, row)| row[*k] < 1e-24) {
        row[k] = 1.0;
    }
    let solved = cholesky(&squares).map(|l| cholesky_solve(&l, &products));
    let mut found = solved.and_then(|it| it.try_into().ok()).unwrap_or([0.0; N]);
    if !free[0] {
        found[0] = 1.0;
    }
    found
}

/// What is left of ways and turns.
pub(super) struct Left {
    pub(super) late: Late,
    pub(super) forward: f64,
    pub(super) turn: f64,
    pub(super) loss_s2: f64,
    pub(super) slight_gain: f64,
    pub(super) bend_rad_per_m: f64,
    /// Sums of squares.
    pub(super) squares: [f64; 2],
    /// By window.
    pub(super) off: Vec<[f64; 2]>,
}

impl Left {
    /// What is left, ways and turns each in units of what may be left of them.
    pub(super) fn over(&self, scale: [f64; 2]) -> f64 {
        (0..2).map(|k| self.squares[k] / scale[k].max(1e-12)).sum()
    }
}

/// The least that is left of ways, and of turns.
fn least_squares_left<'a>(fits: impl Iterator<Item = &'a Left>) -> [f64; 2] {
    fits.fold([f64::INFINITY; 2], |least, it| [least[0].min(it.squares[0]), least[1].min(it.squares[1])])
}
