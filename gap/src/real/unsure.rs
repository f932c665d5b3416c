//! What is believed of sizes that were found together, whatever the noise of a real robot is: their laws, and the log's likelihood, along
//! which a random walk is led, as far as the score of the log scatters from block to block by no more than it should ([`super::scattered`]).
//! Where the noise were what it is taken for, it would not; a real log's tails make it.
//!
//! Sizes that make up for one another leave a ridge, along which a likelihood hardly falls until one of them is at the end of its
//! law: the top may be anywhere on it, and says nothing. Of what is believed the middle counts.

use asami_dataset::Seed;
use rand::RngExt;

use super::layers::{Layer, Least, planted};
use super::ridge::Ridge;
use super::worlds::{World, worlds};
use crate::judge::Judge;
use crate::plant::{Planted, Variant};
use crate::weigh::cores::on_free_cores;

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

/// Sizes that are no less likely than half of the worlds that are drawn by so many nats are not lost: of eight sizes one in a thousand is that
/// much less likely than the likeliest.
const LOST_NATS: f64 = 13.0;

/// So many worlds are drawn.
const DRAWS: usize = 24;

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

/// Layers at the sizes that are believed, whatever else there may be, and worlds drawn as they are believed. Of a likelihood with several
/// tops what is in the middle of each size may be on none of them: where that is lost, sizes are those of the drawn world that is nearest.
#[must_use]
pub fn sized(
    judge: &dyn Judge,
    variants: &[Variant],
    layers: Vec<Layer>,
    least: &Least,
) -> (Vec<Layer>, Vec<Vec<Planted>>) {
    if layers.is_empty() {
        return (layers, Vec::new());
    }
    let worlds = worlds(judge, variants, &planted(&layers), least);
    let walks = walks(judge, &worlds);
    let draws = drawn(&walks);
    let sized = with_sizes(layers, believed(&worlds, &walks));
    (if lost(judge, &planted(&sized), &draws) { nearest(sized, &draws) } else { sized }, draws)
}

/// Whether these sizes, beside what else there is in any of the worlds that are drawn, are so much less likely than worlds as they are drawn.
fn lost(judge: &dyn Judge, sized: &[Planted], draws: &[Vec<Planted>]) -> bool {
    let beside = |world: &Vec<Planted>| judge.log_likelihood(&[sized, &world[sized.len()..]].concat());
    let best = draws.iter().map(beside).fold(f64::NEG_INFINITY, f64::max);
    let mut likely: Vec<f64> = draws.iter().map(|world| judge.log_likelihood(world)).collect();
    likely.sort_by(f64::total_cmp);
    likely.get(likely.len() / 2).is_some_and(|middle| best < middle - LOST_NATS)
}

/// The same at the sizes of the drawn world that lies nearest to them, as wide as they are.
fn nearest(layers: Vec<Layer>, draws: &[Vec<Planted>]) -> Vec<Layer> {
    let off = |world: &Vec<Planted>| {
        layers.iter().zip(world).fold(0.0, |sum, (layer, it)| {
            let [low, high] = layer.weighed.interval;
            sum + ((it.size - layer.weighed.best.size) / (high - low).max(f64::MIN_POSITIVE)).powi(2)
        })
    };
    let Some(world) = draws.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return layers };
    let at_world = layers.iter().zip(world).map(|(layer, it)| {
        let [low, high] = layer.weighed.interval;
        Believed { size: it.size, interval: [low.min(it.size), high.max(it.size)] }
    });
    let found = at_world.collect();
    with_sizes(layers, found)
}

fn with_sizes(mut layers: Vec<Layer>, found: Vec<Believed>) -> Vec<Layer> {
    for (layer, believed) in layers.iter_mut().zip(found) {
        layer.weighed.best.size = believed.size;
        layer.weighed.interval = believed.interval;
    }
    layers
}

/// A walk among the sizes of a world's effects.
pub struct Walk<'a> {
    world: &'a World,
    /// Of each effect, by step.
    sizes: Vec<Vec<f64>>,
}

/// Walks through these worlds, but for those about which the log's likelihood is not finite.
#[must_use]
pub fn walks<'a>(judge: &dyn Judge, worlds: &'a [World]) -> Vec<Walk<'a>> {
    let named = named(worlds);
    let walk = |world: &'a World| {
        let ridge = Ridge::about(judge, &world.effects, named, blocks(judge))?.looked_at(judge, &world.effects);
        let likely = ridge.likely(judge, &world.effects);
        let mut sizes = ridge.walk_on(ridge.of(&world.effects), likely, world.share, Seed(0));
        for (sizes, middle) in sizes.iter_mut().zip(&ridge.middle) {
            sizes.iter_mut().for_each(|size| *size *= middle);
        }
        Some(Walk { world, sizes })
    };
    on_free_cores(worlds.iter().collect(), walk).into_iter().flatten().collect()
}

/// How many effects all these worlds have, before all others.
fn named(worlds: &[World]) -> usize {
    worlds.iter().map(|world| world.effects.len()).min().unwrap_or(0)
}

/// Worlds as they are believed, each as probable as any other.
fn drawn(walks: &[Walk]) -> Vec<Vec<Planted>> {
    let mut rng = Seed(0).stream("worlds as they are believed");
    let whole = walks.iter().fold(0.0, |sum, walk| sum + walk.world.share);
    let mut draw = || {
        let mut left = whole * rng.random::<f64>();
        let at = walks.iter().position(|walk| {
            left -= walk.world.share;
            left < 0.0
        });
        let Walk { world, sizes } = &walks[at.unwrap_or(walks.len() - 1)];
        let steps = sizes.first().map_or(0, Vec::len);
        let step = (rng.random::<f64>() * steps as f64) as usize;
        let effects = world.effects.iter().zip(sizes);
        effects.map(|(it, sizes)| Planted { size: sizes[step], ..it.clone() }).collect()
    };
    let draws = if walks.is_empty() { 0 } else { DRAWS };
    (0..draws).map(|_| draw()).collect()
}

/// What is believed of the sizes of the effects that all these worlds have, the fewest of which the first has.
#[must_use]
pub fn believed(worlds: &[World], walks: &[Walk]) -> Vec<Believed> {
    // Of each size where walks through the worlds come by, with what a step of each counts.
    let mut seen: Vec<Vec<(f64, f64)>> = vec![Vec::new(); named(worlds)];
    for Walk { world, sizes } in walks {
        for (seen, sizes) in seen.iter_mut().zip(sizes) {
            let counts = world.share / sizes.len() as f64;
            seen.extend(sizes.iter().map(|size| (*size, counts)));
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
    use crate::real::layers::{ANY_SHARE as LEAST, beside_one_another};
    use crate::real::settle::settle;
    use crate::straight::Straight;
    use crate::weigh::evidence::Weighed;

    /// What is believed in the world with these effects and no other.
    fn alone(judge: &dyn Judge, effects: &[Planted]) -> Vec<Believed> {
        among(judge, &[World { effects: effects.to_vec(), share: 1.0 }])
    }

    fn among(judge: &dyn Judge, worlds: &[World]) -> Vec<Believed> {
        believed(worlds, &walks(judge, worlds))
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
            alone(judge, &truth).into_iter().map(relative).collect::<Vec<f64>>()
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
        let Believed { size, interval: [low, high] } = alone(&nothing, &truth)[0];
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
        let found = alone(&log, &of(best));
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

    /// Of a log of which nothing is named no world is drawn.
    #[test]
    fn where_nothing_is_named_nothing_is_drawn() {
        let kind = Straight::kind("command_scale");
        let log = Straight::new(&[Planted { size: 0.5 * kind.sizes().1, variant: kind.clone() }], &[&|_| 0.0], Seed(1));
        assert_eq!(sized(&log, &[kind], Vec::new(), &LEAST), (Vec::new(), Vec::new()));
    }

    /// Where the log may be of either of two worlds the middle of each size is of neither: what is believed is one of them then, the nearer.
    #[test]
    fn what_is_lost_is_not_believed() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let at = |shares: [f64; 2]| {
            let of = |k: usize| Planted { variant: kinds[k].clone(), size: shares[k] * kinds[k].sizes().1 };
            [of(0), of(1)].to_vec()
        };
        // Both together move the log by what one of them alone would.
        let wave = |t: usize| 9.0 * (0.37 * t as f64).sin();
        let log = Straight::new(&at([0.5, 0.5]), &[&wave, &wave], Seed(5));
        let [few, many] = [at([0.3, 0.7]), at([0.7, 0.3])];
        let draws: Vec<Vec<Planted>> = [vec![few.clone(); 8], vec![many; 7]].concat();
        let named = |shares: [f64; 2]| {
            let believed = at(shares)
                .into_iter()
                .map(|it| Believed { size: it.size, interval: [0.5, 1.5].map(|by| by * it.size) });
            with_sizes(beside_one_another(&log, &few), believed.collect())
        };
        for on_the_ridge in [[0.5, 0.5], [0.45, 0.55]] {
            assert!(!lost(&log, &at(on_the_ridge), &draws), "{on_the_ridge:?}");
        }
        assert!(lost(&log, &at([0.3, 0.3]), &draws) && !lost(&log, &at([0.3, 0.3]), &[]));
        let sizes = |layers: &[Layer]| planted(layers).iter().map(|it| it.size).collect::<Vec<f64>>();
        let found = nearest(named([0.31, 0.4]), &draws);
        assert_eq!(sizes(&found), few.iter().map(|it| it.size).collect::<Vec<f64>>());
        let [low, high] = found[1].weighed.interval;
        assert!(low < few[1].size && high >= few[1].size, "{low} to {high}");
    }

    /// What is left open makes up for a part of what is named. Sizes that are right beside it are not lost because they are unlikely
    /// without it.
    #[test]
    fn what_is_left_open_is_there_where_sizes_are_weighed() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let (a, b) = (|t: usize| 5.0 * (0.37 * t as f64).sin(), |t: usize| 5.0 * (0.91 * t as f64).sin());
        let truth = [of(0, 0.4), of(1, 0.5)];
        let log = Straight::new(&truth, &[&a, &|t| a(t) + b(t)], Seed(2));
        let alone = settle(&log, vec![of(0, 0.4)]);
        let unlikely = alone.likely - log.log_likelihood(&truth[..1]);
        assert!(unlikely > 10.0 * LOST_NATS && alone.effects[0].size > 1.8 * truth[0].size, "{unlikely}");
        let (found, _) = sized(&log, &kinds, beside_one_another(&log, &alone.effects), &LEAST);
        let Weighed { best, interval: [low, high], .. } = &found[0].weighed;
        assert!((low..=high).contains(&&truth[0].size) && (best.size / truth[0].size - 1.0).abs() < 0.15, "{found:?}");
        // By both waves' squares a standard deviation is 0.02 of the greatest size, and a middle of 90 % 3.29 of these.
        assert!((high - low) / kinds[0].sizes().1 < 0.1, "{low} to {high}");
    }

    /// Worlds that are drawn have what is named and, as often as it is probable, what else may be there; what they say of a size is what
    /// is believed of it, and sizes that make up for one another do so in each of them.
    #[test]
    fn worlds_are_drawn_as_they_are_believed() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let alike = |t: usize| 3.0 * (0.37 * t as f64).sin();
        let apart = |t: usize| alike(t) + 0.4 * (0.91 * t as f64).sin();
        let truth = [of(0, 0.4), of(1, 0.5)];
        let log = Straight::new(&truth, &[&alike, &apart], Seed(3));
        let both = settle(&log, truth.to_vec()).effects;
        let worlds = [(both.clone(), 0.7), (both[..1].to_vec(), 0.3)].map(|(effects, share)| World { effects, share });
        let walks = walks(&log, &worlds);
        let draws = drawn(&walks);
        assert_eq!(draws.len(), DRAWS);
        assert!(draws.iter().all(|it| it[0].variant == kinds[0] && it.len() <= 2));
        let with_both = draws.iter().filter(|it| it.len() == 2).count() as f64 / DRAWS as f64;
        // Three standard deviations of a share of 0.7 among so many.
        assert!((with_both - 0.7).abs() < 3.0 * (0.21 / DRAWS as f64).sqrt(), "{with_both}");
        let [low, high] = believed(&worlds, &walks)[0].interval;
        let inside = draws.iter().filter(|it| (low..=high).contains(&it[0].size));
        assert!(inside.count() as f64 >= 0.9 * DRAWS as f64 - 3.0 * (0.09 * DRAWS as f64).sqrt());
        // What both do alike is known far better than how much of it either does.
        let pairs = draws.iter().filter(|it| it.len() == 2).map(|it| [0, 1].map(|k| it[k].size / kinds[k].sizes().1));
        let pairs: Vec<[f64; 2]> = pairs.collect();
        let spread = |of: &dyn Fn(&[f64; 2]) -> f64| {
            let mean = pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
            pairs.iter().map(|it| (of(it) - mean).powi(2)).sum::<f64>().sqrt()
        };
        assert!(spread(&|it| it[0] + it[1]) < 0.3 * spread(&|it| it[0]), "{pairs:?}");
    }
}
