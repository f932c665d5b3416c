//! The diagnosis of a real robot's log: how noisy it is, then everything that parts it from the nominal world, the largest
//! first.

mod acts;
pub mod astray;
mod cautious;
pub mod crossed;
pub mod folds;
pub mod kin;
pub mod layers;
mod noise;
pub mod pedals;
pub mod prior;
mod ridge;
pub mod scanner;
mod scattered;
mod settle;
mod starts;
mod unsettled;
mod unsure;
mod whole;
mod worlds;

use std::collections::BTreeMap;

use asami_dataset::Log;
use asami_math::elementary::exp;
use asami_sim::effect::{Block, Place};
use rayon::prelude::*;

use crate::answer::diagnosis::{Cause, Diagnosis, Estimate, HowFar, SCHEMA, Verdict, values};
use crate::answer::how_far::how_far;
use crate::answer::place::places;
use crate::blocks::{self, Fitted};
use crate::judge::Judge;
use crate::library::Library;
use crate::plant::{Planted, Variant};
use crate::view::CannotSee;
use crate::weigh::causes::{NONE, UNKNOWN};
use crate::weigh::groups::{SPLIT_NATS, smallest_visible};
use acts::{acts, shows_beside};
use cautious::Cautious;
use crossed::Crossed;
use folds::Folds;
use kin::Kin;
use layers::{Layer, Least, Rival, beside_one_another, layers, planted, thought_again};
use prior::Prior;
use unsettled::settled;
use unsure::sized;
use whole::whole;

/// Nobody draws what a real robot has: an effect may be smaller, by this share, than the least that cases are drawn with, and a log say so.
/// Were that least the least that is thought of, others would make up for it.
const SMALLER: f64 = 0.1;
/// Noise is learned, effects are named, and again, for the noise is what the effects leave; the likeliest of these counts.
const ROUNDS: usize = 4;
/// Of all effects at once, and of each beside what that leaves, it is thought again at most so often.
const AGAIN: usize = 2;
/// Where that gains less, in nats, it is not.
const GAINS_NOTHING_NATS: f64 = 1.0;
/// In so many of the first ones it is looked for where the robot does not do what it is told.
const LOOKING: usize = 2;
/// Ten to one are against each further effect, and nine to one have to be for it: 4.5 nats. What adds less than this share may as
/// well be what the nominal world's own shape, or the library, is off.
const LEAST: Least = Least { nats: 5.0, share: 0.01, share_together: 0.0005, late_once: true, kin: Kin::NONE };
/// Where nothing in the list explains anything, there is a gap all the same if a flexible block has so much evidence.
const UNEXPLAINED_NATS: f64 = 10.0;
/// Where more of the gap than this remains with every effect in, something is unknown.
const MOST_REMAINS: f64 = 0.3;
/// Causes that are so probable together are the set that is said, and effects that are so probable together are settled.
const SURE: f64 = 0.9;
/// Causes less probable than this are left out.
const NEGLIGIBLE: f64 = 1e-3;

/// Diagnoses a log of a real robot. Effects of noise are not thought of: the rest of the log says how large it is. Nor is what the
/// robot does where it does not do what it is told ([`astray`]).
///
/// Probabilities are by layer: of an effect, its evidence over that of others in its place, beside all the rest. The probability of
/// *unknown* is the share of the gap that remains; all of it, where nothing in the list explains a gap.
///
/// # Errors
/// [`CannotSee`] says what the log lacks.
pub fn diagnose(nominal: &Library, variants: &[Variant], log: &Log) -> Result<Diagnosis, CannotSee> {
    diagnose_among(nominal, variants, log, &Prior::NONE, Search::Forwards)
}

/// In which order effects are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// One after another, beside what was found before.
    #[default]
    Forwards,
    /// So, and then backwards from there with all of them at once: whichever is worth more.
    BothWays,
}

impl Search {
    /// As it is asked for.
    #[must_use]
    pub fn of(both_ways: bool) -> Self {
        if both_ways { Self::BothWays } else { Self::Forwards }
    }

    /// Effects found, by noise as it is known so far.
    fn layers(self, judge: &dyn Judge, variants: &[Variant], least: &Least) -> Vec<Layer> {
        let found = layers(judge, variants, least);
        match self {
            Self::Forwards => found,
            Self::BothWays => beside_one_another(judge, &whole(judge, variants, &planted(&found), least)),
        }
    }

    /// What is left of them when each, and all of them at once, are thought of again.
    fn again(self, judge: &dyn Judge, variants: &[Variant], found: Vec<Layer>, least: &Least) -> Vec<Layer> {
        let mut found = thought_again(judge, variants, found, least);
        let most = if self == Self::BothWays { AGAIN } else { 0 };
        for _ in 0..most {
            let before = planted(&found);
            let all = whole(judge, variants, &before, least);
            let next = thought_again(judge, variants, beside_one_another(judge, &all), least);
            if least.worth(judge, &planted(&next)) - least.worth(judge, &before) < GAINS_NOTHING_NATS {
                break;
            }
            found = next;
        }
        found
    }
}

/// The same by what is known beforehand: what others of its make have, the robot is expected to have, and what its log says counts as
/// little as halves of such logs leave of it.
///
/// # Errors
/// [`CannotSee`] says what the log lacks.
pub fn diagnose_among(
    nominal: &Library,
    variants: &[Variant],
    log: &Log,
    prior: &Prior,
    search: Search,
) -> Result<Diagnosis, CannotSee> {
    let least = Least { kin: prior.kin.clone(), ..LEAST };
    // A single landmark that stands elsewhere is a robot that does.
    let shows = |it: &&Variant| it.place() != Place::Scene || nominal.base.shape.landmarks > 1;
    let told = |it: &&Variant| shows_beside(it, &log.known) && acts(it, &log.commands);
    let there = |it: &&Variant| it.block() != Block::Noise && shows(it) && told(it);
    let any_size = |it: &Variant| it.clone().of_sizes_from(SMALLER);
    let variants: Vec<Variant> = variants.iter().filter(there).map(any_size).collect();
    let folds = Folds::default();
    let mut library = nominal.clone();
    let mut best = (f64::NEG_INFINITY, Vec::new(), Vec::new());
    let (mut before, mut found): (Vec<Library>, Vec<Layer>) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        let with = planted(&found);
        let of_others = |fold: usize| library.noisy_as(log, |t_s| folds.of(t_s) != fold, &with, before.get(fold));
        let noisy: Vec<Library> = (0..folds.count).into_par_iter().map(of_others).collect::<Result<_, _>>()?;
        let judge = Crossed::new(log, &noisy, folds, &with)?;
        found = search.layers(&Cautious::new(&judge, prior.counts()), &variants, &least);
        // A robot that is known to be somewhere later has fewer steps that are scored.
        let likely = judge.log_likelihood(&planted(&found)) / judge.steps().len().max(1) as f64;
        if round < LOOKING {
            astray::add(&mut library.astray, &judge, &planted(&found));
        } else if round == LOOKING || likely > best.0 {
            best = (likely, noisy.clone(), found.clone());
        }
        before = noisy;
    }
    let (_, noisy, found) = best;
    let judge = Crossed::new(log, &noisy, folds, &planted(&found))?;
    let cautious = Cautious::new(&judge, prior.counts());
    let found = search.again(&cautious, &variants, found, &least);
    let (found, unsettled) = settled(&cautious, found);
    // What is left open is not there to make up for anything: the others alone explain as much as they do where they are likeliest.
    let alone = (!unsettled.is_empty()).then(|| planted(&found));
    let (found, draws) = sized(&cautious, &variants, found, &least);
    let with = alone.unwrap_or_else(|| planted(&found));
    let astray_s = library.astray.iter().fold(0.0, |sum, [from_s, to_s]| sum + to_s - from_s);
    let noise = noise::compared(nominal, &noisy);
    let draws = draws.iter().map(|world| world.iter().flat_map(values).collect()).collect();
    let mut diagnosis = assembled(&judge, &variants, &found, &with);
    // What an effect gains grows as its size's square.
    diagnosis.smallest_visible.values_mut().for_each(|it| *it *= prior.halves_differ);
    let halves_differ = Some(prior.halves_differ);
    Ok(Diagnosis { astray_s: Some(astray_s), halves_differ, noise, unsettled, draws, ..diagnosis })
}

/// What was found, and what that explains, `all` of which is in the world then.
fn assembled(judge: &dyn Judge, variants: &[Variant], found: &[Layer], all: &[Planted]) -> Diagnosis {
    let (base, with) = (judge.numbers(&[]), judge.numbers(all));
    let blocks = blocks::fit(judge, &with, &|_| true);
    let block = blocks.into_iter().reduce(|a, b| if b.evidence_nats > a.evidence_nats { b } else { a });
    let evident = block.as_ref().is_some_and(|block| block.evidence_nats >= UNEXPLAINED_NATS);
    let far = if found.is_empty() { HowFar::default() } else { how_far(judge, all) };
    let remains = match found {
        // All of it, where there is a gap at all.
        [] if evident => 1.0,
        [_, ..] if far.excess_before > 0.0 => (far.excess_after / far.excess_before).clamp(0.0, 1.0),
        _ => 0.0,
    };
    let which = which(judge, found, all, remains, block.as_ref());
    let set90 = set90(which.iter().filter(|cause| cause.names_effects()));
    let (cannot_tell_apart, all_alike) = groups(found, &set90);
    let verdict = match set90.len() {
        _ if remains > MOST_REMAINS => Verdict::Unknown,
        0 => Verdict::None,
        // One group is one answer.
        _ if all_alike => Verdict::Named,
        _ => Verdict::Tied,
    };
    Diagnosis {
        schema: SCHEMA,
        verdict,
        places: if found.is_empty() { Vec::new() } else { places(judge, &base, &with) },
        which,
        set90,
        cannot_tell_apart,
        unsettled: Vec::new(),
        draws: Vec::new(),
        next_experiment: None,
        next_keys: None,
        next_nats: None,
        next_length_s: None,
        smallest_visible: smallest_visible(judge, variants),
        astray_s: None,
        halves_differ: None,
        picture_period_s: None,
        command_cycle_s: None,
        noise: None,
        calibrated_on: None,
        how_far: far,
    }
}

/// Rivals of a layer. One that is named itself, later, takes nobody's place.
fn rivals<'a>(found: &'a [Layer], layer: &'a Layer) -> impl Iterator<Item = &'a Rival> {
    layer.rivals.iter().filter(|it| !found.iter().any(|layer| layer.weighed.effect == it.effect))
}

/// Of the layers with rivals in this set those that the log cannot tell from them, with these; and whether it tells none from
/// any other.
fn groups(found: &[Layer], set90: &[Vec<String>]) -> (Vec<Vec<String>>, bool) {
    let (mut groups, mut all_alike) = (Vec::new(), true);
    for (i, layer) in found.iter().enumerate() {
        let in_set =
            rivals(found, layer).filter(|it| set90.iter().any(|cause| cause.get(i).is_some_and(|at| at == it.effect)));
        let (alike, others): (Vec<&Rival>, Vec<&Rival>) = in_set.partition(|it| it.apart_nats < SPLIT_NATS);
        all_alike &= others.is_empty();
        if !alike.is_empty() {
            let group = [layer.weighed.effect].into_iter().chain(alike.into_iter().map(|it| it.effect));
            groups.push(group.map(str::to_owned).collect());
        }
    }
    (groups, all_alike)
}

/// By how much a rival is less evident than the layer, in nats.
fn less(layer: &Layer, rival: &Rival) -> f64 {
    layer.weighed.evidence_nats - rival.evidence_nats
}

/// The odds of what is less evident by so much.
fn odds(less_nats: f64) -> f64 {
    exp(-less_nats.min(700.0))
}

/// The layers together; each with a rival in the place of the layer that it rivals; *unknown* and *none*.
fn which(judge: &dyn Judge, found: &[Layer], all: &[Planted], remains: f64, block: Option<&Fitted>) -> Vec<Cause> {
    let total = judge.log_likelihood(all) - judge.log_likelihood(&[]);
    let names: Vec<&str> = found.iter().map(|layer| layer.weighed.effect).collect();
    let rivals: Vec<Vec<(&str, f64)>> =
        found.iter().map(|layer| rivals(found, layer).map(|it| (it.effect, less(layer, it))).collect()).collect();
    let own = rivals.iter().map(|rivals| 1.0 / (1.0 + rivals.iter().map(|it| odds(it.1)).sum::<f64>()));
    let leads = own.product::<f64>() * (1.0 - remains);
    let cause = |names: &[&str], probability: f64, evidence_nats: f64| Cause {
        effects: names.iter().map(|it| (*it).to_owned()).collect(),
        probability,
        evidence_nats,
        adequacy_p: None,
        place: None,
        block: None,
        behaves_like: None,
        parameters: BTreeMap::new(),
    };
    let estimates = |layer: &Layer| Estimate::of(&layer.weighed.best, layer.weighed.interval);
    let place = found.first().map(|layer| layer.weighed.best.variant.place().name().to_owned());
    let mut which = vec![Cause {
        behaves_like: (!found.is_empty()).then(|| names.join("+")),
        block: block.map(|block| block.block.to_owned()),
        ..cause(&[UNKNOWN], remains, block.map_or(0.0, |block| block.evidence_nats))
    }];
    which.push(cause(&[NONE], if found.is_empty() { 1.0 - remains } else { 0.0 }, 0.0));
    if !found.is_empty() {
        let parameters = found.iter().flat_map(estimates).collect();
        which.push(Cause { parameters, place: place.clone(), ..cause(&names, leads, total) });
    }
    for (i, rivals) in rivals.iter().enumerate() {
        for (rival, less) in rivals.iter().filter(|(_, less)| leads * odds(*less) > NEGLIGIBLE) {
            let mut others = names.clone();
            others[i] = rival;
            which.push(Cause { place: place.clone(), ..cause(&others, leads * odds(*less), total - less) });
        }
    }
    which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    which
}

/// The most probable of these, until they have nine tenths of what all of them have.
fn set90<'a>(causes: impl Iterator<Item = &'a Cause>) -> Vec<Vec<String>> {
    likeliest(causes.collect(), |it| it.probability).into_iter().map(|it| it.effects.clone()).collect()
}

/// Of these, the most probable first, the first ones until they have nine tenths of what all of them have.
fn likeliest<T>(ranked: Vec<T>, probability: impl Fn(&T) -> f64) -> Vec<T> {
    let all: f64 = ranked.iter().map(&probability).sum();
    let mut before = 0.0;
    let within = |it: &T| {
        let is_within = before < SURE * all;
        before += probability(it);
        is_within
    };
    ranked.into_iter().take_while(within).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::straight::Straight;
    use crate::weigh::evidence::Weighed;

    /// A lag that may as well be a delay is one answer with it where the log parts the two by nothing, and two where it parts them.
    #[test]
    fn what_a_log_cannot_tell_apart_is_one_answer() {
        let layer = |effect: &'static str, rivals: &[(&'static str, f64)]| {
            let variant = Straight::kind(effect);
            let best = Planted { size: variant.sizes().1, variant };
            let weighed = Weighed { effect, evidence_nats: 40.0, best, gain_nats: 42.0, interval: [0.0, 1.0] };
            let rival = |(effect, apart_nats): &(&'static str, f64)| Rival {
                effect,
                evidence_nats: 39.5,
                apart_nats: *apart_nats,
            };
            Layer { weighed, pays_nats: 2.0, rivals: rivals.iter().map(rival).collect() }
        };
        let of = |apart_nats: f64| [layer("wheel_base", &[]), layer("wheel_lag", &[("command_delay", apart_nats)])];
        let set90 = |found: &[Layer]| {
            let combined = [["wheel_base", "wheel_lag"], ["wheel_base", "command_delay"]];
            groups(found, &combined.map(|it| it.map(str::to_owned).to_vec()))
        };
        assert_eq!(set90(&of(0.4)), (vec![vec!["wheel_lag".to_owned(), "command_delay".to_owned()]], true));
        assert_eq!(set90(&of(9.0)), (Vec::new(), false));
        // One that is so improbable that it is not in the set does not count.
        assert_eq!(groups(&of(9.0), &[vec!["wheel_base".to_owned(), "wheel_lag".to_owned()]]), (Vec::new(), true));
    }
}
