//! A likelihood about its top, within the laws of the sizes, and a random walk on it.

use asami_dataset::Seed;
use asami_math::elementary::ln;
use asami_math::regression::least_squares;
use rand::RngExt;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use crate::judge::Judge;
use crate::newton::Curvature;
use crate::plant::Planted;

/// Scores are differences over such a share of a size.
const DIFFERENCE: f64 = 0.05;
/// How curved the likelihood is is looked at over about a standard deviation, as a share of a size from the least to the greatest:
/// over less, what a reading errs by in the last digits would count.
const AROUND: [f64; 2] = [0.02, 0.5];
/// Curvature, by shares of a size, of what hardly bends.
const NEXT_TO_NOTHING: f64 = 1e-6;
/// Steps of the random walk among sizes.
const WALK: usize = 60_000;
/// Its first ones, which do not count.
const FIRST: usize = 2_000;
/// The lengths of its steps, over those that suit a Gaussian (Gelman, Roberts and Gilks 1996): shorter ones for a corner of the laws.
const STEPS: [f64; 3] = [1.0, 0.3, 0.1];
/// So many times the likelihood is looked at where sizes are believed to be.
const LOOKS: u64 = 3;

/// A likelihood that bends as a Gaussian does, and the laws of the sizes. Sizes are counted in those of its middle.
pub struct Ridge {
    /// Sizes, somewhere within the laws.
    pub middle: Vec<f64>,
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
    /// Scores of steps, of each size, and the blocks of these steps.
    scores: Vec<Vec<f64>>,
    block: Vec<usize>,
}

impl Ridge {
    /// The likelihood about these sizes, of steps in such blocks; `None` where it is not finite.
    pub fn about(judge: &dyn Judge, all: &[Planted], block: Vec<usize>) -> Option<Self> {
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
        let law = |it: &Planted| {
            let (least, greatest) = it.variant.sizes();
            [least / it.size, greatest / it.size]
        };
        let laws: Vec<[f64; 2]> = middle.iter().map(law).collect();
        Some(Self {
            stride: curvature.with(&precisions(&laws))?,
            top: curvature.step(&slope).into_iter().map(|step| 1.0 + step).collect(),
            wider: wider(&curvature, &scores, &block),
            scores,
            block,
            curvature,
            laws,
            middle: middle.into_iter().map(|it| it.size).collect(),
        })
    }

    /// The same, bent as the likelihood is wherever sizes are believed to be: by least squares in what it is there. About one point it
    /// may bend as it does nowhere else, where that is at the end of a law, or noise has tails.
    #[must_use]
    pub fn looked_at(mut self, judge: &dyn Judge, all: &[Planted]) -> Self {
        let likely = |sizes: &Vec<f64>| {
            let there = all.iter().zip(sizes.iter().zip(&self.middle));
            let there = there.map(|(it, (size, middle))| Planted { size: size * middle, ..it.clone() });
            judge.log_likelihood(&there.collect::<Vec<_>>())
        };
        let given = all.iter().zip(&self.middle).map(|(it, middle)| it.size / middle).collect();
        let mut seen = vec![given, vec![1.0; all.len()]];
        let mut found: Vec<f64> = seen.iter().map(likely).collect();
        let each = 2 * bends(&self.middle).len();
        for look in 1..=LOOKS {
            let walked = self.walk(Seed(look));
            let at = |k: usize| walked.iter().map(|sizes| sizes[k * (WALK / each)]).collect::<Vec<f64>>();
            let more: Vec<Vec<f64>> = (0..each).map(at).collect();
            found.extend(more.par_iter().map(likely).collect::<Vec<f64>>());
            seen.extend(more);
            let Some((curvature, top)) = self.through(&seen, &found) else { break };
            let Some(stride) = curvature.with(&precisions(&self.laws)) else { break };
            self.wider = wider(&curvature, &self.scores, &self.block);
            (self.curvature, self.stride, self.top) = (curvature, stride, top);
        }
        self
    }

    /// Curvature and top of the Gaussian that is nearest to what was found at the sizes that were seen: what is far less likely
    /// than the likeliest counts less.
    fn through(&self, seen: &[Vec<f64>], found: &[f64]) -> Option<(Curvature, Vec<f64>)> {
        let n = self.middle.len();
        let units: Vec<f64> =
            self.curvature.variances().iter().zip(&self.wider).map(|(it, by)| it.sqrt() * by).collect();
        let most = found.iter().fold(f64::NEG_INFINITY, |most, it| most.max(*it));
        let row = |(sizes, found): (&Vec<f64>, &f64)| {
            let off: Vec<f64> = sizes.iter().zip(&units).map(|(size, unit)| (size - 1.0) / unit).collect();
            let counts = 1.0 / (1.0 + (most - found) / n as f64);
            (bends(&off).into_iter().map(|x| counts * x).collect::<Vec<f64>>(), counts * (found - most))
        };
        let solved = least_squares(bends(&units).len(), seen.iter().zip(found).map(row)).solve()?;
        let mut numbers = solved.coefficients.into_iter().skip(1);
        let slope: Vec<f64> = units.iter().zip(&mut numbers).map(|(unit, it)| it / unit).collect();
        let mut bent = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in 0..=i {
                bent[i][j] = -numbers.next()? * if i == j { 2.0 } else { 1.0 } / (units[i] * units[j]);
                bent[j][i] = bent[i][j];
            }
        }
        let curvature = Curvature::of(&bent).or_else(|| {
            bent.iter_mut().enumerate().zip(precisions(&self.laws)).for_each(|((i, row), law)| row[i] += law);
            Curvature::of(&bent)
        })?;
        let top = curvature.step(&slope).into_iter().map(|step| 1.0 + step).collect();
        Some((curvature, top))
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
    pub fn walk(&self, seed: Seed) -> Vec<Vec<f64>> {
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

/// Precisions, as if each law's width were a standard deviation.
fn precisions(laws: &[[f64; 2]]) -> Vec<f64> {
    laws.iter().map(|[least, greatest]| (greatest - least).max(1e-9).powi(-2)).collect()
}

/// By how much more widely sizes scatter than a likelihood that bends so says, as scores do from block to block.
fn wider(curvature: &Curvature, scores: &[Vec<f64>], block: &[usize]) -> Vec<f64> {
    let scattered = curvature.variances_by_block(scores, block);
    // Blocks are few: that errors in one made up for one another is not believed.
    scattered.iter().zip(curvature.variances()).map(|(scattered, bent)| (scattered / bent).max(1.0).sqrt()).collect()
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

/// What a likelihood that bends hangs on: a constant, each of what it is `off` by, and their products.
fn bends(off: &[f64]) -> Vec<f64> {
    let products = off.iter().enumerate().flat_map(|(i, a)| off[..=i].iter().map(move |b| a * b));
    [1.0].into_iter().chain(off.iter().copied()).chain(products).collect()
}

/// Where such a share of it more stays within the law.
fn inside(it: &Planted, by: f64) -> Planted {
    let (least, greatest) = it.variant.sizes();
    Planted { size: it.size.min(greatest / (1.0 + by)).max(least), ..it.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::straight::Straight;

    /// However it bends at one point, it is taken to bend as it does where sizes are believed to be.
    #[test]
    fn what_one_point_is_wrong_about_is_put_right() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let truth = [0.5, 0.98].into_iter().zip(kinds);
        let truth: Vec<Planted> =
            truth.map(|(share, variant)| Planted { size: share * variant.sizes().1, variant }).collect();
        let alike = |t: usize| 9.0 * (0.37 * t as f64).sin();
        let log = Straight::new(&truth, &[&alike, &|t| alike(t) + 6.0 * (0.91 * t as f64).sin()], Seed(4));
        let about = || Ridge::about(&log, &truth, (0..400).map(|t| t / 20).collect()).expect("finite");
        let middle = |ridge: &Ridge| {
            let walked = ridge.walk(Seed(9)).into_iter();
            let quarters = walked.map(|mut sizes| {
                sizes.sort_by(f64::total_cmp);
                [1, 2, 3].map(|quarter| sizes[quarter * sizes.len() / 4])
            });
            quarters.collect::<Vec<_>>()
        };
        let right = middle(&about());
        let mut wrong = about();
        let unsure: Vec<f64> = wrong.curvature.variances().into_iter().map(f64::sqrt).collect();
        wrong.top.iter_mut().zip(&unsure).for_each(|(top, unsure)| *top -= 4.0 * unsure);
        wrong.curvature = wrong.curvature.with(&[9.0 / unsure[0].powi(2), 0.0]).expect("sharper");
        let far = |found: &[[f64; 3]]| {
            let off = found.iter().flatten().zip(right.iter().flatten()).map(|(found, right)| (found - right).abs());
            off.zip(unsure.iter().flat_map(|it| [it; 3])).fold(0.0_f64, |most, (off, unsure)| most.max(off / unsure))
        };
        assert!(far(&middle(&wrong)) > 1.0, "{:?}, not {right:?}", middle(&wrong));
        let found = middle(&wrong.looked_at(&log, &truth));
        assert!(far(&found) < 0.1, "{found:?}, not {right:?}");
    }
}
