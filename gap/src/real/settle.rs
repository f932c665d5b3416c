//! Sizes of effects that are in a world together, where they are likeliest.

use super::unsure::blocks;
use crate::judge::Judge;
use crate::newton::{Curvature, climb};
use crate::plant::Planted;
use crate::weigh::cores::on_free_cores;

/// Steps of Newton's method.
const STEPS: usize = 8;
/// A step that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 0.05;
/// Differences are taken over such a share of a size.
const DIFFERENCE: f64 = 0.02;
/// No step changes a size by more than so many times what it is.
const LONGEST: f64 = 4.0;
/// Precision of a prior that leaves a size which changes nothing where it is.
const NEXT_TO_NOTHING: f64 = 1e-3;

/// Effects with their sizes found together.
pub struct Settled {
    /// At their most likely sizes.
    pub effects: Vec<Planted>,
    /// The log-likelihood there.
    pub likely: f64,
    /// What counts of a nat that each of them gains: its variance as steps have it over that as blocks do (Pauli, Racugno and
    /// Ventura 2011).
    pub counts: Vec<f64>,
}

impl Settled {
    /// What counts of a nat that the last of them gains.
    pub fn last_counts(&self) -> f64 {
        self.counts.last().copied().unwrap_or(1.0)
    }
}

/// Finds all sizes together, by Newton's method. Steps are along sizes and not their logarithms: where effects make up for one another they do
/// so along a straight line, which a step has to stay on.
pub fn settle(judge: &dyn Judge, mut all: Vec<Planted>) -> Settled {
    let block = blocks(judge);
    let terms = |all: &[Planted]| judge.terms(&judge.numbers(all));
    let mut here = terms(&all);
    let mut counts = vec![1.0; all.len()];
    let mut bends = vec![None; all.len()];
    for _ in 0..STEPS {
        let of_each = bends.into_iter().enumerate().collect();
        let slopes = on_free_cores(of_each, |(i, bends)| Slope::of(judge, &all, i, &here, bends));
        let (scores, known): (Vec<Vec<f64>>, Vec<_>) = slopes.into_iter().map(|it| (it.score, it.bends)).unzip();
        bends = known;
        let Some(curvature) = Curvature::new(&scores, NEXT_TO_NOTHING) else { break };
        let step = curvature.step(&scores.iter().map(|score| total(score)).collect::<Vec<f64>>());
        let longest = step.iter().fold(LONGEST, |longest, it| longest.max(it.abs()));
        let step: Vec<f64> = step.into_iter().map(|it| it * LONGEST / longest).collect();
        let by_block = curvature.variances_by_block(&scores, &block).into_iter();
        // Blocks are few: that errors in one made up for one another is not believed.
        counts =
            by_block.zip(curvature.variances()).map(|(by_block, by_step)| by_step / by_block.max(by_step)).collect();
        let before = total(&here);
        let better = climb(before, &[2.0], |share| {
            let mut there = all.clone();
            for (planted, step) in there.iter_mut().zip(&step) {
                let (least, greatest) = planted.variant.sizes();
                planted.size = (planted.size * (1.0 + share * step)).clamp(least, greatest);
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

/// How steep the log-likelihood is in a size, by shares of it, and how it bends.
struct Slope {
    /// By step.
    score: Vec<f64>,
    /// Second derivatives, by sizes and by step, where it has been looked at.
    bends: Option<Vec<f64>>,
}

impl Slope {
    /// In one of these sizes, where steps are as likely as `here`. On a narrow ridge a difference to one side is mostly what lies between,
    /// by which the likelihood bends: where that is not known yet, both sides are looked at.
    fn of(judge: &dyn Judge, all: &[Planted], i: usize, here: &[f64], bends: Option<Vec<f64>>) -> Self {
        let size = all[i].size;
        let per_share = |by: f64| -> Vec<f64> {
            let mut beside = all.to_vec();
            beside[i].size *= 1.0 + by;
            let there = judge.terms(&judge.numbers(&beside));
            there.iter().zip(here).map(|(there, here)| (there - here) / by).collect()
        };
        // No size is above the greatest of its law.
        let at_end = size * (1.0 + DIFFERENCE) > all[i].variant.sizes().1;
        let by = if at_end { -DIFFERENCE } else { DIFFERENCE };
        let side = per_share(by);
        let looked_at = || -> Vec<f64> {
            side.iter().zip(per_share(-by)).map(|(side, other)| (side - other) / (by * size * size)).collect()
        };
        let bends = bends.or_else(|| (!at_end).then(looked_at));
        let between = |step: usize| bends.as_ref().map_or(0.0, |bends| 0.5 * by * size * size * bends[step]);
        let score = side.iter().enumerate().map(|(step, side)| side - between(step)).collect();
        Self { score, bends }
    }
}

fn total(terms: &[f64]) -> f64 {
    terms.iter().fold(0.0, |sum, it| sum + it)
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    /// Two effects that nearly undo each other lie on a narrow ridge, straight in their sizes. From one end of it the top is found, four and
    /// thirty times as large.
    #[test]
    fn a_narrow_ridge_is_followed_to_its_top() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |shares: [f64; 2]| -> Vec<Planted> {
            let sized = kinds.iter().zip(shares);
            sized
                .map(|(kind, share)| Planted {
                    variant: kind.clone().of_sizes_from(0.01),
                    size: share * kind.sizes().1,
                })
                .collect()
        };
        let (a, b) = (|t: usize| 60.0 * (0.37 * t as f64).sin(), |t: usize| 3.0 * (0.91 * t as f64).sin());
        for seed in 0..10 {
            let log = Straight::new(&of([0.5, 0.38]), &[&a, &|t| b(t) - a(t)], Seed(seed));
            let top = settle(&log, of([0.5, 0.38]));
            let from_afar = settle(&log, of([0.1325, 0.0125]));
            assert!(top.likely - from_afar.likely < 0.1, "{seed}: {} and {}", top.likely, from_afar.likely);
            for (top, it) in top.effects.iter().zip(&from_afar.effects) {
                assert!((it.size / top.size - 1.0).abs() < 0.02, "{seed}: {} and {}", it.size, top.size);
            }
        }
    }
}
