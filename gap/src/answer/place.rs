//! Where the world and the log part: channels, by what replacing each alone gains, and the regimes in which
//! it gains most.

use asami_math::elementary::erfc;

use crate::answer::diagnosis::{Cell, Kind};
use crate::judge::{Judge, Regime};

/// Blocks over which gains are taken to be independent.
const BLOCK_S: f64 = 10.0;
/// Channels with less than this share are not named.
const LEAST_SHARE: f64 = 0.05;

/// Nor are cells whose gain may as well be chance.
const LEAST_SURE: f64 = 0.05;

/// Where the response `better` explains more of the log than `base`: the largest share first.
#[must_use]
pub fn places(judge: &dyn Judge, base: &[f64], better: &[f64]) -> Vec<Cell> {
    let channels = judge.channels();
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
    let total = |numbers: &[f64]| judge.read(numbers).total();
    let n = channels.len();
    let gains: Vec<f64> = (0..1_usize << n)
        .map(|set| total(&mixed(&|c| (set >> c & 1 == 1, set >> c & 1 == 1))))
        .map(|it| if it.is_finite() { it } else { f64::MIN / 1e3 })
        .collect();
    let all = gains[gains.len() - 1] - gains[0];
    if all.is_nan() || all <= 0.0 {
        return Vec::new();
    }
    let plain = judge.read(base).log_likelihoods;
    let mut cells: Vec<Cell> = Vec::new();
    for (c, channel) in channels.iter().enumerate() {
        let share = shapley(&gains, n, c) / all;
        if share < LEAST_SHARE {
            continue;
        }
        let of_means = total(&mixed(&|it| (it == c, false)));
        let of_noise = total(&mixed(&|it| (false, it == c)));
        let kind = if of_noise > of_means { Kind::Spread } else { Kind::Bias };
        let alone = judge.read(&mixed(&|it| (it == c, it == c))).log_likelihoods;
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

/// The regime in which a channel's gain is most concentrated, with its share's interval.
fn cell(judge: &dyn Judge, channel: &'static str, kind: Kind, share: f64, gained: &[f64]) -> Cell {
    let blocks = |of: &dyn Fn(usize) -> bool| -> Vec<f64> {
        let steps = judge.steps();
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
    let regimes = judge.regimes();
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
