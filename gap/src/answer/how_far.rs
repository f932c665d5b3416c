//! How far the gap shrinks once an effect is added, on blocks that no fit has seen.

use std::collections::BTreeMap;

use asami_dataset::Seed;
use asami_math::elementary::{exp, ln};
use asami_math::optimise::golden_section;
use rand::RngExt;

use crate::answer::diagnosis::{HowFar, Rms};
use crate::blocks;
use crate::judge::{Judge, Reading};
use crate::plant::Planted;

/// Resamples of the bootstrap.
const RESAMPLES: usize = 1000;

/// Gains of one held-out block, in nats.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    before: f64,
    after: f64,
    seen: f64,
}

/// The gap in the nominal world and with `planted` in it.
#[must_use]
pub fn how_far(judge: &dyn Judge, planted: &[Planted]) -> HowFar {
    let base = &judge.numbers(&[]);
    let mut held: Vec<Block> = Vec::new();
    for fold in 0..2 {
        let of = |held: bool| move |i: usize| place(judge, i).is_some_and(|(block, _)| (block % 2 == fold) == held);
        let train = of(false);
        let refitted = refit(judge, planted, &train);
        let named = judge.numbers(&refitted);
        let flexible = blocks::fit(judge, &named, &train);
        let better = flexible.into_iter().filter(|it| it.evidence_nats > 0.0);
        let best = better.reduce(|a, b| if b.evidence_nats > a.evidence_nats { b } else { a });
        let reference = best.map_or_else(|| named.clone(), |it| it.numbers);
        let [before, after, reference] = [base, &named, &reference].map(|numbers| judge.read(numbers));
        gather(judge, fold, [&before, &after, &reference], &mut held);
    }
    held.retain(|block| block.seen > 0.0);
    summary(judge, planted, &held)
}

/// Which block a scored step is in, and whether it counts.
fn place(judge: &dyn Judge, i: usize) -> Option<(usize, bool)> {
    let first_s = judge.steps().first()?.t_s;
    let since_s = judge.steps().get(i)?.t_s - first_s;
    let (block_s, guard_s) = judge.held_out_s();
    let within_s = since_s % block_s;
    Some(((since_s / block_s) as usize, (guard_s..block_s - guard_s).contains(&within_s)))
}

/// The sizes that fit the training blocks best.
fn refit(judge: &dyn Judge, planted: &[Planted], of: &dyn Fn(usize) -> bool) -> Vec<Planted> {
    let mut found = planted.to_vec();
    for i in 0..found.len() {
        let (least, greatest) = found[i].variant.sizes();
        let around = ln(found[i].size);
        let likely = |ln_size: f64| {
            let mut there = found.clone();
            there[i].size = exp(ln_size);
            let terms = judge.read(&judge.numbers(&there)).log_likelihoods;
            -terms.iter().enumerate().filter(|(i, _)| of(*i)).fold(0.0, |sum, (_, it)| sum + it)
        };
        let ends = [around - 0.7, around + 0.7].map(|it| it.clamp(ln(least), ln(greatest)));
        found[i].size = exp(golden_section(likely, ends[0], ends[1], 0.01).x);
    }
    found
}

/// Adds a fold's held-out blocks: by how much the reference is more likely than each.
fn gather(judge: &dyn Judge, fold: usize, [before, after, reference]: [&Reading; 3], held: &mut Vec<Block>) {
    let steps = judge.steps().iter().enumerate();
    for (i, step) in steps {
        let Some((block, counts)) = place(judge, i) else { continue };
        if block % 2 != fold || !counts {
            continue;
        }
        if held.len() <= block {
            held.resize(block + 1, Block::default());
        }
        let here = reference.log_likelihoods[i];
        held[block].before += here - before.log_likelihoods[i];
        held[block].after += here - after.log_likelihoods[i];
        held[block].seen += step.seen as f64;
    }
}

fn summary(judge: &dyn Judge, planted: &[Planted], held: &[Block]) -> HowFar {
    let mean = |of: &[Block], what: fn(&Block) -> f64| {
        let seen: f64 = of.iter().map(|it| it.seen).sum();
        of.iter().map(what).sum::<f64>() / seen.max(1.0)
    };
    let before = |it: &Block| it.before;
    let after = |it: &Block| it.after;
    let mut rng = Seed(0).stream("gap/how_far");
    let mut resampled: Vec<(f64, f64)> = (0..if held.is_empty() { 0 } else { RESAMPLES })
        .map(|_| {
            let sample: Vec<Block> = held.iter().map(|_| held[rng.random_range(0..held.len())]).collect();
            (mean(&sample, before), 1.0 - mean(&sample, after) / mean(&sample, before))
        })
        .collect();
    resampled.sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = resampled.len() as f64 - 1.0;
    let at = |share: f64| (last * share).max(0.0) as usize;
    let shows = resampled.get(at(0.025)).is_some_and(|(excess, _)| *excess > 0.0);
    resampled.sort_by(|a, b| a.1.total_cmp(&b.1));
    let interval = [0.025, 0.975].map(|share| resampled.get(at(share)).map_or(0.0, |it| it.1));
    let base = judge.read(&judge.numbers(&[]));
    let with = judge.read(&judge.numbers(planted));
    let comment = if shows && !planted.is_empty() {
        format!(
            "nats per sighting on held-out blocks of {} s, against the named effect with the best flexible block on top",
            judge.held_out_s().0
        )
    } else {
        "closed is null: nothing was added, or the excess before cannot be told from 0".to_owned()
    };
    let closed = shows && !planted.is_empty();
    HowFar {
        comment,
        excess_before: mean(held, before),
        excess_after: mean(held, after),
        misfit_before: misfit(&base),
        misfit_after: misfit(&with),
        closed: closed.then(|| 1.0 - mean(held, after) / mean(held, before)),
        interval: closed.then_some(interval),
        channels: channels(judge.measured(), &base, &with),
    }
}

/// Mean of `-log p(o_t | past) - h_t` over what was seen.
#[must_use]
pub fn misfit(reading: &Reading) -> f64 {
    let off = reading.log_likelihoods.iter().zip(&reading.expected).map(|(it, expected)| -it - expected);
    off.fold(0.0, |sum, it| sum + it) / reading.observations.max(1) as f64
}

/// Root mean squares of the same innovations in both: what is far off in one world is no mistaken sighting where it is not in
/// the other.
fn channels(measured: Vec<&'static str>, base: &Reading, with: &Reading) -> BTreeMap<String, Rms> {
    let pairs = base.innovations.iter().zip(&with.innovations).filter(|(a, b)| a.genuine || b.genuine);
    let pairs: Vec<_> = pairs.filter(|(a, b)| a.plain.is_finite() && b.plain.is_finite()).collect();
    let of = |channel: usize| {
        let own: Vec<[f64; 2]> =
            pairs.iter().filter(|(a, _)| a.channel == channel).map(|(a, b)| [a.plain, b.plain]).collect();
        let rms =
            |k: usize| (own.iter().fold(0.0, |sum, it| sum + it[k] * it[k]) / f64::max(own.len() as f64, 1.0)).sqrt();
        Rms { rms_before: rms(0), rms_after: rms(1) }
    };
    measured.into_iter().enumerate().map(|(channel, name)| (name.to_owned(), of(channel))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::Innovation;

    fn reading(plain: &[(f64, bool)]) -> Reading {
        let of =
            |&(plain, genuine): &(f64, bool)| Innovation { channel: 0, plain, white: plain, ln_scale: 0.0, genuine };
        Reading { innovations: plain.iter().map(of).collect(), ..Reading::default() }
    }

    /// A world that is far off takes most of what it sees for mistakes: its few hits alone say nothing of how far off it is.
    #[test]
    fn innovations_are_told_of_the_same_sightings_before_and_after() {
        let before = reading(&[(3.0, false), (-3.0, false), (0.1, true), (50.0, false), (f64::NAN, false)]);
        let after = reading(&[(0.2, true), (-0.2, true), (0.2, true), (50.0, false), (0.2, true)]);
        let rms = channels(vec!["size"], &before, &after)["size"];
        assert!((rms.rms_before - (18.01_f64 / 3.0).sqrt()).abs() < 1e-12, "{rms:?}");
        assert!((rms.rms_after - 0.2).abs() < 1e-12, "{rms:?}");
    }
}
