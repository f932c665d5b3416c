//! By how much more widely sizes scatter than a likelihood that bends so says, as its scores do from block to block (Huber 1967, White
//! 1982; of blocks: Liang and Zeger 1986).
//!
//! Sizes that make up for one another are known together as surely as ever, however widely each of them scatters: what is wider is so
//! along directions of the likelihood's own (Ribatet, Cooley and Davison 2012, "Bayesian Inference from Composite Likelihoods"). Each of
//! them wider for itself would lie off the ridge on which they are.

use asami_math::decomposition::svd;
use asami_math::elementary::{exp, ln};

use crate::newton::Curvature;

/// A likelihood's curvature as wide as its scores scatter, and what of a nat counts then, over all directions.
///
/// `scores` has for each size a number for each step, `block` for each step in which block it is, from 0 on. Blocks are few: how scores
/// scatter is taken to be more like scattering alike in all directions the less they say otherwise (Ledoit and Wolf 2004, "A
/// Well-Conditioned Estimator for Large-Dimensional Covariance Matrices"), and that errors in one make up for another is not believed.
pub fn scattered(curvature: &Curvature, scores: &[Vec<f64>], block: &[usize]) -> Option<(Curvature, f64)> {
    let n = scores.len();
    let drawn = of_blocks(curvature, scores, block);
    let by = svd(&shrunk(&drawn, n));
    let counts: Vec<f64> = by.values.iter().map(|times| times.max(1.0).recip()).collect();
    let whole = exp(counts.iter().fold(0.0, |sum, it| sum + ln(*it)) / n as f64);
    Some((curvature.counted(&by.right, &counts)?, whole))
}

/// Of each block the sum of its scores in standard deviations, so that the mean of their squares is the variance of what all blocks say.
fn of_blocks(curvature: &Curvature, scores: &[Vec<f64>], block: &[usize]) -> Vec<Vec<f64>> {
    let blocks = block.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![vec![0.0; scores.len()]; blocks];
    for (step, b) in block.iter().enumerate() {
        sums[*b].iter_mut().zip(scores).for_each(|(sum, score)| *sum += score[step]);
    }
    let n = blocks as f64;
    let mut drawn: Vec<Vec<f64>> = sums.iter().map(|sums| curvature.standardised(sums)).collect();
    for i in 0..scores.len() {
        let mean = drawn.iter().fold(0.0, |sum, it| sum + it[i]) / n;
        drawn.iter_mut().for_each(|it| it[i] = (it[i] - mean) * n / (n - 1.0).max(1.0).sqrt());
    }
    drawn
}

/// The covariance of what was drawn, `n` numbers a draw, shrunk towards scattering alike in all directions by as much as is best.
fn shrunk(drawn: &[Vec<f64>], n: usize) -> Vec<Vec<f64>> {
    let draws = drawn.len() as f64;
    let product = |i: usize, j: usize| drawn.iter().fold(0.0, |sum, it| sum + it[i] * it[j]) / draws;
    let covariance: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| product(i, j)).collect()).collect();
    let mean = (0..n).fold(0.0, |sum, i| sum + covariance[i][i]) / n as f64;
    let alike = |i: usize, j: usize| if i == j { mean } else { 0.0 };
    let squares = |of: &dyn Fn(usize, usize) -> f64| {
        (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).fold(0.0, |sum, (i, j)| sum + of(i, j) * of(i, j))
    };
    let off = squares(&|i, j| covariance[i][j] - alike(i, j));
    let of_one = |it: &Vec<f64>| squares(&|i, j| it[i] * it[j] - covariance[i][j]);
    let unsure = drawn.iter().fold(0.0, |sum, it| sum + of_one(it)) / (draws * draws);
    let share = if off > 0.0 { (unsure / off).min(1.0) } else { 0.0 };
    (0..n).map(|i| (0..n).map(|j| share * alike(i, j) + (1.0 - share) * covariance[i][j]).collect()).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use rand::RngExt;
    use rand_distr::StandardNormal;

    use super::*;

    /// Scores of three sizes, the first two of which nearly make up for each other; the third's are `loud` times as large as they should
    /// be. 100 blocks of 20 steps.
    fn scores(loud: f64) -> (Vec<Vec<f64>>, Vec<usize>) {
        let mut rng = Seed(3).stream("scores");
        let mut one = || (0..2_000).map(|_| rng.sample(StandardNormal)).collect::<Vec<f64>>();
        let [a, b, c] = [one(), one(), one()];
        let nearly = a.iter().zip(&b).map(|(a, b)| -0.99 * a + 0.14 * b).collect();
        let third = c.iter().map(|c| loud * c).collect();
        (vec![a, nearly, third], (0..2_000).map(|t| t / 20).collect())
    }

    /// Scores as they should be leave everything about as wide as it is, for the ridge along which two sizes lie as for the third.
    #[test]
    fn what_scatters_as_it_should_is_no_wider() {
        let (scores, block) = scores(1.0);
        let curvature = Curvature::new(&scores, 0.0).unwrap();
        let (found, counts) = scattered(&curvature, &scores, &block).unwrap();
        for (found, it) in found.variances().iter().zip(curvature.variances()) {
            assert!((1.0..1.2).contains(&(found / it)), "{found} {it}");
        }
        assert!((0.85..=1.0).contains(&counts), "{counts}");
    }

    /// Only that is wider which scatters more, by as much; the other two's ridge keeps its direction.
    #[test]
    fn what_scatters_more_is_wider_and_ridges_stay() {
        let (quiet, block) = scores(1.0);
        let (loud, _) = scores(3.0);
        let curvature = Curvature::new(&quiet, 0.0).unwrap();
        let (found, counts) = scattered(&curvature, &loud, &block).unwrap();
        let times: Vec<f64> = found.variances().iter().zip(curvature.variances()).map(|(a, b)| a / b).collect();
        assert!((times[2] / 9.0 - 1.0).abs() < 0.3, "{times:?}");
        assert!(times[..2].iter().all(|it| (1.0..1.4).contains(it)), "{times:?}");
        assert!((counts / 9.0_f64.powf(-1.0 / 3.0) - 1.0).abs() < 0.15, "{counts}");
        // Across the ridge nothing is wider.
        let across = |of: &Curvature| of.squared(&[1.0, -1.0, 0.0]);
        assert!((across(&found) / across(&curvature) - 1.0).abs() < 0.3, "{} {}", across(&found), across(&curvature));
    }

    /// Of as few blocks as sizes nothing but how widely all scatter is believed, and of one nothing.
    #[test]
    fn of_hardly_any_blocks_hardly_anything_is_believed() {
        let (scores, _) = scores(1.0);
        let curvature = Curvature::new(&scores, 0.0).unwrap();
        for blocks in [1, 3] {
            let block: Vec<usize> = (0..2_000).map(|t| t * blocks / 2_000).collect();
            let (found, counts) = scattered(&curvature, &scores, &block).unwrap();
            let times: Vec<f64> = found.variances().iter().zip(curvature.variances()).map(|(a, b)| a / b).collect();
            assert!(times.iter().all(|it| (1.0 - 1e-9..6.0).contains(it)), "{blocks}: {times:?}");
            assert!(counts <= 1.0 && counts > 0.2, "{blocks}: {counts}");
        }
    }
}
