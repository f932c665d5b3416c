//! What is believed of sizes that were found together, whatever the noise of a real robot is: their laws, and how the log's
//! likelihood bends about where it is greatest, as far as the score of the log scatters from block to block by no more than it
//! should (Huber 1967, White 1982). Where the noise were what it is taken for, it would not; a real log's tails make it.
//!
//! Sizes that make up for one another leave a ridge, along which a likelihood hardly falls until one of them is at the end of its
//! law: the top may be anywhere on it, and says nothing. Of what is believed the middle counts.

use asami_dataset::Seed;
use asami_math::elementary::exp;

use super::kin::Kin;
use super::layers::{Layer, Least, next, of_what_counts, planted};
use super::ridge::Ridge;
use crate::judge::Judge;
use crate::plant::{Planted, Variant};

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

/// So many may be in the world besides those that are named.
const UNNAMED: usize = 2;
/// A world less probable than this is left out.
const HARDLY: f64 = 0.02;

/// Sizes that are believed are no less likely than the likeliest, in nats: of eight of them one in a thousand is.
const LOST_NATS: f64 = 13.0;

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

/// What the world may be, where these effects are named: they alone, and with others that are not worth a name. An effect's size
/// hangs on what else there is, so that it would be said too surely, and with what others do put down to it, were there nothing
/// (Hoeting et al. 1999, "Bayesian Model Averaging").
fn worlds(judge: &dyn Judge, variants: &[Variant], named: &[Planted], least: &Least) -> Vec<World> {
    // With the logarithm of how probable each is over the named ones alone.
    let mut all = vec![(named.to_vec(), 0.0)];
    let mut base = all[0].clone();
    let unnamed = if named.is_empty() { 0 } else { UNNAMED };
    for _ in 0..unnamed {
        let likely = judge.log_likelihood(&base.0);
        let further = next(judge, variants, least, &base.0, likely).into_iter().map(|(it, settled)| {
            // Where more is asked for because the library may be off by as much, a nat counts so much less.
            let counts = settled.counts * least.nats / least.gain(judge, &settled.effects, settled.likely);
            let odds = base.1 + of_what_counts(&it, counts) - Kin::NONE.against_nats(it.effect);
            (settled.effects, odds)
        });
        let further: Vec<(Vec<Planted>, f64)> = further.collect();
        let likeliest = further.iter().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|it| it.1 > base.1).cloned();
        all.extend(further);
        let Some(likeliest) = likeliest else { break };
        base = likeliest;
    }
    let top = all.iter().fold(f64::NEG_INFINITY, |top, it| top.max(it.1));
    let whole = all.iter().fold(0.0, |sum, it| sum + exp(it.1 - top));
    let shared = all.into_iter().map(|(effects, odds)| World { effects, share: exp(odds - top) / whole });
    shared.filter(|it| it.share >= HARDLY).collect()
}

/// Layers at the sizes that are believed, whatever else there may be; but at those that they have where what is believed is so much less
/// likely that no ridge can lead there: a likelihood with several tops is bent like none of them. How unsure they are then is taken to be
/// how far off what is believed reaches, to either side.
#[must_use]
pub fn sized(judge: &dyn Judge, variants: &[Variant], layers: Vec<Layer>, least: &Least) -> Vec<Layer> {
    let top = planted(&layers);
    let found = believed(judge, &worlds(judge, variants, &top, least));
    or_at_the_top(judge, with_sizes(layers, found), &top)
}

fn or_at_the_top(judge: &dyn Judge, sized: Vec<Layer>, top: &[Planted]) -> Vec<Layer> {
    if judge.log_likelihood(&planted(&sized)) >= judge.log_likelihood(top) - LOST_NATS {
        return sized;
    }
    let at_top = sized.iter().zip(top).map(|(layer, it)| {
        let (least, greatest) = it.variant.sizes();
        let far = layer.weighed.interval.map(|end| (end - it.size).abs()).into_iter().fold(0.0, f64::max);
        Believed { size: it.size, interval: [-far, far].map(|off| (it.size + off).clamp(least, greatest)) }
    });
    let at_top = at_top.collect();
    with_sizes(sized, at_top)
}

fn with_sizes(mut layers: Vec<Layer>, found: Vec<Believed>) -> Vec<Layer> {
    for (layer, believed) in layers.iter_mut().zip(found) {
        layer.weighed.best.size = believed.size;
        layer.weighed.interval = believed.interval;
    }
    layers
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
    use crate::real::layers::{ANY_SHARE as LEAST, beside_one_another, settle};
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

    /// What is not worth a name may be there all the same, and what is named makes up for it: intervals allow for that.
    #[test]
    fn sizes_allow_for_what_else_there_may_be() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let truth = [of(0, 0.5), of(1, 0.3)];
        let wave = |t: usize, step: f64| (step * t as f64).sin();
        // By itself the second wave is worth 4.4 nats: less than a name is.
        let alike = |t: usize| wave(t, 0.37) + 0.7 * wave(t, 0.91);
        let [mut held, mut alone] = [0, 0];
        for seed in 0..40 {
            let log = Straight::new(&truth, &[&|t| wave(t, 0.37), &alike], Seed(seed));
            let named = settle(&log, vec![of(0, 0.5)]).effects;
            let holds = |worlds: &[World]| {
                let [low, high] = believed(&log, worlds)[0].interval;
                low <= truth[0].size && truth[0].size <= high
            };
            let worlds = worlds(&log, &kinds, &named, &LEAST);
            let shares: f64 = worlds.iter().map(|it| it.share).sum();
            assert!((0.95..1.0 + 1e-9).contains(&shares), "{shares}");
            held += usize::from(holds(&worlds));
            alone += usize::from(holds(&[World { effects: named, share: 1.0 }]));
        }
        assert!(held >= 30 && alone <= 10, "{held} and {alone} of 40");
    }

    /// Sizes that are far from where the log is likeliest are not believed, those that are near are.
    #[test]
    fn what_is_lost_is_not_believed() {
        let kind = Straight::kind("command_scale");
        let at = |share: f64| Planted { variant: kind.clone(), size: share * kind.sizes().1 };
        let log = Straight::new(&[at(0.5)], &[&|t| 9.0 * (0.37 * t as f64).sin()], Seed(5));
        let top = settle(&log, vec![at(0.5)]).effects;
        let named = || beside_one_another(&log, &top);
        let of = |layers: Vec<Layer>| (layers[0].weighed.best.size, layers[0].weighed.interval);
        let kinds = std::slice::from_ref(&kind);
        let found = believed(&log, &worlds(&log, kinds, &top, &LEAST))[0];
        assert_eq!(of(sized(&log, kinds, named(), &LEAST)), (found.size, found.interval));
        let size = top[0].size;
        let off = |by: f64| Believed { size: by * size, interval: [(by - 0.1) * size, (by + 0.1) * size] };
        let kept = |by: f64| of(or_at_the_top(&log, with_sizes(named(), vec![off(by)]), &top));
        assert_eq!(kept(1.02), (off(1.02).size, off(1.02).interval));
        for by in [1.3, 0.7] {
            let (kept, [low, high]) = kept(by);
            assert_eq!(kept, size);
            assert!((low / size - 0.6).abs() < 1e-9 && (high / size - 1.4).abs() < 1e-9, "{low} to {high}");
        }
    }
}
