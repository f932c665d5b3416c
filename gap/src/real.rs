//! The diagnosis of a real robot's log: how noisy it is, then everything that parts it from the nominal world, the largest
//! first.

use std::collections::BTreeMap;

use asami_dataset::Log;
use asami_math::elementary::exp;
use asami_sim::effect::{Block, Place};

use crate::aside::Aside;
use crate::blocks::{self, Fitted};
use crate::calibration::{NONE, UNKNOWN};
use crate::diagnosis::{Cause, Diagnosis, Estimate, HowFar, SCHEMA, Verdict};
use crate::how_far::how_far;
use crate::judge::Judge;
use crate::layers::{Layer, layers, planted};
use crate::library::Library;
use crate::place::places;
use crate::plant::{Planted, Variant};
use crate::sighted::Sighted;
use crate::view::CannotSee;

/// Noise is learned, effects are named, and again, for the noise is what the effects leave; the likeliest of these counts.
const ROUNDS: usize = 4;
/// An effect that is less evident is not named, in nats.
const LEAST_NATS: f64 = 10.0;
/// Nor one that adds less than this share to what those before it explain: so much may as well be what the nominal world's
/// own shape, or the library, is off.
const LEAST_SHARE: f64 = 0.01;
/// Where more of the gap than this remains with every effect in, something is unknown.
const MOST_REMAINS: f64 = 0.3;
/// Causes less probable than this are left out.
const NEGLIGIBLE: f64 = 1e-3;

/// Diagnoses a log of a real robot. Effects of noise are not thought of: what is set aside says how large it is.
///
/// Probabilities are by layer: of an effect, its evidence over that of the others beside those before it. The probability of
/// *unknown* is the share of the gap that remains.
///
/// # Errors
/// [`CannotSee`] says what the log lacks.
pub fn diagnose(library: &Library, variants: &[Variant], log: &Log) -> Result<Diagnosis, CannotSee> {
    // A single landmark that stands elsewhere is a robot that does.
    let shows = |it: &&Variant| it.place() != Place::Scene || library.base.shape.landmarks > 1;
    let variants: Vec<Variant> =
        variants.iter().filter(|it| it.block() != Block::Noise).filter(shows).cloned().collect();
    let aside = Aside::default();
    let mut best: Option<(f64, Library, Vec<Layer>)> = None;
    let mut found: Vec<Layer> = Vec::new();
    for _ in 0..ROUNDS {
        let noisy = library.noisy_as(log, aside, &planted(&found))?;
        let judge = Sighted::new(log, &noisy)?;
        found = layers(&judge, &variants, LEAST_NATS, LEAST_SHARE);
        // Of what is not set aside: no noise was fitted to it.
        let likely = judge.log_likelihood(&planted(&found));
        if best.as_ref().is_none_or(|(most, _, _)| likely > *most) {
            best = Some((likely, noisy, found.clone()));
        }
    }
    let (noisy, found) = best.map_or_else(|| (library.clone(), Vec::new()), |(_, noisy, found)| (noisy, found));
    let judge = Sighted::new(log, &noisy)?;
    Ok(assembled(&judge, &found))
}

fn assembled(judge: &dyn Judge, found: &[Layer]) -> Diagnosis {
    let all = planted(found);
    let (base, with) = (judge.numbers(&[]), judge.numbers(&all));
    let far = if found.is_empty() { HowFar::default() } else { how_far(judge, &all) };
    let remains = if far.excess_before > 0.0 { (far.excess_after / far.excess_before).clamp(0.0, 1.0) } else { 0.0 };
    let blocks = blocks::fit(judge, &with, &|_| true);
    let block = blocks.into_iter().reduce(|a, b| if b.evidence_nats > a.evidence_nats { b } else { a });
    let unknown = remains > MOST_REMAINS;
    let which = which(judge, found, remains, block.as_ref());
    let named = |cause: &&Cause| cause.effects[0] != UNKNOWN && cause.effects[0] != NONE;
    let set90 = set90(which.iter().filter(named));
    let verdict = match (found.is_empty(), unknown, set90.len()) {
        (true, _, _) => Verdict::None,
        (_, true, _) => Verdict::Unknown,
        (_, _, 0 | 1) => Verdict::Named,
        _ => Verdict::Tied,
    };
    let places = if found.is_empty() { Vec::new() } else { places(judge, &base, &with) };
    Diagnosis {
        schema: SCHEMA,
        verdict,
        places,
        which,
        set90,
        cannot_tell_apart: Vec::new(),
        next_experiment: None,
        next_keys: None,
        smallest_visible: BTreeMap::new(),
        calibrated_on: None,
        how_far: far,
    }
}

/// The layers together; each with a rival in the place of the layer that it rivals; *unknown* and *none*.
fn which(judge: &dyn Judge, found: &[Layer], remains: f64, block: Option<&Fitted>) -> Vec<Cause> {
    let total = judge.log_likelihood(&planted(found)) - judge.log_likelihood(&[]);
    let names: Vec<&str> = found.iter().map(|layer| layer.weighed.effect).collect();
    let odds: Vec<Vec<(&str, f64)>> = found
        .iter()
        .map(|layer| {
            let of =
                |(name, nats): &(&'static str, f64)| (*name, exp((nats - layer.weighed.evidence_nats).max(-700.0)));
            // A rival that is named itself, later, takes nobody's place.
            layer.rivals.iter().filter(|(name, _)| !names.contains(name)).map(of).collect()
        })
        .collect();
    let own: Vec<f64> = odds.iter().map(|odds| 1.0 / (1.0 + odds.iter().map(|it| it.1).sum::<f64>())).collect();
    let leads = own.iter().product::<f64>() * (1.0 - remains);
    let parameters = |planted: &Planted, interval: [f64; 2]| Estimate::of(planted, interval);
    let cause = |names: &[&str], probability: f64, own: bool| Cause {
        effects: names.iter().map(|it| (*it).to_owned()).collect(),
        probability,
        evidence_nats: if own { total } else { 0.0 },
        adequacy_p: None,
        place: found.first().map(|layer| layer.weighed.best.variant.place().name().to_owned()),
        block: None,
        behaves_like: None,
        parameters: found
            .iter()
            .filter(|layer| own && names.contains(&layer.weighed.effect))
            .flat_map(|layer| parameters(&layer.weighed.best, layer.weighed.interval))
            .collect(),
    };
    let mut which = Vec::new();
    if found.is_empty() {
        which.push(Cause { probability: 1.0 - remains, ..cause(&[NONE], 0.0, false) });
    } else {
        which.push(cause(&names, leads, true));
        for (i, odds) in odds.iter().enumerate() {
            for (rival, odds) in odds.iter().filter(|(_, odds)| leads * odds > NEGLIGIBLE) {
                let mut others = names.clone();
                others[i] = rival;
                which.push(cause(&others, leads * odds, false));
            }
        }
        which.push(cause(&[NONE], 0.0, false));
    }
    which.push(Cause {
        evidence_nats: block.map_or(0.0, |block| block.evidence_nats),
        block: block.map(|block| block.block.to_owned()),
        behaves_like: (!found.is_empty()).then(|| names.join("+")),
        ..cause(&[UNKNOWN], remains, false)
    });
    which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    which
}

/// The most probable of these, until they have nine tenths of what all of them have.
fn set90<'a>(causes: impl Iterator<Item = &'a Cause>) -> Vec<Vec<String>> {
    let causes: Vec<&Cause> = causes.collect();
    let all: f64 = causes.iter().map(|it| it.probability).sum();
    let before = causes.iter().scan(0.0, |so_far, it| {
        let before = *so_far;
        *so_far += it.probability;
        Some(before)
    });
    causes.iter().zip(before).take_while(|(_, before)| *before < 0.9 * all).map(|(it, _)| it.effects.clone()).collect()
}
