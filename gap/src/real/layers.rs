//! Many effects at once, one after another: what parts a real log from a nominal world is rarely one thing.
//!
//! Of all effects that with the greatest evidence is put into the world, then of the others that with the greatest evidence
//! beside it, and so on. Before they are compared, the sizes of all that is in the world are found together: effects that act
//! much alike hide one another as long as each is looked at by itself. In the end each is thought of again.

use asami_math::elementary::{exp, ln};
use asami_sim::effect::{Block, Place};

use super::kin::Kin;
use super::starts::starts;
use super::unsure::{World, believed, blocks};
use crate::judge::Judge;
use crate::newton::{Curvature, climb};
use crate::plant::{Planted, Variant};
use crate::weigh::evidence::{CLOSE, Weighed, weigh};
use crate::weigh::groups::Signature;

/// At most so many effects.
const MOST: usize = 8;
/// So many of the most evident are tried with all sizes found together.
const TRIED: usize = 6;
/// Those that gain less by themselves are not, in nats.
const LEAST_ALONE_NATS: f64 = 1.0;
/// Steps of Newton's method.
const STEPS: usize = 8;
/// A step that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 0.05;
/// Differences are taken over such a change of a size's logarithm.
const DIFFERENCE: f64 = 0.02;
/// No step changes a size by more, by its logarithm.
const LONGEST: f64 = 1.0;
/// Precision of a prior that leaves a size which changes nothing where it is.
const NEXT_TO_NOTHING: f64 = 1e-3;

/// So many may be in the world besides those that are named.
const UNNAMED: usize = 2;
/// A world less probable than this is left out.
const HARDLY: f64 = 0.02;

/// Effects are thought of again at most so often.
const PASSES: usize = 2;

/// An effect, and what it was held against.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The effect; its evidence, with what is known beforehand, over those before it alone, reconsidered: over all others.
    pub weighed: Weighed,
    /// What it pays of its gain for its size, in nats.
    pub(super) pays_nats: f64,
    /// Other effects in its place, the most evident first; of what is reconsidered.
    pub rivals: Vec<Rival>,
}

/// Another effect in the place of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rival {
    /// Its name.
    pub effect: &'static str,
    /// Its evidence.
    pub evidence_nats: f64,
    /// By so much the log parts what the two predict, each beside the others with all sizes found together.
    pub apart_nats: f64,
}

/// What is not worth a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Least {
    /// An effect that is less evident, in nats.
    pub nats: f64,
    /// One that adds less than this share to what all of its kind explain, the robot's motion or what its sensor makes of it:
    /// the response to a large effect is not known to the last nat, and small ones would make up for what it is off.
    pub share: f64,
    /// The share for motion of which it is known what effects make of one another.
    pub share_together: f64,
    /// Whether of two ways in which commands come late one is enough: a log hardly tells a lag behind a delay from either.
    pub late_once: bool,
    /// What is known beforehand, whose nats count as those of the log.
    pub kin: Kin,
}

impl Least {
    /// The kinds that may be named beside these.
    fn beside(&self, variants: &[Variant], with: &[Planted]) -> Vec<Variant> {
        let late = |it: &Variant| it.place() == Place::Actuation && it.block() == Block::Timing;
        let rules_out = |it: &Planted, variant: &Variant| {
            it.variant.about.name == variant.about.name || self.late_once && late(&it.variant) && late(variant)
        };
        variants.iter().filter(|variant| !with.iter().any(|it| rules_out(it, variant))).cloned().collect()
    }

    /// What the last of these effects must gain, all of which together are so likely.
    fn gain(&self, judge: &dyn Judge, all: &[Planted], likely: f64) -> f64 {
        let moves = |it: &Planted| matches!(it.variant.place(), Place::Actuation | Place::Dynamics);
        let Some(last) = all.last() else { return self.nats };
        let others: Vec<Planted> = all.iter().filter(|it| moves(it) != moves(last)).cloned().collect();
        let share = if moves(last) && judge.knows_motion_together() { self.share_together } else { self.share };
        self.nats.max(share * (likely - judge.log_likelihood(&others)))
    }
}

/// Effects one after another, for as long as the next is worth a name.
#[must_use]
pub fn layers(judge: &dyn Judge, variants: &[Variant], least: &Least) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    while layers.len() < MOST {
        let with = planted(&layers);
        let likely = judge.log_likelihood(&with);
        let mut tried = next(judge, variants, least, &with, likely).into_iter();
        let Some((best, settled)) = tried.next() else { break };
        if best.evidence_nats < least.gain(judge, &settled.effects, settled.likely) {
            break;
        }
        let pays_nats = best.gain_nats - best.evidence_nats;
        layers.push(Layer { weighed: best, pays_nats, rivals: Vec::new() });
        take(&mut layers, settled.effects);
    }
    layers
}

/// Thinks again of each of the effects, now that all the others are in the world: another may stand in its place, or none. What
/// remains is in order of its evidence beside all others, by blocks.
#[must_use]
pub fn reconsidered(judge: &dyn Judge, variants: &[Variant], mut layers: Vec<Layer>, least: &Least) -> Vec<Layer> {
    for _ in 0..PASSES {
        let mut changed = false;
        for at in (0..layers.len()).rev() {
            let before = layers.remove(at);
            let (rest, found) = in_its_place(judge, variants, &planted(&layers), &before, least);
            take(&mut layers, rest);
            let Some((layer, together)) = found else {
                changed = true;
                continue;
            };
            changed |= layer.weighed.effect != before.weighed.effect;
            layers.push(layer);
            take(&mut layers, together);
            layers[at..].rotate_right(1);
        }
        if !changed {
            break;
        }
    }
    layers.sort_by(|a, b| b.weighed.evidence_nats.total_cmp(&a.weighed.evidence_nats));
    let found = believed(judge, &worlds(judge, variants, &planted(&layers), least));
    for (layer, believed) in layers.iter_mut().zip(found) {
        layer.weighed.best.size = believed.size;
        layer.weighed.interval = believed.interval;
    }
    layers
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

/// The sizes of `others` without an effect that was there `before`, and what stands in its place with the sizes of all; `None` where
/// nothing is worth a name.
fn in_its_place(
    judge: &dyn Judge,
    variants: &[Variant],
    others: &[Planted],
    before: &Layer,
    least: &Least,
) -> (Vec<Planted>, Option<(Layer, Vec<Planted>)>) {
    let as_it_was = settle(judge, [others, std::slice::from_ref(&before.weighed.best)].concat());
    let rest = settle(judge, others.to_vec());
    let mut tried = next(judge, variants, least, &rest.effects, rest.likely);
    stays(&mut tried, before, as_it_was, rest.likely);
    // What gains more, but in too few blocks, is no rival of what shows throughout the log.
    let mut tried = tried.into_iter().skip_while(|(it, settled)| by_blocks(it, settled) < least.nats);
    let best = tried.next();
    let found = best.filter(|(it, settled)| it.gain_nats >= least.gain(judge, &settled.effects, settled.likely));
    let layer = found.map(|(best, settled)| {
        let (evidence_nats, pays_nats) = (by_blocks(&best, &settled), best.gain_nats - best.evidence_nats);
        // What parts two of them counts as little as what parts the better one from none.
        let less = |rival: &Weighed| settled.counts * (best.evidence_nats - rival.evidence_nats);
        let reading = |settled: &Settled| judge.read(&judge.numbers(&settled.effects));
        let leads = reading(&settled);
        let rivals = tried.map(|(rival, other)| Rival {
            effect: rival.effect,
            evidence_nats: evidence_nats - less(&rival),
            apart_nats: settled.counts * Signature::new(&leads, &reading(&other)).nats(),
        });
        let rivals = rivals.collect();
        (Layer { weighed: Weighed { evidence_nats, ..best }, pays_nats, rivals }, settled.effects)
    });
    (rest.effects, layer)
}

/// Has an effect that was there already, as `settled` with all sizes found together, be no worse for being thought of again.
fn stays(tried: &mut Vec<(Weighed, Settled)>, before: &Layer, settled: Settled, likely: f64) {
    let gain_nats = settled.likely - likely;
    let anew = tried.iter().position(|(it, _)| it.effect == before.weighed.effect).map(|at| tried.remove(at));
    if let Some((weighed, anew)) = anew.filter(|(it, _)| it.gain_nats >= gain_nats) {
        tried.push((weighed, anew));
    } else {
        let evidence_nats = gain_nats - before.pays_nats;
        tried.push((Weighed { gain_nats, evidence_nats, ..before.weighed.clone() }, settled));
    }
    tried.sort_by(|a, b| b.0.evidence_nats.total_cmp(&a.0.evidence_nats));
}

/// The evidence of an effect, where of what it gains so much counts as blocks leave it.
fn by_blocks(it: &Weighed, settled: &Settled) -> f64 {
    of_what_counts(it, settled.counts)
}

/// The evidence of an effect, where of a nat that it gains so much counts; what it pays for its size it pays all the same.
fn of_what_counts(it: &Weighed, counts: f64) -> f64 {
    counts * it.gain_nats - (it.gain_nats - it.evidence_nats)
}

/// Sizes as they were found together.
fn take(layers: &mut [Layer], found: Vec<Planted>) {
    layers.iter_mut().zip(found).for_each(|(layer, best)| layer.weighed.best = best);
}

/// The effects at their most likely sizes.
#[must_use]
pub fn planted(layers: &[Layer]) -> Vec<Planted> {
    layers.iter().map(|layer| layer.weighed.best.clone()).collect()
}

/// Effects with their sizes found together.
struct Settled {
    /// At their most likely sizes.
    effects: Vec<Planted>,
    /// The log-likelihood there.
    likely: f64,
    /// What counts of a nat that the last of them gains: its variance as steps have it over that as blocks do (Pauli, Racugno
    /// and Ventura 2011).
    counts: f64,
}

/// What may be put beside what is in the world, the most evident first, each with the sizes of all found together.
fn next(
    judge: &dyn Judge,
    variants: &[Variant],
    least: &Least,
    with: &[Planted],
    likely: f64,
) -> Vec<(Weighed, Settled)> {
    let others = least.beside(variants, with);
    let alone = weigh(judge, &others, with, CLOSE).into_iter().map(|it| {
        let start = [with, std::slice::from_ref(&it.best)].concat();
        let evidence_nats = it.evidence_nats - least.kin.more_against_nats(it.effect);
        (Weighed { evidence_nats, ..it }, start)
    });
    let mut worth: Vec<(Weighed, Vec<Planted>)> = alone.collect();
    // Better, perhaps, than beside the others as they are.
    for start in if with.is_empty() { Vec::new() } else { starts(judge, &others, with) } {
        let Some(best) = start.effects.last() else { continue };
        let same = worth.iter_mut().find(|(it, _)| it.effect == best.variant.about.name);
        let gain_nats = start.likely - likely;
        if let Some((it, effects)) = same.filter(|(it, _)| it.gain_nats < gain_nats) {
            let evidence_nats = it.evidence_nats - it.gain_nats + gain_nats;
            *it = Weighed { best: best.clone(), gain_nats, evidence_nats, ..it.clone() };
            *effects = start.effects;
        }
    }
    worth.retain(|(it, _)| it.gain_nats > LEAST_ALONE_NATS);
    worth.sort_by(|a, b| b.0.evidence_nats.total_cmp(&a.0.evidence_nats));
    let try_it = |(mut it, start): (Weighed, Vec<Planted>)| {
        let settled = settle(judge, start);
        // What it pays for its size stays what it is.
        let paid = it.evidence_nats - it.gain_nats;
        it.gain_nats = settled.likely - likely;
        it.evidence_nats = it.gain_nats + paid;
        (it, settled)
    };
    let mut tried: Vec<(Weighed, Settled)> = worth.into_iter().take(TRIED).map(try_it).collect();
    tried.sort_by(|a, b| b.0.evidence_nats.total_cmp(&a.0.evidence_nats));
    tried
}

/// Finds all sizes together, by Newton's method on their logarithms.
fn settle(judge: &dyn Judge, mut all: Vec<Planted>) -> Settled {
    let block = blocks(judge);
    let terms = |all: &[Planted]| judge.terms(&judge.numbers(all));
    let total = |terms: &[f64]| terms.iter().fold(0.0, |sum, it| sum + it);
    let mut here = terms(&all);
    let mut counts = 1.0;
    for _ in 0..STEPS {
        let scores: Vec<Vec<f64>> = (0..all.len())
            .map(|i| {
                let mut beside = all.clone();
                // Towards the inside of the law.
                let h =
                    if ln(all[i].size) + DIFFERENCE > ln(all[i].variant.sizes().1) { -DIFFERENCE } else { DIFFERENCE };
                beside[i].size *= exp(h);
                terms(&beside).iter().zip(&here).map(|(there, here)| (there - here) / h).collect()
            })
            .collect();
        let Some(curvature) = Curvature::new(&scores, NEXT_TO_NOTHING) else { break };
        let step = curvature.step(&scores.iter().map(|score| total(score)).collect::<Vec<f64>>());
        let last = curvature.variances_by_block(&scores, &block).pop().zip(curvature.variances().pop());
        // Blocks are few: that errors in one made up for one another is not believed.
        counts = last.map_or(1.0, |(by_block, by_step)| by_step / by_block.max(by_step));
        let before = total(&here);
        let better = climb(before, &[2.0], |share| {
            let mut there = all.clone();
            for (planted, step) in there.iter_mut().zip(&step) {
                let (least, greatest) = planted.variant.sizes();
                let moved = (share * step).clamp(-LONGEST, LONGEST);
                planted.size = (planted.size * exp(moved)).clamp(least, greatest);
            }
            let of_there = terms(&there);
            (total(&of_there), (there, of_there))
        });
        let Some((found, (there, of_there))) = better else { break };
        (all, here) = (there, of_there);
        if found - before < GAINS_NOTHING_NATS {
            break;
        }
    }
    Settled { effects: all, likely: total(&here), counts }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    const LEAST: Least = Least { nats: 5.0, share: 0.0, share_together: 0.0, late_once: true, kin: Kin::NONE };

    /// What gains more than another effect, but all of it in two blocks of twenty, neither takes its place nor has it dropped.
    #[test]
    fn what_shows_throughout_a_log_stays_beside_what_shows_twice() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let throughout = |t: usize| 0.9 * (0.37 * t as f64).sin();
        let twice = |t: usize| if t / 20 % 10 == 3 { 4.0 * (0.37 * t as f64).cos() } else { 0.0 };
        let mut log = Straight::new(&[of(0, 0.5), of(1, 0.02)], &[&throughout, &twice], Seed(5));
        // Once for it, and once against.
        (0..20).for_each(|t| log.measured[60 + t] += 0.9 * twice(60 + t));
        (0..20).for_each(|t| log.measured[260 + t] -= 0.2 * twice(260 + t));
        let found = layers(&log, &kinds, &LEAST);
        let first = found.first().map(|it| it.weighed.effect);
        assert_eq!((first, found.len()), (Some("wheel_base"), 2), "by nats alone");
        let found = reconsidered(&log, &kinds, found, &LEAST);
        let names: Vec<&str> = found.iter().map(|it| it.weighed.effect).collect();
        assert_eq!(names, ["command_scale"]);
        let [low, high] = found[0].weighed.interval;
        assert!(low < of(0, 0.5).size && of(0, 0.5).size < high, "{low} to {high}");
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
}
