//! Where the world and the log part: channels, by what replacing each alone gains, and the regimes in which
//! it gains most.

use asami_math::elementary::erfc;

use crate::columns::Group;
use crate::diagnosis::{Cell, Kind};
use crate::judge::Judge;
use crate::shape::{Numbers, SPEEDS, Shape, speed_class};

/// Blocks over which gains are taken to be independent.
const BLOCK_S: f64 = 10.0;
/// Channels with less than this share are not named.
const LEAST_SHARE: f64 = 0.05;

/// Nor are cells whose gain may as well be chance.
const LEAST_SURE: f64 = 0.05;

/// A channel, and which of a response's numbers are its own: means and noise.
struct Channel {
    name: &'static str,
    means: Vec<usize>,
    noise: Vec<usize>,
}

fn channels(shape: &Shape) -> Vec<Channel> {
    let columns = &shape.columns;
    let noise = shape.range(Numbers::MotionNoise).start;
    let motion = |axis: usize, groups: &[Group]| -> Vec<usize> {
        let at = axis * columns.len();
        groups.iter().flat_map(|group| columns.range(*group)).map(|i| at + i).collect()
    };
    let own = [Group::Curve, Group::Heading, Group::Held, Group::Wear];
    let axis = |name, axis| Channel {
        name,
        means: motion(axis, &own),
        noise: (0..SPEEDS).map(|class| noise + 3 * class + axis).collect(),
    };
    let all = |group: Numbers| shape.range(group).collect::<Vec<_>>();
    let lingering = (0..3).flat_map(|axis| motion(axis, &[Group::Lingering])).collect();
    vec![
        axis("forward", 1),
        axis("sideways", 0),
        axis("turn", 2),
        Channel { name: "timing", means: lingering, noise: Vec::new() },
        Channel {
            name: if shape.ranges { "range_m" } else { "height_px" },
            means: all(Numbers::Size),
            noise: all(Numbers::SizeNoise),
        },
        Channel { name: "bearing_rad", means: all(Numbers::Bearing), noise: all(Numbers::BearingNoise) },
        Channel {
            name: "detection",
            means: Vec::new(),
            noise: [all(Numbers::False), all(Numbers::Detection)].concat(),
        },
    ]
}

/// Where the response `better` explains more of the log than `base`: the largest share first.
#[must_use]
pub fn places(judge: &Judge<'_>, base: &[f64], better: &[f64]) -> Vec<Cell> {
    let channels = channels(&judge.library.base.shape);
    let mixed = |of: &dyn Fn(usize) -> (bool, bool)| {
        let mut numbers = base.to_vec();
        for (c, channel) in channels.iter().enumerate() {
            let (means, noise) = of(c);
            for i in channel.means.iter().filter(|_| means).chain(channel.noise.iter().filter(|_| noise)) {
                numbers[*i] = better[*i];
            }
        }
        numbers
    };
    let total = |numbers: &[f64]| judge.filtered(numbers).total(0);
    let n = channels.len();
    let gains: Vec<f64> = (0..1_usize << n)
        .map(|set| total(&mixed(&|c| (set >> c & 1 == 1, set >> c & 1 == 1))))
        .map(|it| if it.is_finite() { it } else { f64::MIN / 1e3 })
        .collect();
    let all = gains[gains.len() - 1] - gains[0];
    if all.is_nan() || all <= 0.0 {
        return Vec::new();
    }
    let plain = judge.filtered(base).log_likelihoods;
    let mut cells: Vec<Cell> = Vec::new();
    for (c, channel) in channels.iter().enumerate() {
        let share = shapley(&gains, n, c) / all;
        if share < LEAST_SHARE {
            continue;
        }
        let of_means = total(&mixed(&|it| (it == c, false)));
        let of_noise = total(&mixed(&|it| (false, it == c)));
        let kind = if of_noise > of_means { Kind::Spread } else { Kind::Bias };
        let alone = judge.filtered(&mixed(&|it| (it == c, it == c))).log_likelihoods;
        let gained: Vec<f64> = alone.iter().zip(&plain).map(|(with, without)| with - without).collect();
        cells.push(cell(judge, channel.name, kind, share, &gained));
    }
    cells.retain(|cell| cell.p < LEAST_SURE);
    cells.sort_by(|a, b| b.share.total_cmp(&a.share));
    cells
}

/// A player's value in the game of which `gains` are the coalitions' (Shapley 1953).
fn shapley(gains: &[f64], n: usize, player: usize) -> f64 {
    let factorial = |n: usize| (1..=n).fold(1.0, |product, it| product * it as f64);
    let without = (0..gains.len()).filter(|set| set >> player & 1 == 0);
    without.fold(0.0, |sum, set| {
        let size = set.count_ones() as usize;
        let weight = factorial(size) * factorial(n - size - 1) / factorial(n);
        sum + weight * (gains[set | 1 << player] - gains[set])
    })
}

/// A regime: a name and the steps that it has.
type Regime = (&'static str, Vec<bool>);

fn regimes(judge: &Judge<'_>) -> Vec<Regime> {
    let steps = &judge.view.steps[judge.scored()..];
    let speed = |class: usize| steps.iter().map(|step| speed_class(step.attempt) == class).collect::<Vec<_>>();
    let sign = |axis: usize, sign: f64| steps.iter().map(|step| step.attempt[axis] * sign > 1e-6).collect::<Vec<_>>();
    let mut since_s = 1e9;
    let mut last = [f64::NAN; 3];
    let changed: Vec<f64> = steps
        .iter()
        .map(|step| {
            let same = (0..3).all(|axis| (step.attempt[axis] - last[axis]).abs() < 1e-9);
            since_s = if same { since_s + step.dt_s } else { 0.0 };
            last = step.attempt;
            since_s
        })
        .collect();
    let half = steps.len() / 2;
    vec![
        ("standing", speed(0)),
        ("slow commands", speed(1)),
        ("fast commands", speed(2)),
        ("forward commands", sign(1, 1.0)),
        ("backward commands", sign(1, -1.0)),
        ("turning left", sign(2, 1.0)),
        ("turning right", sign(2, -1.0)),
        ("the first 0.5 s after a command", changed.iter().map(|since_s| *since_s < 0.5).collect()),
        ("the first half of the log", (0..steps.len()).map(|i| i < half).collect()),
        ("the second half of the log", (0..steps.len()).map(|i| i >= half).collect()),
    ]
}

/// The regime in which a channel's gain is most concentrated, with its share's interval.
fn cell(judge: &Judge<'_>, channel: &'static str, kind: Kind, share: f64, gained: &[f64]) -> Cell {
    let blocks = |of: &dyn Fn(usize) -> bool| -> Vec<f64> {
        let steps = &judge.view.steps[judge.scored()..];
        let first_s = steps.first().map_or(0.0, |step| step.t_s);
        let mut sums: Vec<f64> = Vec::new();
        for (i, (step, gained)) in steps.iter().zip(gained).enumerate() {
            let block = ((step.t_s - first_s) / BLOCK_S) as usize;
            if sums.len() <= block {
                sums.resize(block + 1, 0.0);
            }
            if of(i) {
                sums[block] += gained;
            }
        }
        sums
    };
    let everywhere = blocks(&|_| true);
    let all: f64 = everywhere.iter().sum();
    // How far a regime's gain lies above what its share of the time would bring, in standard errors.
    let excess = |(_, of): &Regime| {
        let time = of.iter().filter(|it| **it).count() as f64 / of.len().max(1) as f64;
        let sums = blocks(&|i| of[i]);
        let above: Vec<f64> = sums.iter().zip(&everywhere).map(|(part, whole)| part - time * whole).collect();
        let sum: f64 = above.iter().sum();
        let squares: f64 = above.iter().map(|it| it * it).sum();
        sum / squares.max(1e-12).sqrt()
    };
    let regimes = regimes(judge);
    let best = regimes.iter().map(|regime| (excess(regime), regime)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    // The greatest of ten is beyond 3 by chance about once in 75 logs.
    let (regime, sums) = match best.filter(|(excess, _)| *excess > 3.0) {
        Some((_, (name, of))) => (*name, blocks(&|i| of[i])),
        None => ("everywhere", everywhere),
    };
    let sum: f64 = sums.iter().sum();
    let n = sums.len() as f64;
    let variance = sums.iter().map(|it| (it - sum / n) * (it - sum / n)).sum::<f64>() * n / (n - 1.0).max(1.0);
    let se = variance.sqrt();
    // What the regime gains is never more than its channel's own share, though elsewhere the channel may lose.
    let whole = all.max(sum).max(1e-12);
    let part = share * sum / whole;
    let half_width = share * 1.96 * se / whole;
    let z = sum / se.max(1e-12);
    Cell {
        channel: channel.to_owned(),
        regime: regime.to_owned(),
        kind,
        share: part,
        interval: [part - half_width, part + half_width],
        p: 0.5 * erfc(z / std::f64::consts::SQRT_2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The glove game: a left glove and two right ones; a pair is worth 1.
    #[test]
    fn shapley_values_of_the_glove_game_are_the_textbooks() {
        let worth = |set: usize| f64::from(u8::from(set & 1 == 1 && set & 6 != 0));
        let gains: Vec<f64> = (0..8).map(worth).collect();
        for (player, expected) in [(0, 2.0 / 3.0), (1, 1.0 / 6.0), (2, 1.0 / 6.0)] {
            assert!((shapley(&gains, 3, player) - expected).abs() < 1e-12);
        }
    }
}
