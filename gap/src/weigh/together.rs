//! The sizes of two effects found together, however much one acts like the other.
//!
//! Where an effect is looked at beside another of a fixed size, that size is what the other alone would be likeliest at: much of what
//! the two do together is taken for the other's by then, and what is left may speak against the truth.

use asami_math::elementary::{exp, ln};

use crate::judge::Judge;
use crate::newton::{Curvature, climb};
use crate::plant::{Planted, Variant};
use crate::race::Pace;

/// Two effects, and how likely they make a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Both {
    /// At the sizes found.
    pub planted: [Planted; 2],
    /// Logarithm of the likelihood there.
    pub log_likelihood: f64,
    /// Logarithm of the share of all sizes, by their laws, that are as likely (Laplace).
    pub ln_volume: f64,
    /// Standard deviations of the sizes' logarithms there.
    pub ln_sds: [f64; 2],
}

impl Both {
    /// With 90 % intervals of their sizes, within their laws.
    #[must_use]
    pub fn sized(self) -> [(Planted, [f64; 2]); 2] {
        let [a, b] = self.planted;
        [(a, self.ln_sds[0]), (b, self.ln_sds[1])].map(|(planted, sd)| {
            let (least, greatest) = planted.variant.sizes();
            let interval = [-Z90, Z90].map(|z| (planted.size * exp(z * sd)).clamp(least, greatest));
            (planted, interval)
        })
    }
}

/// Within so many standard deviations lie 90 % of a Gaussian.
const Z90: f64 = 1.644_853_626_951_472_2;

/// Differences are taken over this share of a size.
const DIFFERENCE: f64 = 0.02;
/// And from no size at all, over this share of the least.
const LITTLE: f64 = 0.1;
/// Precision of a prior on logarithms of sizes, which bounds steps in what a log does not show.
const PRECISION: f64 = 0.1;
/// Steps of Newton's method.
const ITERATIONS: usize = 6;
/// A step that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 0.1;

/// Where to look for effects beside a leader: both at the sizes that were likeliest, were the log-likelihood quadratic in them (a
/// score test's, Rao 1948), with the log-likelihood there. Of every effect the best kind, the likeliest first.
#[must_use]
pub fn promising(judge: &dyn Judge, leader: &Planted, others: &[Variant]) -> Vec<(f64, [Planted; 2])> {
    let reading = judge.read(&judge.numbers(std::slice::from_ref(leader)));
    let pace = Pace::of(&reading);
    let here = reading.log_likelihoods;
    let bigger = Planted { size: leader.size * (1.0 + DIFFERENCE), ..leader.clone() };
    let of_leader = per(&judge.terms(&judge.numbers(&[bigger])), &here, DIFFERENCE);
    let start = |variant: &Variant| {
        let (least, greatest) = variant.sizes();
        let little = Planted { variant: variant.clone(), size: LITTLE * least };
        let with_little = judge.terms(&judge.numbers(&[leader.clone(), little]));
        let scores = [of_leader.clone(), per(&with_little, &here, LITTLE * least)];
        let step = Curvature::new(&scores, 0.0)?.step(&scores.each_ref().map(|score| sum(score)));
        let size = (step[1] > 0.0).then(|| step[1].clamp(least, greatest))?;
        let (low, high) = leader.variant.sizes();
        // A second effect that is held at an end of its law takes so much less from the leader.
        let leaders = (leader.size * exp(step[0] * size / step[1])).clamp(low, high);
        let both = [Planted { size: leaders, ..leader.clone() }, Planted { variant: variant.clone(), size }];
        let likely = judge.beside(&judge.numbers(&both), &pace);
        likely.is_finite().then_some((likely, both))
    };
    let mut found: Vec<(f64, [Planted; 2])> = Vec::new();
    for (likely, both) in others.iter().filter(|variant| judge.knows(variant)).filter_map(start) {
        match found.iter_mut().find(|it| it.1[1].variant.about.name == both[1].variant.about.name) {
            Some(known) if known.0 >= likely => {}
            Some(known) => *known = (likely, both),
            None => found.push((likely, both)),
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found
}

/// The likeliest sizes near these, by Newton's method in their logarithms, within their laws; `None` where the log-likelihood has no
/// slope there.
#[must_use]
pub fn climbed(judge: &dyn Judge, from: [Planted; 2]) -> Option<Both> {
    let bounds = from.each_ref().map(|it| {
        let (least, greatest) = it.variant.sizes();
        [ln(least), ln(greatest)]
    });
    let at = |u: [f64; 2]| [0, 1].map(|k| Planted { size: exp(u[k]), ..from[k].clone() });
    let terms = |u: [f64; 2]| judge.terms(&judge.numbers(&at(u)));
    let within = |u: [f64; 2]| [0, 1].map(|k| u[k].clamp(bounds[k][0], bounds[k][1]));
    let mut u = within(from.each_ref().map(|it| ln(it.size)));
    let mut here = terms(u);
    let mut shape = None;
    for _ in 0..ITERATIONS {
        let scores = [0, 1].map(|k| {
            // Towards the inside.
            let by = if u[k] + DIFFERENCE > bounds[k][1] { -DIFFERENCE } else { DIFFERENCE };
            let mut beside = u;
            beside[k] += by;
            per(&terms(beside), &here, by)
        });
        let slope = scores.each_ref().map(|score| sum(score));
        let Some(curvature) = Curvature::new(&scores, PRECISION) else { break };
        let ranges = ln(bounds[0][1] - bounds[0][0]) + ln(bounds[1][1] - bounds[1][0]);
        let ln_volume = (ln(std::f64::consts::TAU) - 0.5 * curvature.ln_determinant() - ranges).min(0.0);
        let variances = curvature.variances();
        shape = Some((ln_volume, [variances[0].sqrt(), variances[1].sqrt()]));
        // What would leave its law stays at its end, and the other moves alone.
        let free = |k: &usize| u[*k] > bounds[*k][0] && slope[*k] < 0.0 || u[*k] < bounds[*k][1] && slope[*k] > 0.0;
        let moves: Vec<usize> = (0..2).filter(free).collect();
        let of_moves: Vec<&[f64]> = moves.iter().map(|k| scores[*k].as_slice()).collect();
        let Some(curvature) = Curvature::new(&of_moves, PRECISION) else { break };
        let step = curvature.step(&moves.iter().map(|k| slope[*k]).collect::<Vec<f64>>());
        let better = climb(sum(&here), &[2.0, 4.0], |share| {
            let mut there = u;
            moves.iter().zip(&step).for_each(|(k, step)| there[*k] += share * step);
            let there = within(there);
            let terms = terms(there);
            (sum(&terms), (there, terms))
        });
        let Some((found, (there, of_there))) = better else { break };
        let gained = found - sum(&here);
        (u, here) = (there, of_there);
        if gained < GAINS_NOTHING_NATS {
            break;
        }
    }
    let (ln_volume, ln_sds) = shape?;
    Some(Both { planted: at(u), log_likelihood: sum(&here), ln_volume, ln_sds })
}

/// What steps gain, by how far one went.
fn per(there: &[f64], here: &[f64], by: f64) -> Vec<f64> {
    there.iter().zip(here).map(|(there, here)| (there - here) / by).collect()
}

fn sum(terms: &[f64]) -> f64 {
    terms.iter().fold(0.0, |sum, it| sum + it)
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    /// Two kinds at shares of their laws, and a log of them, on which they act with a correlation of 0.95.
    fn world(shares: [f64; 2]) -> (Straight, [Planted; 2]) {
        let names = ["focal_error", "height_bias"];
        let truth = [0, 1].map(|k| {
            let variant = Straight::kind(names[k]);
            let (least, greatest) = variant.sizes();
            Planted { size: least + shares[k] * (greatest - least), variant }
        });
        let wave = |t: usize, step: f64| (step * t as f64).sin();
        let first = |t: usize| 3.0 * wave(t, 0.37);
        let second = |t: usize| 3.0 * (0.95 * wave(t, 0.37) + 0.312 * wave(t, 0.91));
        (Straight::new(&truth, &[&first, &second], Seed(7)), truth)
    }

    fn product(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// By least squares.
    fn solved(judge: &Straight, truth: &[Planted; 2]) -> [f64; 2] {
        let [a, b] = truth.each_ref().map(|it| judge.by(&it.variant));
        let (aa, ab, bb) = (product(a, a), product(a, b), product(b, b));
        let (ay, by) = (product(a, &judge.measured), product(b, &judge.measured));
        let determinant = aa * bb - ab * ab;
        [(bb * ay - ab * by) / determinant, (aa * by - ab * ay) / determinant]
    }

    /// What the first alone would be likeliest at.
    fn alone(judge: &Straight, truth: &Planted) -> Planted {
        let (least, greatest) = truth.variant.sizes();
        let by = judge.by(&truth.variant);
        let size = product(by, &judge.measured) / product(by, by);
        Planted { size: size.clamp(least, greatest), ..truth.clone() }
    }

    #[test]
    fn sizes_of_effects_that_act_alike_are_found_together() {
        for shares in [[0.3, 0.6], [0.6, 0.2], [0.4, 0.4]] {
            let (judge, truth) = world(shares);
            let (_, from) = promising(&judge, &alone(&judge, &truth[0]), &[truth[1].variant.clone()]).remove(0);
            let found = climbed(&judge, from).unwrap();
            let solved = judge.read(&solved(&judge, &truth)).total();
            assert!(found.log_likelihood > solved - 0.2, "{shares:?}: {} {solved}", found.log_likelihood);
            for k in 0..2 {
                let off = (found.planted[k].size / truth[k].size).ln().abs();
                assert!(off < 3.5 * found.ln_sds[k], "{shares:?}: {found:?} {truth:?}");
            }
        }
    }

    /// Beside the size that the first alone is likeliest at, even the least of the second speaks against it.
    #[test]
    fn what_a_second_effect_does_is_not_seen_beside_the_first_alone() {
        let (judge, truth) = world([0.5, 0.3]);
        let alone = alone(&judge, &truth[0]);
        let likely = |of: &[Planted]| judge.log_likelihood(of);
        let at_true_size = Planted { size: truth[1].size, ..truth[1].clone() };
        assert!(likely(&[alone.clone(), at_true_size]) < likely(std::slice::from_ref(&alone)) - 10.0);
        let (_, from) = promising(&judge, &alone, &[truth[1].variant.clone()]).remove(0);
        let (found, alone) = (climbed(&judge, from).unwrap(), likely(&[alone]));
        assert!(found.log_likelihood > alone + 5.0, "{alone} {found:?}");
    }

    #[test]
    fn what_would_leave_its_law_stays_at_its_end() {
        let (mut judge, truth) = world([0.5, 0.5]);
        judge.measured.iter_mut().for_each(|it| *it *= 2.5);
        let found = climbed(&judge, truth).unwrap();
        for planted in &found.planted {
            let (_, greatest) = planted.variant.sizes();
            assert!((planted.size / greatest - 1.0).abs() < 1e-12, "{found:?}");
        }
        assert!(found.ln_volume <= 0.0);
    }
}
