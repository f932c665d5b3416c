//! A likelihood about its top, within the laws of the sizes, and random walks on it: on a Gaussian that is near to it, which cost nothing,
//! and on the likelihood itself, which are led by that.

use asami_dataset::{Rng, Seed};
use asami_math::elementary::ln;
use asami_math::regression::least_squares;
use rand::RngExt;
use rand_distr::StandardNormal;

use super::scattered::scattered;
use crate::judge::Judge;
use crate::newton::Curvature;
use crate::plant::Planted;
use crate::weigh::cores::on_free_cores;

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
/// Steps of the random walks on the likelihood itself through all worlds, each as long as it is probable, but none shorter or longer than so;
/// and the first ones of each.
const TRUE_WALK: f64 = 6_000.0;
const TRUE_WALKS: [usize; 2] = [300, 1_500];
const TRUE_FIRST: usize = 150;
/// Between two of them so many steps are walked on the Gaussian: many where it is like the likelihood, few where it is not.
const LED: [usize; 3] = [3, 12, 48];
/// So many times the likelihood is looked at where sizes are believed to be.
const LOOKS: u64 = 3;

/// A likelihood that bends as a Gaussian does, and the laws of the sizes. Sizes are counted in those of its middle.
pub struct Ridge {
    /// Sizes, somewhere within the laws.
    pub middle: Vec<f64>,
    /// How it bends, with each law's width for a standard deviation besides: what hardly bends has its top far beyond the laws.
    curvature: Curvature,
    /// The same, as wide as sizes scatter.
    wide: Curvature,
    /// What of a nat counts then.
    counts: f64,
    /// Where it is greatest, be it beyond the laws.
    top: Vec<f64>,
    /// The laws' ends.
    laws: Vec<[f64; 2]>,
    /// From where on laws are even in a size's logarithm: below they are as even as there.
    even: Vec<f64>,
    /// Scores of steps, of each size, and the blocks of these steps.
    scores: Vec<Vec<f64>>,
    block: Vec<usize>,
}

impl Ridge {
    /// The likelihood about these sizes, of steps in such blocks; `None` where it is not finite. Effects after the first `named` may be of
    /// any size below their law's, too: what is not worth a name is as little as not at all there.
    pub fn about(judge: &dyn Judge, all: &[Planted], named: usize, block: Vec<usize>) -> Option<Self> {
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
        let mut scores: Vec<Vec<f64>> = (0..all.len()).map(score).collect();
        let by_scores = Curvature::new(&scores, NEXT_TO_NOTHING)?;
        let around: Vec<f64> =
            by_scores.variances().into_iter().map(|it| it.sqrt().clamp(AROUND[0], AROUND[1])).collect();
        let middle: Vec<Planted> = all.iter().zip(&around).map(|(it, by)| inside(it, *by)).collect();
        let likely = |by: &[(usize, f64)]| terms(&middle, by).into_iter().fold(0.0, |sum, it| sum + it);
        let (slope, bent) = bent(likely, &around);
        let even: Vec<f64> = middle.iter().map(|it| it.variant.sizes().0 / it.size).collect();
        let law = |(i, it): (usize, &Planted)| [if i < named { even[i] } else { 0.0 }, it.variant.sizes().1 / it.size];
        let laws: Vec<[f64; 2]> = middle.iter().enumerate().map(law).collect();
        // Sizes are counted in those of the middle, where scores are not taken.
        for ((scores, middle), near) in scores.iter_mut().zip(&middle).zip(&near) {
            scores.iter_mut().for_each(|score| *score *= middle.size / near.size);
        }
        // Where it bends upwards somewhere, the scores say how curved it is.
        let curvature = Curvature::of(&bent).or_else(|| Curvature::new(&scores, NEXT_TO_NOTHING));
        let curvature = curvature?.with(&precisions(&laws))?;
        let (wide, counts) = scattered(&curvature, &scores, &block)?;
        Some(Self {
            wide,
            counts,
            top: curvature.step(&slope).into_iter().map(|step| 1.0 + step).collect(),
            scores,
            block,
            curvature,
            laws,
            even,
            middle: middle.into_iter().map(|it| it.size).collect(),
        })
    }

    /// The same, bent as the likelihood is wherever sizes are believed to be: by least squares in what it is there. About one point it
    /// may bend as it does nowhere else, where that is at the end of a law, or noise has tails.
    #[must_use]
    pub fn looked_at(mut self, judge: &dyn Judge, all: &[Planted]) -> Self {
        let likely = self.likely(judge, all);
        let mut seen = vec![self.of(all), vec![1.0; all.len()]];
        let mut found: Vec<f64> = seen.iter().map(|sizes| likely(sizes)).collect();
        let each = 2 * bends(&self.middle).len();
        for look in 1..=LOOKS {
            let walked = self.walk(Seed(look));
            let at = |k: usize| walked.iter().map(|sizes| sizes[k * (WALK / each)]).collect::<Vec<f64>>();
            let more: Vec<Vec<f64>> = (0..each).map(at).collect();
            found.extend(on_free_cores(more.iter().collect(), |sizes: &Vec<f64>| likely(sizes)));
            seen.extend(more);
            let Some((curvature, top)) = self.through(&seen, &found) else { break };
            let Some((wide, counts)) = scattered(&curvature, &self.scores, &self.block) else { break };
            (self.wide, self.counts) = (wide, counts);
            (self.curvature, self.top) = (curvature, top);
        }
        self
    }

    /// Sizes of these effects, in those of the middle.
    #[must_use]
    pub fn of(&self, all: &[Planted]) -> Vec<f64> {
        all.iter().zip(&self.middle).map(|(it, middle)| it.size / middle).collect()
    }

    /// How likely the log is where these effects have such sizes.
    pub fn likely<'a>(&self, judge: &'a dyn Judge, all: &'a [Planted]) -> impl Fn(&[f64]) -> f64 + Sync + use<'a> {
        let middle = self.middle.clone();
        move |sizes| {
            let there = all.iter().zip(sizes.iter().zip(&middle));
            let there = there.map(|(it, (size, middle))| Planted { size: size * middle, ..it.clone() });
            judge.log_likelihood(&there.collect::<Vec<_>>())
        }
    }

    /// Curvature and top of the Gaussian that is nearest to what was found at the sizes that were seen: what is far less likely
    /// than the likeliest counts less.
    fn through(&self, seen: &[Vec<f64>], found: &[f64]) -> Option<(Curvature, Vec<f64>)> {
        let n = self.middle.len();
        let units: Vec<f64> = self.wide.variances().into_iter().map(f64::sqrt).collect();
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
        bent.iter_mut().enumerate().zip(precisions(&self.laws)).for_each(|((i, row), law)| row[i] += law);
        let curvature = Curvature::of(&bent)?;
        let top = curvature.step(&slope).into_iter().map(|step| 1.0 + step).collect();
        Some((curvature, top))
    }

    /// Logarithm of the density of what is believed by the Gaussian, less what is the same everywhere.
    fn density(&self, sizes: &[f64]) -> f64 {
        let within = sizes.iter().zip(&self.laws).all(|(size, [least, greatest])| (least..=greatest).contains(&size));
        if !within {
            return f64::NEG_INFINITY;
        }
        let laws = sizes.iter().zip(&self.even).fold(0.0, |sum, (size, even)| sum - ln(size.max(*even)));
        laws - 0.5 * self.wide.squared(&self.off(sizes))
    }

    /// What counts of how much likelier the log is than by the Gaussian.
    fn likelier(&self, sizes: &[f64], likely: f64) -> f64 {
        self.counts * (likely + 0.5 * self.curvature.squared(&self.off(sizes)))
    }

    fn off(&self, sizes: &[f64]) -> Vec<f64> {
        sizes.iter().zip(&self.top).map(|(size, top)| size - top).collect()
    }

    /// Sizes as they are believed by the Gaussian: of each where a random walk among all comes by (Metropolis et al. 1953).
    pub fn walk(&self, seed: Seed) -> Vec<Vec<f64>> {
        let mut walker = Walker::new(self, seed, vec![1.0; self.middle.len()]);
        let steps = (0..FIRST + WALK).map(|_| {
            walker.step();
            walker.here.clone()
        });
        by_size(steps.skip(FIRST), self.middle.len())
    }

    /// Sizes as they are believed by the likelihood itself, which is so great, `from` these on: the Gaussian leads, and how much likelier
    /// the log is than by it says whether that is followed (the surrogate transition of Liu 2001, "Monte Carlo Strategies in Scientific
    /// Computing", section 9.4.3). What parts them counts as much less as sizes are less sure than a likelihood that bends so says. What is
    /// but a `share` of all that is believed is walked on for no longer than it counts.
    pub fn walk_on(&self, from: Vec<f64>, likely: impl Fn(&[f64]) -> f64, share: f64, seed: Seed) -> Vec<Vec<f64>> {
        let n = from.len();
        let [shortest, longest] = TRUE_WALKS;
        let walk = ((share * TRUE_WALK) as usize).clamp(shortest, longest);
        let likelier = |sizes: &[f64]| self.likelier(sizes, likely(sizes));
        let mut walker = Walker::new(self, seed, from);
        let mut here = likelier(&walker.here);
        let steps = (0..TRUE_FIRST + walk).map(|step| {
            let before = (walker.here.clone(), walker.density);
            (0..LED[step % LED.len()]).for_each(|_| walker.step());
            let there = if walker.here == before.0 { here } else { likelier(&walker.here) };
            if ln(walker.rng.random::<f64>()) < there - here {
                here = there;
            } else {
                (walker.here, walker.density) = before;
            }
            walker.here.clone()
        });
        by_size(steps.skip(TRUE_FIRST), n)
    }
}

/// Where a random walk is.
struct Walker<'a> {
    ridge: &'a Ridge,
    rng: Rng,
    here: Vec<f64>,
    density: f64,
    steps: usize,
}

impl<'a> Walker<'a> {
    fn new(ridge: &'a Ridge, seed: Seed, here: Vec<f64>) -> Self {
        let density = ridge.density(&here);
        Self { ridge, rng: seed.stream("sizes as they are believed"), here, density, steps: 0 }
    }

    /// A step on the Gaussian.
    fn step(&mut self) {
        let standard: Vec<f64> = self.here.iter().map(|_| self.rng.sample(StandardNormal)).collect();
        let long = 2.38 / (self.here.len() as f64).sqrt() * STEPS[self.steps % STEPS.len()];
        let by = self.ridge.wide.drawn(&standard).into_iter().map(|by| long * by);
        let there: Vec<f64> = self.here.iter().zip(by).map(|(at, by)| at + by).collect();
        let of_there = self.ridge.density(&there);
        if ln(self.rng.random::<f64>()) < of_there - self.density {
            (self.here, self.density) = (there, of_there);
        }
        self.steps += 1;
    }
}

/// Of each of `n` sizes what it is at each step.
fn by_size(steps: impl Iterator<Item = Vec<f64>>, n: usize) -> Vec<Vec<f64>> {
    let mut walked = vec![Vec::new(); n];
    steps.for_each(|here| walked.iter_mut().zip(here).for_each(|(walked, at)| walked.push(at)));
    walked
}

/// Precisions, as if each law's width were a standard deviation.
fn precisions(laws: &[[f64; 2]]) -> Vec<f64> {
    laws.iter().map(|[least, greatest]| (greatest - least).max(1e-9).powi(-2)).collect()
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
    use asami_math::elementary::exp;

    use super::*;
    use crate::straight::Straight;

    /// Two effects, at such shares of their greatest sizes.
    fn at(shares: [f64; 2]) -> Vec<Planted> {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let sized = shares.into_iter().zip(kinds);
        sized.map(|(share, variant)| Planted { size: share * variant.sizes().1, variant }).collect()
    }

    /// However it bends at one point, it is taken to bend as it does where sizes are believed to be.
    #[test]
    fn what_one_point_is_wrong_about_is_put_right() {
        let truth = at([0.5, 0.98]);
        let alike = |t: usize| 9.0 * (0.37 * t as f64).sin();
        let log = Straight::new(&truth, &[&alike, &|t| alike(t) + 6.0 * (0.91 * t as f64).sin()], Seed(4));
        let about = || Ridge::about(&log, &truth, 2, (0..400).map(|t| t / 20).collect()).expect("finite");
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

    /// A likelihood with two tops, of which the Gaussian knows one: sizes are believed as by quadrature over both, one of them below its law,
    /// for nothing names it.
    #[test]
    fn the_walk_is_on_the_likelihood_and_not_on_the_gaussian() {
        let truth = at([0.5, 0.2]);
        let waves: [&dyn Fn(usize) -> f64; 2] =
            [&|t| 0.5 * (0.37 * t as f64).sin(), &|t| 0.5 * (0.91 * t as f64).sin()];
        let log = Straight::new(&truth, &waves, Seed(8));
        let ridge = Ridge::about(&log, &truth, 1, (0..400).map(|t| t / 20).collect()).expect("finite");
        let bump = |sizes: &[f64], at: [f64; 2], wide: f64| {
            exp(-0.5 * sizes.iter().zip(at).fold(0.0, |sum, (it, at)| sum + (it - at) * (it - at)) / (wide * wide))
        };
        let likely = |sizes: &[f64]| ln(bump(sizes, [0.8, 0.15], 0.08) + bump(sizes, [1.2, 1.2], 0.12) + 1e-12);
        let mut walked = vec![Vec::new(); 2];
        for seed in 0..8 {
            let more = ridge.walk_on(ridge.of(&truth), likely, 1.0, Seed(seed));
            walked.iter_mut().zip(more).for_each(|(walked, more)| walked.extend(more));
        }
        let cells = 240;
        let points = |k: usize| {
            let [least, greatest] = ridge.laws[k];
            (0..cells).map(move |i| least + (f64::from(i) + 0.5) / f64::from(cells) * (greatest.min(3.0) - least))
        };
        let mut below = [0.0; 4];
        for a in points(0) {
            for b in points(1) {
                let density = exp(ridge.density(&[a, b]) + ridge.likelier(&[a, b], likely(&[a, b])));
                let is = [true, a < 1.0, b < 0.15, b < 0.8];
                below.iter_mut().zip(is).filter(|it| it.1).for_each(|it| *it.0 += density);
            }
        }
        let share = |k: usize, limit: f64| {
            walked[k].iter().filter(|size| **size < limit).count() as f64 / walked[k].len() as f64
        };
        for (by_quadrature, found) in below[1..].iter().zip([share(0, 1.0), share(1, 0.15), share(1, 0.8)]) {
            assert!((by_quadrature / below[0] - found).abs() < 0.05, "{found}, not {}", by_quadrature / below[0]);
        }
        assert!((0.2..0.9).contains(&share(0, 1.0)) && ridge.laws[1][0] == 0.0 && ridge.laws[0][0] > 0.0);
        assert!(walked[1].iter().any(|size| *size < ridge.even[1]));
    }
}
