//! Regressions whose coefficients are mostly nothing: what an effect leaves alone is found to be left alone.
//!
//! Coefficients of a group share a Gaussian prior about 0, as wide as the runs themselves say (empirical Bayes, MacKay
//! 1992). A simulated run's own noise is then not taken for something that the effect does. How far the runs scatter
//! is read off the differences between them (Liang and Zeger 1986), since a gait's sway is not white from frame to
//! frame.

use asami_math::decomposition::{cholesky, cholesky_inverse_diagonal, cholesky_solve};

/// Normal equations of one run.
#[derive(Clone, Debug)]
pub struct Sums {
    /// Lower triangle.
    normal: Vec<Vec<f64>>,
    right: Vec<f64>,
    squares: f64,
    count: f64,
}

/// Rounds in which priors' widths are found.
const ROUNDS: usize = 25;
/// A ridge that only makes equations solvable, as a share of the diagonal.
const RIDGE: f64 = 1e-9;

impl Sums {
    /// Of nothing yet.
    #[must_use]
    pub fn new(width: usize) -> Self {
        Self {
            normal: (0..width).map(|i| vec![0.0; i + 1]).collect(),
            right: vec![0.0; width],
            squares: 0.0,
            count: 0.0,
        }
    }

    /// Takes in a row of regressors and what they are to explain.
    pub fn add(&mut self, x: &[f64], y: f64, weight: f64) {
        for (a, xa) in x.iter().enumerate().filter(|(_, xa)| **xa != 0.0) {
            for (sum, xb) in self.normal[a].iter_mut().zip(x) {
                *sum += weight * xa * xb;
            }
            self.right[a] += weight * xa * y;
        }
        self.squares += weight * y * y;
        self.count += 1.0;
    }

    /// The same run, had its regressors been these combinations of themselves: row `i` of `rows` says what the `i`-th
    /// new one is made of.
    #[must_use]
    pub fn combined(&self, rows: &[Vec<(usize, f64)>]) -> Self {
        let at = |a: usize, b: usize| self.normal[a.max(b)][a.min(b)];
        let entry = |p: &[(usize, f64)], q: &[(usize, f64)]| {
            let pairs = p.iter().flat_map(|(a, wa)| q.iter().map(move |(b, wb)| (*a, *b, wa * wb)));
            pairs.fold(0.0, |sum, (a, b, weight)| sum + weight * at(a, b))
        };
        let normal = (0..rows.len()).map(|i| (0..=i).map(|j| entry(&rows[i], &rows[j])).collect()).collect();
        let right = rows.iter().map(|row| row.iter().fold(0.0, |sum, (a, weight)| sum + weight * self.right[*a]));
        Self { normal, right: right.collect(), ..*self }
    }

    fn plus(&mut self, other: &Self) {
        for (row, of) in self.normal.iter_mut().zip(&other.normal) {
            for (sum, it) in row.iter_mut().zip(of) {
                *sum += it;
            }
        }
        for (sum, it) in self.right.iter_mut().zip(&other.right) {
            *sum += it;
        }
        self.squares += other.squares;
        self.count += other.count;
    }

    fn of_all(runs: &[Self], width: usize) -> Self {
        runs.iter().fold(Self::new(width), |mut all, run| {
            all.plus(run);
            all
        })
    }

    /// Squares of what `b` leaves unexplained.
    #[must_use]
    pub fn left(&self, b: &[f64]) -> f64 {
        let explained = b.iter().zip(&self.right).zip(self.score(b));
        explained.fold(self.squares, |left, ((b, right), score)| left - b * (right + score))
    }

    /// Right side less the normal matrix times `b`.
    fn score(&self, b: &[f64]) -> Vec<f64> {
        let at = |i: usize, j: usize| self.normal[i.max(j)][i.min(j)];
        let row = |i: usize| b.iter().enumerate().fold(self.right[i], |left, (j, b)| left - at(i, j) * b);
        (0..b.len()).map(row).collect()
    }

    /// The full matrix, with something on its diagonal.
    fn full(&self, diagonal: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let n = self.right.len();
        let at = |i: usize, j: usize| self.normal[i.max(j)][i.min(j)] + if i == j { diagonal(i) } else { 0.0 };
        (0..n).map(|i| (0..n).map(|j| at(i, j)).collect()).collect()
    }
}

/// A change as far as it stands out of what chance of this variance would make (James and Stein 1961, positive part).
#[must_use]
pub fn stands_out(change: f64, chance_var: f64) -> f64 {
    change * (1.0 - chance_var / (change * change).max(1e-300)).max(0.0)
}

/// Coefficients of the runs together, of which nothing is known but that they are about `prior_sd` from 0.
#[must_use]
pub fn ridged(runs: &[Sums], prior_sd: f64) -> Vec<f64> {
    let width = runs.first().map_or(0, |run| run.right.len());
    let all = Sums::of_all(runs, width);
    let ridge = (all.squares / f64::max(all.count, 1.0)).max(1e-12) / (prior_sd * prior_sd);
    cholesky(&all.full(|_| ridge)).map_or_else(|| vec![0.0; width], |l| cholesky_solve(&l, &all.right))
}

/// Coefficients of the runs together; `group` says which of them share a prior. Those of regressors that never occur
/// are 0, and so are all where the equations cannot be solved.
#[must_use]
pub fn shrunk(runs: &[Sums], group: &[usize]) -> Vec<f64> {
    let width = group.len();
    let all = Sums::of_all(runs, width);
    let ridge = |i: usize| if all.normal[i][i] > 0.0 { RIDGE * all.normal[i][i] } else { 1.0 };
    let Some(plain) = cholesky(&all.full(ridge)) else { return vec![0.0; width] };
    let mut b = cholesky_solve(&plain, &all.right);
    let Some(scatter_var) = scatter(runs, &plain, &b) else { return b };
    let groups = group.iter().copied().max().map_or(0, |last| last + 1);
    let mut prior_var = vec![f64::INFINITY; groups];
    let mut shown = vec![0.0; groups];
    for (g, prior_var) in prior_var.iter_mut().enumerate() {
        let of = || (0..width).filter(|i| group[*i] == g && all.normal[*i][*i] > 0.0);
        shown[g] = of().count() as f64;
        *prior_var = of().fold(0.0, |sum, i| sum + b[i] * b[i]) / f64::max(shown[g], 1.0);
    }
    for _ in 0..ROUNDS {
        // A prior so narrow that it says 0 stands for 0; any narrower would only cost digits.
        let precision: Vec<f64> = (0..width)
            .map(|i| match all.normal[i][i] {
                diagonal if diagonal > 0.0 => (scatter_var / prior_var[group[i]].max(1e-300)).min(1e6 * diagonal),
                _ => 1.0,
            })
            .collect();
        let Some(l) = cholesky(&all.full(|i| precision[i])) else { return b };
        b = cholesky_solve(&l, &all.right);
        let inverse = cholesky_inverse_diagonal(&l);
        for g in 0..groups {
            let of = || (0..width).filter(|i| group[*i] == g && all.normal[*i][*i] > 0.0);
            let left = of().fold(0.0, |sum, i| sum + precision[i] * inverse[i]);
            let squares = of().fold(0.0, |sum, i| sum + b[i] * b[i]);
            // How many coefficients the runs determine; at least a trace, so that a prior can widen again.
            prior_var[g] = squares / (shown[g] - left).max(1e-3);
        }
    }
    b
}

/// Variance of what is not explained, as far as it matters to the coefficients: from the runs' scores, which add up
/// to nothing. `None` where there is only one run.
fn scatter(runs: &[Sums], l: &[Vec<f64>], b: &[f64]) -> Option<f64> {
    let n = runs.len() as f64;
    let quadratic = |run: &Sums| {
        let score = run.score(b);
        cholesky_solve(l, &score).iter().zip(&score).fold(0.0, |sum, (a, b)| sum + a * b)
    };
    let sum = runs.iter().map(quadratic).fold(0.0, |sum, it| sum + it);
    (runs.len() > 1 && !b.is_empty()).then(|| (sum / (b.len() as f64 * (1.0 - 1.0 / n))).max(1e-300))
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Rng, Seed};
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn normal(rng: &mut Rng) -> f64 {
        StandardNormal.sample(rng)
    }

    /// Runs of `y = x b + noise`, the noise an autoregression with factor `rho`.
    fn runs(b: &[f64], rho: f64, rng: &mut Rng) -> Vec<Sums> {
        let mut run = || {
            let (mut sums, mut noise, mut x) = (Sums::new(b.len()), 0.0, vec![0.0; b.len()]);
            for step in 0..400 {
                // Regressors last, as commands do.
                if step % 20 == 0 {
                    x.iter_mut().for_each(|x| *x = normal(rng));
                }
                noise = rho * noise + (1.0 - rho * rho).sqrt() * normal(rng);
                let y = x.iter().zip(b).fold(noise, |sum, (x, b)| sum + x * b);
                sums.add(&x, y, 1.0);
            }
            sums
        };
        (0..8).map(|_| run()).collect()
    }

    #[test]
    fn what_is_nothing_comes_out_as_next_to_nothing_and_what_is_something_stays() {
        let mut rng = Seed(1).stream("shrink/test");
        let mut truth = vec![0.0; 40];
        truth[..10].copy_from_slice(&[1.0, -0.7, 0.5, 1.2, -1.0, 0.8, -0.4, 0.9, 1.1, -0.6]);
        let runs = runs(&truth, 0.8, &mut rng);
        let group: Vec<usize> = (0..40).map(|i| i / 10).collect();
        let found = shrunk(&runs, &group);
        let rms = |of: std::ops::Range<usize>| {
            let n = of.len() as f64;
            (of.map(|i| (found[i] - truth[i]).powi(2)).sum::<f64>() / n).sqrt()
        };
        // White noise of this variance would leave 1 / sqrt(3200) = 0.018; lasting for 9 steps, three times that.
        assert!(rms(0..10) < 0.09, "{}", rms(0..10));
        assert!(rms(10..40) < 0.02, "{}", rms(10..40));
    }

    #[test]
    fn a_change_of_three_standard_deviations_stands_and_one_of_less_than_one_does_not() {
        assert!((stands_out(-3.0, 1.0) + 3.0 * (1.0 - 1.0 / 9.0)).abs() < 1e-12);
        assert_eq!((stands_out(0.9, 1.0), stands_out(0.0, 1.0)), (0.0, 0.0));
    }

    #[test]
    fn combinations_of_regressors_are_those_of_the_run() {
        let mut rng = Seed(2).stream("shrink/test");
        let (mut plain, mut direct) = (Sums::new(3), Sums::new(2));
        for _ in 0..50 {
            let x: [f64; 3] = std::array::from_fn(|_| normal(&mut rng));
            let y = normal(&mut rng);
            plain.add(&x, y, 0.5);
            direct.add(&[x[0], 2.0 * x[1] - x[2]], y, 0.5);
        }
        let combined = plain.combined(&[vec![(0, 1.0)], vec![(1, 2.0), (2, -1.0)]]);
        for i in 0..2 {
            assert!((combined.right[i] - direct.right[i]).abs() < 1e-12);
            (0..=i).for_each(|j| assert!((combined.normal[i][j] - direct.normal[i][j]).abs() < 1e-12));
        }
    }

    #[test]
    fn what_is_left_unexplained_is_what_the_rows_themselves_leave() {
        let mut rng = Seed(3).stream("shrink/test");
        let (mut sums, b, mut left) = (Sums::new(2), [0.7, -0.2], 0.0);
        for _ in 0..50 {
            let (x, y): ([f64; 2], f64) = (std::array::from_fn(|_| normal(&mut rng)), normal(&mut rng));
            sums.add(&x, y, 0.5);
            left += 0.5 * (y - x[0] * b[0] - x[1] * b[1]).powi(2);
        }
        assert!((sums.left(&b) - left).abs() < 1e-12, "{} {left}", sums.left(&b));
    }

    #[test]
    fn a_regressor_that_never_occurs_has_no_coefficient() {
        let mut sums = vec![Sums::new(2), Sums::new(2)];
        for (i, sums) in sums.iter_mut().enumerate() {
            (0..10).for_each(|step| sums.add(&[1.0 + f64::from(step), 0.0], 2.0 * f64::from(step) + i as f64, 1.0));
        }
        let found = shrunk(&sums, &[0, 1]);
        assert!(found[0] > 1.0 && found[1] == 0.0, "{found:?}");
    }
}
