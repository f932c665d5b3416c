//! What is believed of sizes that were found together, whatever the noise of a real robot is: their laws, and how the log's
//! likelihood bends about where it is greatest, as far as the score of the log scatters from block to block by no more than it
//! should (Huber 1967, White 1982). Where the noise were what it is taken for, it would not; a real log's tails make it.
//!
//! Sizes that make up for one another leave a ridge, along which a likelihood hardly falls until one of them is at the end of its
//! law: the top may be anywhere on it, and says nothing. Of what is believed the middle counts.

use asami_dataset::Seed;
use asami_math::elementary::ln;
use rand::RngExt;
use rand_distr::StandardNormal;

use crate::judge::Judge;
use crate::newton::Curvature;
use crate::plant::Planted;

/// Scores are differences over such a share of a size.
const DIFFERENCE: f64 = 0.05;
/// How curved the likelihood is is looked at over about a standard deviation, as a share of a size from the least to the greatest:
/// over less, what a reading errs by in the last digits would count.
const AROUND: [f64; 2] = [0.02, 0.5];
/// What a real robot and its sensor err by hangs together for seconds, whatever the filter makes of it: what is said of an
/// effect is weighed by blocks of this length.
const BLOCK_S: f64 = 20.0;
/// Curvature, by shares of a size, of what hardly bends.
const NEXT_TO_NOTHING: f64 = 1e-6;
/// Steps of the random walk among sizes.
const WALK: usize = 60_000;
/// Its first ones, which do not count.
const FIRST: usize = 2_000;
/// The lengths of its steps, over those that suit a Gaussian (Gelman, Roberts and Gilks 1996): shorter ones for a corner of the laws.
const STEPS: [f64; 3] = [1.0, 0.3, 0.1];

/// What is believed of a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Believed {
    /// As probably greater as smaller.
    pub size: f64,
    /// In it with 90 %.
    pub interval: [f64; 2],
}

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

/// What is believed of the sizes of effects, given about where a log is likeliest.
#[must_use]
pub fn believed(judge: &dyn Judge, all: &[Planted]) -> Vec<Believed> {
    let Some(ridge) = Ridge::about(judge, all) else {
        let law = |it: &Planted| Believed { size: it.size, interval: it.variant.sizes().into() };
        return all.iter().map(law).collect();
    };
    let mut walked = ridge.walk(Seed(0));
    let of = |(sizes, middle): (&mut Vec<f64>, &f64)| {
        sizes.sort_by(f64::total_cmp);
        let at = |share: f64| middle * sizes[(share * (sizes.len() - 1) as f64).round() as usize];
        Believed { size: at(0.5), interval: [at(0.05), at(0.95)] }
    };
    walked.iter_mut().zip(&ridge.middle).map(of).collect()
}

/// A likelihood that bends as a Gaussian does, and the laws of the sizes. Sizes are counted in those of its middle.
struct Ridge {
    /// Sizes, somewhere within the laws.
    middle: Vec<f64>,
    /// How it bends.
    curvature: Curvature,
    /// The same, with each law's width for a standard deviation besides: how long steps among sizes are.
    stride: Curvature,
    /// Where it is greatest, be it beyond the laws.
    top: Vec<f64>,
    /// By how much more widely than that sizes scatter.
    wider: Vec<f64>,
    /// The laws' ends.
    laws: Vec<[f64; 2]>,
}

impl Ridge {
    /// The likelihood about these sizes; `None` where it is not finite.
    fn about(judge: &dyn Judge, all: &[Planted]) -> Option<Self> {
        let terms = |all: &[Planted], by: &[(usize, f64)]| {
            let mut there = all.to_vec();
            by.iter().for_each(|(i, by)| there[*i].size *= 1.0 + by);
            judge.terms(&judge.numbers(&there))
        };
        let near: Vec<Planted> = all.iter().map(|it| inside(it, DIFFERENCE)).collect();
        let score = |i: usize| -> Vec<f64> {
            let [above, below] = [DIFFERENCE, -DIFFERENCE].map(|by| terms(&near, &[(i, by)]));
            above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * DIFFERENCE)).collect()
        };
        let scores: Vec<Vec<f64>> = (0..all.len()).map(score).collect();
        let by_scores = Curvature::new(&scores, NEXT_TO_NOTHING)?;
        let around: Vec<f64> =
            by_scores.variances().into_iter().map(|it| it.sqrt().clamp(AROUND[0], AROUND[1])).collect();
        let middle: Vec<Planted> = all.iter().zip(&around).map(|(it, by)| inside(it, *by)).collect();
        let likely = |by: &[(usize, f64)]| terms(&middle, by).into_iter().fold(0.0, |sum, it| sum + it);
        let (slope, bent) = bent(likely, &around);
        // Where it bends upwards somewhere, the scores say how curved it is.
        let curvature = Curvature::of(&bent).unwrap_or(by_scores);
        let scattered = curvature.variances_by_block(&scores, &blocks(judge));
        // Blocks are few: that errors in one made up for one another is not believed.
        let wider =
            scattered.iter().zip(curvature.variances()).map(|(scattered, bent)| (scattered / bent).max(1.0).sqrt());
        let law = |it: &Planted| {
            let (least, greatest) = it.variant.sizes();
            [least / it.size, greatest / it.size]
        };
        let laws: Vec<[f64; 2]> = middle.iter().map(law).collect();
        let widths = laws.iter().map(|[least, greatest]| (greatest - least).max(1e-9).powi(-2));
        Some(Self {
            stride: curvature.with(&widths.collect::<Vec<_>>())?,
            top: curvature.step(&slope).into_iter().map(|step| 1.0 + step).collect(),
            wider: wider.collect(),
            curvature,
            laws,
            middle: middle.into_iter().map(|it| it.size).collect(),
        })
    }

    /// Logarithm of the density of what is believed, less what is the same everywhere: laws are even in a size's logarithm.
    fn density(&self, sizes: &[f64]) -> f64 {
        let within = sizes.iter().zip(&self.laws).all(|(size, [least, greatest])| (least..=greatest).contains(&size));
        if !within {
            return f64::NEG_INFINITY;
        }
        let off = sizes.iter().zip(&self.top).zip(&self.wider).map(|((size, top), wider)| (size - top) / wider);
        let squares = self.curvature.squared(&off.collect::<Vec<_>>());
        -0.5 * squares - sizes.iter().fold(0.0, |sum, size| sum + ln(*size))
    }

    /// Sizes as they are believed: of each where a random walk among all comes by (Metropolis et al. 1953).
    fn walk(&self, seed: Seed) -> Vec<Vec<f64>> {
        let mut rng = seed.stream("sizes as they are believed");
        let mut here = vec![1.0; self.middle.len()];
        let mut density = self.density(&here);
        let mut walked = vec![Vec::with_capacity(WALK); here.len()];
        let suits = 2.38 / (here.len() as f64).sqrt();
        for step in 0..FIRST + WALK {
            let standard: Vec<f64> = here.iter().map(|_| rng.sample(StandardNormal)).collect();
            let by = self.stride.drawn(&standard);
            let long = suits * STEPS[step % STEPS.len()];
            let there: Vec<f64> =
                here.iter().zip(by.iter().zip(&self.wider)).map(|(at, (by, wider))| at + long * wider * by).collect();
            let of_there = self.density(&there);
            if ln(rng.random::<f64>()) < of_there - density {
                (here, density) = (there, of_there);
            }
            if step >= FIRST {
                walked.iter_mut().zip(&here).for_each(|(walked, at)| walked.push(*at));
            }
        }
        walked
    }
}

/// The slope, and minus the second derivatives, of what is `likely` where some are changed by so much, over so much `around`.
fn bent(likely: impl Fn(&[(usize, f64)]) -> f64, around: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let here = likely(&[]);
    let sides = |i: usize, j: Option<usize>| {
        let by = |side: f64| [Some(i), j].into_iter().flatten().map(|k| (k, side * around[k])).collect::<Vec<_>>();
        [likely(&by(1.0)) - here, likely(&by(-1.0)) - here]
    };
    let alone: Vec<[f64; 2]> = (0..around.len()).map(|i| sides(i, None)).collect();
    let both: Vec<f64> = alone.iter().map(|[above, below]| above + below).collect();
    let slope = alone.iter().zip(around).map(|([above, below], by)| (above - below) / (2.0 * by)).collect();
    let mut bent = vec![vec![0.0; around.len()]; around.len()];
    for i in 0..around.len() {
        bent[i][i] = -both[i] / (around[i] * around[i]);
        for j in 0..i {
            let [above, below] = sides(i, Some(j));
            bent[i][j] = -(above + below - both[i] - both[j]) / (2.0 * around[i] * around[j]);
            bent[j][i] = bent[i][j];
        }
    }
    (slope, bent)
}

/// Where such a share of it more stays within the law.
fn inside(it: &Planted, by: f64) -> Planted {
    let (least, greatest) = it.variant.sizes();
    Planted { size: it.size.min(greatest / (1.0 + by)).max(least), ..it.clone() }
}

#[cfg(test)]
mod tests {
    use asami_math::elementary::exp;

    use super::*;
    use crate::straight::Straight;

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
            believed(judge, &truth).into_iter().map(relative).collect::<Vec<f64>>()
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
        let Believed { size, interval: [low, high] } = believed(&nothing, &truth)[0];
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
        let found = believed(&log, &of(best));
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
}
