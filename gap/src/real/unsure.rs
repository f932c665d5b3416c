//! What is believed of sizes that were found together, whatever the noise of a real robot is: their laws, and how the log's
//! likelihood bends about where it is greatest, as far as the score of the log scatters from block to block by no more than it
//! should (Huber 1967, White 1982). Where the noise were what it is taken for, it would not; a real log's tails make it.
//!
//! Sizes that make up for one another leave a ridge, along which a likelihood hardly falls until one of them is at the end of its
//! law: the top may be anywhere on it, and says nothing. Of what is believed the middle counts.

use asami_dataset::Seed;

use super::ridge::Ridge;
use crate::judge::Judge;
use crate::plant::Planted;

/// What a real robot and its sensor err by hangs together for seconds, whatever the filter makes of it: what is said of an
/// effect is weighed by blocks of this length.
const BLOCK_S: f64 = 20.0;

/// What is believed of a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Believed {
    /// As probably greater as smaller.
    pub size: f64,
    /// In it with 90 %.
    pub interval: [f64; 2],
}

/// The block in which each step is.
pub fn blocks(judge: &dyn Judge) -> Vec<usize> {
    let numbered = judge.steps().iter().scan((0, None), |(block, before), step| {
        let now = (step.t_s / BLOCK_S).floor();
        *block += usize::from(before.is_some_and(|before| before != now));
        *before = Some(now);
        Some(*block)
    });
    numbered.collect()
}

/// A world that a log may be of.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Its effects, about where the log is likeliest: those that are asked for, and others after them.
    pub effects: Vec<Planted>,
    /// How probable it is beside others, all of which make one.
    pub share: f64,
}

/// What is believed of the sizes of the effects that all these worlds have, the fewest of which the first has.
#[must_use]
pub fn believed(judge: &dyn Judge, worlds: &[World]) -> Vec<Believed> {
    let asked = worlds.iter().map(|world| world.effects.len()).min().unwrap_or(0);
    // Of each size where walks through the worlds come by, with what a step of each counts.
    let mut seen: Vec<Vec<(f64, f64)>> = vec![Vec::new(); asked];
    for world in worlds {
        let Some(ridge) = Ridge::about(judge, &world.effects, blocks(judge)) else { continue };
        let ridge = ridge.looked_at(judge, &world.effects);
        let walked = ridge.walk(Seed(0)).into_iter().zip(&ridge.middle);
        for (seen, (sizes, middle)) in seen.iter_mut().zip(walked) {
            let counts = world.share / sizes.len() as f64;
            seen.extend(sizes.iter().map(|size| (middle * size, counts)));
        }
    }
    let of = |(i, seen): (usize, &mut Vec<(f64, f64)>)| {
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole = seen.iter().fold(0.0, |sum, it| sum + it.1);
        let at = |share: f64| {
            let below = seen.iter().scan(0.0, |below, it| {
                *below += it.1 / whole;
                Some(*below)
            });
            seen.get(below.take_while(|below| *below < share).count().min(seen.len().saturating_sub(1))).map(|it| it.0)
        };
        let law = &worlds[0].effects[i];
        let found = at(0.5).zip(at(0.05)).zip(at(0.95));
        found.map_or(Believed { size: law.size, interval: law.variant.sizes().into() }, |((size, low), high)| {
            Believed { size, interval: [low, high] }
        })
    };
    seen.iter_mut().enumerate().map(of).collect()
}

#[cfg(test)]
mod tests {
    use asami_math::elementary::{exp, ln};

    use super::*;
    use crate::straight::Straight;

    fn alone(effects: &[Planted]) -> [World; 1] {
        [World { effects: effects.to_vec(), share: 1.0 }]
    }

    /// Noise that is three times what it is taken for leaves sizes three times as unsure, alone or beside another.
    #[test]
    fn what_scatters_by_more_than_it_is_taken_to_is_surer_of_nothing() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let truth = kinds.map(|variant| Planted { size: 0.5 * variant.sizes().1, variant });
        let wave = |t: usize, step: f64| 9.0 * (step * t as f64).sin();
        let log = || Straight::new(&truth, &[&|t| wave(t, 0.37), &|t| wave(t, 0.37) + wave(t, 0.91)], Seed(7));
        let (quiet, mut loud) = (log(), log());
        let silent = quiet.numbers(&truth);
        for (t, it) in loud.measured.iter_mut().enumerate() {
            let made = quiet.made(&silent, t);
            *it = made + 3.0 * (*it - made);
        }
        let width = |judge: &dyn Judge| {
            let relative = |it: Believed| (it.interval[1] - it.interval[0]) / it.size;
            believed(judge, &alone(&truth)).into_iter().map(relative).collect::<Vec<f64>>()
        };
        let [quiet_widths, loud_widths] = [width(&quiet), width(&loud)];
        for (i, (quiet, loud)) in quiet_widths.iter().zip(&loud_widths).enumerate() {
            assert!((loud / quiet - 3.0).abs() < 1.2, "{i}: {quiet} {loud}");
        }
        // By the two waves' own squares, were nothing known of the other; a Gaussian's middle 90 % is 3.29 standard deviations.
        let alone = 3.29 / (0.5 * (400.0 * 81.0 / 2.0_f64).sqrt());
        assert!((quiet_widths[1] / alone - 1.0).abs() < 0.35, "{quiet_widths:?} {alone}");
    }

    /// Of a log that tells nothing of a size its law is believed, which is even in the size's logarithm.
    #[test]
    fn what_a_log_says_nothing_of_may_be_anything() {
        let kind = Straight::kind("command_scale");
        let (least, greatest) = kind.sizes();
        let truth = [Planted { size: 0.5 * greatest, variant: kind }];
        let nothing = Straight::new(&truth, &[&|_| 0.0], Seed(1));
        let Believed { size, interval: [low, high] } = believed(&nothing, &alone(&truth))[0];
        for (share, found) in [(0.05, low), (0.5, size), (0.95, high)] {
            let there = ln(found / least) / ln(greatest / least);
            assert!((there - share).abs() < 0.06, "{share}: {there}");
        }
    }

    /// Two effects that act much alike leave a ridge, on which the top is at the end of a law. What is believed of either is what
    /// their laws and the likelihood have there, by quadrature over both.
    #[test]
    fn on_a_ridge_the_middle_of_what_is_likely_counts_and_not_the_top() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |shares: [f64; 2]| {
            [0, 1].map(|k| Planted { size: shares[k] * kinds[k].sizes().1, variant: kinds[k].clone() })
        };
        let alike = |t: usize| 3.0 * (0.37 * t as f64).sin();
        let apart = |t: usize| alike(t) + 0.4 * (0.91 * t as f64).sin();
        let log = Straight::new(&of([0.4, 0.8]), &[&alike, &apart], Seed(3));
        let likely = |shares: [f64; 2]| log.log_likelihood(&of(shares));
        let shares: Vec<f64> = (1..=100).map(|i| f64::from(i) / 100.0).collect();
        let all = || shares.iter().flat_map(|a| shares.iter().map(|b| [*a, *b]));
        let (top, best) =
            all().map(|it| (likely(it), it)).fold((f64::NEG_INFINITY, [0.0; 2]), |a, b| if b.0 > a.0 { b } else { a });
        let found = believed(&log, &alone(&of(best)));
        for (k, found) in found.iter().enumerate() {
            let density = |share: f64| {
                let row = all().filter(|it| {
                    it[k] == share && it.iter().zip(&kinds).all(|(s, kind)| s * kind.sizes().1 >= kind.sizes().0)
                });
                row.fold(0.0, |sum, it| sum + exp(likely(it) - top) / (it[0] * it[1]))
            };
            let densities: Vec<f64> = shares.iter().map(|share| density(*share)).collect();
            let whole: f64 = densities.iter().sum();
            let at = |share: f64| {
                let below = densities.iter().scan(0.0, |below, it| {
                    *below += it / whole;
                    Some(*below)
                });
                shares[below.take_while(|below| *below < share).count().min(shares.len() - 1)]
            };
            let greatest = kinds[k].sizes().1;
            let half = 0.5 * (at(0.95) - at(0.05));
            assert!(
                (found.size / greatest - at(0.5)).abs() < 0.3 * half,
                "{k}: {found:?} {} {half}",
                at(0.5) * greatest
            );
            let width = 0.5 * (found.interval[1] - found.interval[0]) / greatest;
            assert!((0.8..1.5).contains(&(width / half)), "{k}: {width} {half}");
        }
    }
}
