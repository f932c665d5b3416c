//! Newton's method on a log-likelihood that is a sum over steps, with the curvature of the steps' scores (Berndt, Hall, Hall
//! and Hausman 1974).

use asami_math::decomposition::{cholesky, cholesky_forward_solve, cholesky_solve, cholesky_transposed_solve, dot};
use asami_math::elementary::ln;

/// The curvature at a point.
pub struct Curvature {
    /// Its lower triangular factor.
    l: Vec<Vec<f64>>,
}

impl Curvature {
    /// Of scores, a row for each direction and in it a number for each step, and a Gaussian prior of this precision; `None`
    /// where they are not finite.
    #[must_use]
    pub fn new(scores: &[impl AsRef<[f64]>], precision: f64) -> Option<Self> {
        let p = scores.len();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
        let mut curvature = vec![vec![0.0; p]; p];
        for i in 0..p {
            for j in 0..=i {
                curvature[i][j] =
                    product(scores[i].as_ref(), scores[j].as_ref()) + if i == j { precision } else { 0.0 };
                curvature[j][i] = curvature[i][j];
            }
        }
        Self::of(&curvature)
    }

    /// Minus a matrix of second derivatives; `None` where it is not that of a top.
    #[must_use]
    pub fn of(matrix: &[Vec<f64>]) -> Option<Self> {
        Some(Self { l: cholesky(matrix)? })
    }

    /// The same and these precisions, one a direction.
    #[must_use]
    pub fn with(&self, precisions: &[f64]) -> Option<Self> {
        let product = |i: usize, j: usize| self.l[i].iter().zip(&self.l[j]).fold(0.0, |sum, (a, b)| sum + a * b);
        let row =
            |i: usize| (0..self.l.len()).map(|j| product(i, j) + if i == j { precisions[i] } else { 0.0 }).collect();
        Self::of(&(0..self.l.len()).map(row).collect::<Vec<_>>())
    }

    /// The same, where along each of these directions, orthogonal unit vectors in standard deviations, so much of it counts.
    #[must_use]
    pub fn counted(&self, directions: &[Vec<f64>], counts: &[f64]) -> Option<Self> {
        let along = |i: usize| {
            let of = |(direction, counts): (&Vec<f64>, &f64)| dot(&self.l[i], direction) * counts.sqrt();
            directions.iter().zip(counts).map(of).collect::<Vec<f64>>()
        };
        let rows: Vec<Vec<f64>> = (0..self.l.len()).map(along).collect();
        let row = |a: &Vec<f64>| rows.iter().map(|b| dot(a, b)).collect();
        Self::of(&rows.iter().map(row).collect::<Vec<Vec<f64>>>())
    }

    /// A slope in standard deviations: were the log-likelihood what it is taken for, a slope at the truth would be standard Gaussian numbers.
    #[must_use]
    pub fn standardised(&self, slope: &[f64]) -> Vec<f64> {
        cholesky_forward_solve(&self.l, slope)
    }

    /// What lies so far off the top has by half of this less.
    #[must_use]
    pub fn squared(&self, off: &[f64]) -> f64 {
        let along = |j: usize| (j..off.len()).fold(0.0, |sum, i| sum + self.l[i][j] * off[i]);
        (0..off.len()).map(along).fold(0.0, |sum, it| sum + it * it)
    }

    /// How far off the top a Gaussian of this curvature lies that is drawn by these standard ones.
    #[must_use]
    pub fn drawn(&self, standard: &[f64]) -> Vec<f64> {
        cholesky_transposed_solve(&self.l, standard)
    }

    /// The step of Newton's method where the log-likelihood has this slope.
    #[must_use]
    pub fn step(&self, slope: &[f64]) -> Vec<f64> {
        cholesky_solve(&self.l, slope)
    }

    /// The logarithm of its determinant.
    #[must_use]
    pub fn ln_determinant(&self) -> f64 {
        2.0 * self.l.iter().enumerate().fold(0.0, |sum, (i, row)| sum + ln(row[i]))
    }

    /// Variances of what is found, however its steps' scores hang on one another within a block: `block` says for each step
    /// in which of them it is, from 0 on (Huber 1967, White 1982; of blocks in place of steps: Liang and Zeger 1986).
    #[must_use]
    pub fn variances_by_block(&self, scores: &[Vec<f64>], block: &[usize]) -> Vec<f64> {
        let blocks = block.iter().max().map_or(0, |last| last + 1);
        let of = |i: usize| {
            let along = self.inverse(i);
            let mut sums = vec![0.0; blocks];
            for (step, b) in block.iter().enumerate() {
                sums[*b] += along.iter().zip(scores).fold(0.0, |sum, (share, score)| sum + share * score[step]);
            }
            let n = blocks as f64;
            let mean = sums.iter().fold(0.0, |sum, it| sum + it) / n;
            let squares = sums.iter().fold(0.0, |sum, it| sum + (it - mean) * (it - mean));
            squares * n / (n - 1.0)
        };
        (0..scores.len()).map(of).collect()
    }

    /// Variances of what is found.
    #[must_use]
    pub fn variances(&self) -> Vec<f64> {
        (0..self.l.len()).map(|i| self.inverse(i)[i]).collect()
    }

    /// A row of its inverse.
    fn inverse(&self, i: usize) -> Vec<f64> {
        let unit: Vec<f64> = (0..self.l.len()).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
        cholesky_solve(&self.l, &unit)
    }
}

/// Shares of a step that are tried until one is no step down.
const SHORTER: [f64; 4] = [1.0, 0.5, 0.2, 0.05];

/// The best of a step's shares, if any is better than `here`: shortened until it is no longer a step down; then the `longer`
/// ones. `along` gives what is reached at a share, its value first.
pub fn climb<T>(here: f64, longer: &[f64], along: impl Fn(f64) -> (f64, T)) -> Option<(f64, T)> {
    let better = SHORTER.into_iter().map(&along).find(|(found, _)| *found > here)?;
    Some(longer.iter().map(|share| along(*share)).fold(better, |best, it| if it.0 > best.0 { it } else { best }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two directions with scores of their own the step is that of each; their variances and the determinant too.
    #[test]
    fn curvature_is_that_of_the_scores() {
        let scores = [vec![1.0, -1.0, 1.0, -1.0], vec![2.0, 2.0, -2.0, -2.0]];
        let curvature = Curvature::new(&scores, 0.0).unwrap();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        let step = curvature.step(&[2.0, 4.0]);
        near(step[0], 0.5);
        near(step[1], 0.25);
        near(curvature.variances()[0], 0.25);
        near(curvature.variances()[1], 1.0 / 16.0);
        near(curvature.ln_determinant(), 64.0_f64.ln());
        near(curvature.squared(&[1.0, 0.5]), 4.0 + 16.0 / 4.0);
        near(curvature.squared(&curvature.drawn(&[0.6, 0.8])), 1.0);
        near(curvature.with(&[1.0, 0.0]).unwrap().variances()[0], 0.2);
        assert!(Curvature::new(&[vec![f64::NAN]], 1.0).is_none());
    }

    /// Scores that come in fours say a quarter as much as they seem to.
    #[test]
    fn what_is_said_again_is_not_said_twice() {
        let signs = [1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0];
        let again: Vec<f64> = signs.iter().flat_map(|sign| [*sign; 4]).collect();
        let curvature = Curvature::new(std::slice::from_ref(&again), 0.0).unwrap();
        let by_step = curvature.variances_by_block(std::slice::from_ref(&again), &(0..32).collect::<Vec<_>>())[0];
        assert!((by_step - curvature.variances()[0] * 32.0 / 31.0).abs() < 1e-12);
        let fours: Vec<usize> = (0..32).map(|step| step / 4).collect();
        let by_four = curvature.variances_by_block(&[again], &fours)[0];
        assert!((by_four - 4.0 * curvature.variances()[0] * 8.0 / 7.0).abs() < 1e-12, "{by_four}");
    }

    #[test]
    fn a_step_is_shortened_until_it_climbs_and_lengthened_while_that_helps() {
        let hill = |top: f64| move |share: f64| (-(share - top).powi(2), share);
        let share = |top: f64| climb(-top * top, &[2.0, 4.0], hill(top)).map(|it| it.1);
        assert_eq!([0.15, 0.9, 1.8, 5.0].map(share), [Some(0.2), Some(1.0), Some(2.0), Some(4.0)]);
        assert_eq!(share(-1.0), None);
    }
}
