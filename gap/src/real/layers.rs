//! Many effects at once, one after another: what parts a real log from a nominal world is rarely one thing.
//!
//! Of all effects that with the greatest evidence is put into the world, then of the others that with the greatest evidence
//! beside it, and so on. Before they are compared, the sizes of all that is in the world are found together: effects that act
//! much alike hide one another as long as each is looked at by itself. In the end each is thought of again.

use asami_sim::effect::{Block, Place};

use super::kin::Kin;
use super::settle::{Settled, settle};
use super::starts::About;
use super::unsure::sized;
use crate::judge::Judge;
use crate::plant::{Planted, Variant};
use crate::weigh::cores::on_free_cores;
use crate::weigh::evidence::{CLOSE, QUICK, Weighed, weigh};
use crate::weigh::groups::Signature;

/// At most so many effects.
const MOST: usize = 12;
/// So many of the most evident are tried with all sizes found together.
const TRIED: usize = 6;
/// Those that gain less by themselves are not, in nats.
const LEAST_ALONE_NATS: f64 = 1.0;

/// By this only what follows a rest comes late: a log tells that apart from a delay of all commands, and from a lag.
const STARTS: &str = "late_start";

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
    /// The share where it is known what effects of its kind make of one another.
    pub share_together: f64,
    /// Whether of two ways in which commands come late one is enough: a log hardly tells a lag behind a delay from either.
    pub late_once: bool,
    /// What is known beforehand, whose nats count as those of the log.
    pub kin: Kin,
}

impl Least {
    /// The kinds that may be named beside these.
    pub(super) fn beside(&self, variants: &[Variant], with: &[Planted]) -> Vec<Variant> {
        variants.iter().filter(|variant| !self.rules_out(variant, with)).cloned().collect()
    }

    /// Whether one of `with` is enough.
    pub(super) fn rules_out(&self, variant: &Variant, with: &[Planted]) -> bool {
        let same = |it: &Planted| it.variant.about.name == variant.about.name;
        let late = |it: &Planted| self.one_of_two(&it.variant) && self.one_of_two(variant);
        with.iter().any(|it| same(it) || late(it))
    }

    /// Whether it is one of two ways in which commands come late, of which one is enough.
    pub(super) fn one_of_two(&self, variant: &Variant) -> bool {
        let all_alike = variant.about.name != STARTS;
        self.late_once && all_alike && variant.place() == Place::Actuation && variant.block() == Block::Timing
    }

    /// What effects are worth that are named together: how likely they make a log, less what each name takes.
    pub(super) fn worth(&self, judge: &dyn Judge, all: &[Planted]) -> f64 {
        judge.log_likelihood(all) - self.nats * all.len() as f64
    }

    /// What the last of these effects must gain, all of which together are so likely.
    pub(super) fn gain(&self, judge: &dyn Judge, all: &[Planted], likely: f64) -> f64 {
        all.last().map_or(self.nats, |last| self.gain_of(judge, all, last, likely))
    }

    /// What one of them must gain.
    pub(super) fn gain_of(&self, judge: &dyn Judge, all: &[Planted], one: &Planted, likely: f64) -> f64 {
        let moves = |it: &Planted| matches!(it.variant.place(), Place::Actuation | Place::Dynamics);
        let others: Vec<Planted> = all.iter().filter(|it| moves(it) != moves(one)).cloned().collect();
        let share = if judge.knows_together(moves(one)) { self.share_together } else { self.share };
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

/// The same of effects that were found together: what each is worth beside all others.
#[must_use]
pub fn beside_one_another(judge: &dyn Judge, found: &[Planted]) -> Vec<Layer> {
    (0..found.len()).filter_map(|i| beside_others(judge, found, i)).collect()
}

/// What one of them is worth beside all others.
pub(super) fn beside_others(judge: &dyn Judge, found: &[Planted], i: usize) -> Option<Layer> {
    let mut others = found.to_vec();
    let best = others.remove(i);
    let weighed = weigh(judge, std::slice::from_ref(&best.variant), &others, CLOSE).pop()?;
    let pays_nats = weighed.gain_nats - weighed.evidence_nats;
    Some(Layer { weighed: Weighed { best, ..weighed }, pays_nats, rivals: Vec::new() })
}

/// Thinks again of each of the effects ([`thought_again`]), and says how large each is whatever else there may be.
#[must_use]
pub fn reconsidered(judge: &dyn Judge, variants: &[Variant], layers: Vec<Layer>, least: &Least) -> Vec<Layer> {
    sized(judge, variants, thought_again(judge, variants, layers, least), least).0
}

/// Thinks again of each of the effects, now that all the others are in the world: another may stand in its place, or none. What
/// remains is in order of its evidence beside all others, by blocks.
#[must_use]
pub fn thought_again(judge: &dyn Judge, variants: &[Variant], mut layers: Vec<Layer>, least: &Least) -> Vec<Layer> {
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
    layers
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
        let less = |rival: &Weighed| settled.last_counts() * (best.evidence_nats - rival.evidence_nats);
        let reading = |settled: &Settled| judge.read(&judge.numbers(&settled.effects));
        let leads = reading(&settled);
        let rivals = tried.map(|(rival, other)| Rival {
            effect: rival.effect,
            evidence_nats: evidence_nats - less(&rival),
            apart_nats: settled.last_counts() * Signature::new(&leads, &reading(&other)).nats(),
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
    of_what_counts(it, settled.last_counts())
}

/// The evidence of an effect, where of a nat that it gains so much counts; what it pays for its size it pays all the same.
pub(super) fn of_what_counts(it: &Weighed, counts: f64) -> f64 {
    counts * it.gain_nats - (it.gain_nats - it.evidence_nats)
}

/// Sizes as they were found together.
pub(super) fn take(layers: &mut [Layer], found: Vec<Planted>) {
    layers.iter_mut().zip(found).for_each(|(layer, best)| layer.weighed.best = best);
}

/// The effects at their most likely sizes.
#[must_use]
pub fn planted(layers: &[Layer]) -> Vec<Planted> {
    layers.iter().map(|layer| layer.weighed.best.clone()).collect()
}

/// What may be put beside what is in the world, the most evident first, each with the sizes of all found together.
pub(super) fn next(
    judge: &dyn Judge,
    variants: &[Variant],
    least: &Least,
    with: &[Planted],
    likely: f64,
) -> Vec<(Weighed, Settled)> {
    let others = least.beside(variants, with);
    further(judge, least, &About::new(judge, &others, with), likely)
}

/// The same of kinds whose slope is known.
pub(super) fn further(judge: &dyn Judge, least: &Least, about: &About, likely: f64) -> Vec<(Weighed, Settled)> {
    let with = about.with;
    let alone = weigh(judge, about.kinds, with, QUICK).into_iter().map(|it| {
        let start = [with, std::slice::from_ref(&it.best)].concat();
        let evidence_nats = it.evidence_nats - least.kin.more_against_nats(it.effect);
        (Weighed { evidence_nats, ..it }, start)
    });
    let mut worth: Vec<(Weighed, Vec<Planted>)> = alone.collect();
    // Better, perhaps, than beside the others as they are.
    for start in if with.is_empty() { Vec::new() } else { about.starts(judge) } {
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
    worth.truncate(TRIED);
    let mut tried: Vec<(Weighed, Settled)> = on_free_cores(worth, try_it);
    tried.sort_by(|a, b| b.0.evidence_nats.total_cmp(&a.0.evidence_nats));
    tried
}

/// Of tests, in which nothing is off but what is meant to be.
#[cfg(test)]
pub(super) const ANY_SHARE: Least =
    Least { nats: 5.0, share: 0.0, share_together: 0.0, late_once: true, kin: Kin::NONE };

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

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
        let found = layers(&log, &kinds, &ANY_SHARE);
        let first = found.first().map(|it| it.weighed.effect);
        assert_eq!((first, found.len()), (Some("wheel_base"), 2), "by nats alone");
        let found = reconsidered(&log, &kinds, found, &ANY_SHARE);
        let names: Vec<&str> = found.iter().map(|it| it.weighed.effect).collect();
        assert_eq!(names, ["command_scale"]);
        let [low, high] = found[0].weighed.interval;
        assert!(low < of(0, 0.5).size && of(0, 0.5).size < high, "{low} to {high}");
    }

    /// An effect of half the least size that cases are drawn with: were nothing so small thought of, it would be missed or said too large.
    #[test]
    fn what_is_smaller_than_any_case_is_found() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let least = kinds[0].sizes().0;
        let truth = [least / 2.0, 0.2 * kinds[1].sizes().1].into_iter().zip(kinds.clone());
        let truth: Vec<Planted> = truth.map(|(size, variant)| Planted { variant, size }).collect();
        let per_least = kinds[0].sizes().1 / least;
        let (a, b) = (|t: usize| (0.37 * t as f64).sin(), |t: usize| (0.91 * t as f64).sin());
        let log = Straight::new(&truth, &[&|t| 2.0 * per_least * a(t), &|t| 5.0 * (a(t) + 0.5 * b(t))], Seed(6));
        let off = |share: f64| {
            let kinds = kinds.clone().map(|it| it.of_sizes_from(share));
            let found = planted(&layers(&log, &kinds, &ANY_SHARE));
            truth.iter().map(move |it| {
                let size = found.iter().find(|other| other.variant == it.variant).map_or(0.0, |it| it.size);
                size / it.size - 1.0
            })
        };
        assert!(off(0.1).all(|it| it.abs() < 0.35), "{:?}", off(0.1).collect::<Vec<_>>());
        assert!(off(1.0).any(|it| it.abs() > 0.7), "{:?}", off(1.0).collect::<Vec<_>>());
    }
}
