//! Many effects at once, one after another: what parts a real log from a nominal world is rarely one thing.
//!
//! Of all effects that with the greatest evidence is put into the world, then of the others that with the greatest evidence
//! beside it, and so on. Before they are compared, the sizes of all that is in the world are found together: effects that act
//! much alike hide one another as long as each is looked at by itself.

use asami_math::elementary::{exp, ln};

use crate::evidence::{CLOSE, Weighed, weigh};
use crate::judge::Judge;
use crate::newton::{Curvature, climb};
use crate::plant::{Planted, Variant};

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
/// Half of a Gaussian's middle 90 %, in standard deviations.
const NINETY: f64 = 1.645;

/// An effect, and what it was held against.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The effect, its evidence over those before it alone.
    pub weighed: Weighed,
    /// Other effects in its place, with their evidence, the most evident first.
    pub rivals: Vec<(&'static str, f64)>,
}

/// Effects one after another, for as long as the next has an evidence of `least_nats` and more, and so much a share of what
/// all so far have gained.
#[must_use]
pub fn layers(judge: &dyn Judge, variants: &[Variant], least_nats: f64, least_share: f64) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    let none = judge.log_likelihood(&[]);
    while layers.len() < MOST {
        let with = planted(&layers);
        let likely = judge.log_likelihood(&with);
        let mut tried = next(judge, variants, &with, likely).into_iter();
        let Some((best, settled)) = tried.next() else { break };
        if best.evidence_nats < least_nats.max(least_share * (likely - none)) {
            break;
        }
        let rivals = tried.map(|(it, _)| (it.effect, it.evidence_nats)).collect();
        layers.push(Layer { weighed: best, rivals });
        for (layer, (best, interval)) in layers.iter_mut().zip(settled) {
            (layer.weighed.best, layer.weighed.interval) = (best, interval);
        }
    }
    layers
}

/// The effects at their most likely sizes.
#[must_use]
pub fn planted(layers: &[Layer]) -> Vec<Planted> {
    layers.iter().map(|layer| layer.weighed.best.clone()).collect()
}

/// Effects at their most likely sizes, with 90 % intervals.
type Settled = Vec<(Planted, [f64; 2])>;

/// What may be put beside what is in the world, the most evident first, each with the sizes of all found together.
fn next(judge: &dyn Judge, variants: &[Variant], with: &[Planted], likely: f64) -> Vec<(Weighed, Settled)> {
    let new = |it: &&Variant| !with.iter().any(|planted| planted.variant.about.name == it.about.name);
    let others: Vec<Variant> = variants.iter().filter(new).cloned().collect();
    let mut weighed = weigh(judge, &others, with, CLOSE);
    weighed.sort_by(|a, b| b.evidence_nats.total_cmp(&a.evidence_nats));
    let try_it = |mut it: Weighed| {
        let all = [with, std::slice::from_ref(&it.best)].concat();
        let (settled, found) = settle(judge, all);
        // What it pays for its size stays what it is.
        let paid = it.evidence_nats - it.gain_nats;
        it.gain_nats = found - likely;
        it.evidence_nats = it.gain_nats + paid;
        (it, settled)
    };
    let worth = weighed.into_iter().take(TRIED).filter(|it| it.gain_nats > LEAST_ALONE_NATS);
    let mut tried: Vec<(Weighed, Settled)> = worth.map(try_it).collect();
    tried.sort_by(|a, b| b.0.evidence_nats.total_cmp(&a.0.evidence_nats));
    tried
}

/// Finds all sizes together, by Newton's method on their logarithms; and the log-likelihood there.
fn settle(judge: &dyn Judge, mut all: Vec<Planted>) -> (Settled, f64) {
    let terms = |all: &[Planted]| judge.terms(&judge.numbers(all));
    let total = |terms: &[f64]| terms.iter().fold(0.0, |sum, it| sum + it);
    let mut here = terms(&all);
    let mut sds = vec![f64::NAN; all.len()];
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
        sds = curvature.variances().into_iter().map(f64::sqrt).collect();
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
    let found = total(&here);
    let with_interval = |(planted, sd): (Planted, f64)| {
        let (least, greatest) = planted.variant.sizes();
        let within = if sd.is_finite() { NINETY * sd } else { f64::INFINITY };
        let ends = [-within, within].map(|it| (planted.size * exp(it)).clamp(least, greatest));
        (planted, ends)
    };
    (all.into_iter().zip(sds).map(with_interval).collect(), found)
}
