//! Statistics over a handful of trials.

use rand::{Rng, RngExt};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Arithmetic mean; `None` of nothing.
#[must_use]
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().fold(0.0, |sum, value| sum + value) / values.len() as f64)
}

/// Standard deviation with `n - 1`; `None` of fewer than two values.
#[must_use]
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let squares = values.iter().fold(0.0, |sum, value| sum + (value - mean) * (value - mean));
    (values.len() > 1).then(|| (squares / (values.len() - 1) as f64).sqrt())
}

/// Middle value, or the mean of the two middle ones; `None` of nothing.
#[must_use]
pub fn median(values: &[f64]) -> Option<f64> {
    let sorted = sorted(values);
    let upper = *sorted.get(sorted.len() / 2)?;
    let lower = sorted[(sorted.len() - 1) / 2];
    Some(lower + (upper - lower) / 2.0)
}

/// Mean of what is left once the lowest and the highest quarter, rounded down, are put aside (Agarwal
/// et al. 2021, "Deep Reinforcement Learning at the Edge of the Statistical Precipice"); `None` of
/// nothing.
#[must_use]
pub fn interquartile_mean(values: &[f64]) -> Option<f64> {
    let sorted = sorted(values);
    let aside = sorted.len() / 4;
    mean(&sorted[aside..sorted.len() - aside])
}

/// Percentile bootstrap interval of the mean at a confidence `level` in 0..1 (Efron and Tibshirani
/// 1993, section 13.3); `None` of fewer than two values.
#[must_use]
pub fn bootstrap_interval(values: &[f64], level: f64, resamples: usize, rng: &mut impl Rng) -> Option<[f64; 2]> {
    if values.len() < 2 || resamples == 0 {
        return None;
    }
    let n = values.len();
    let means: Vec<f64> =
        (0..resamples).map(|_| (0..n).fold(0.0, |sum, _| sum + values[rng.random_range(0..n)]) / n as f64).collect();
    let means = sorted(&means);
    let at = |share: f64| means[((share * (resamples - 1) as f64).round() as usize).min(resamples - 1)];
    Some([at((1.0 - level) / 2.0), at(1.0 - (1.0 - level) / 2.0)])
}

/// Student's t of the mean of paired `differences`, and its two-sided p (Student 1908); `None` of fewer
/// than two, or of differences that do not differ.
///
/// ```
/// use asami_math::statistics::paired_t;
/// // Student's own example, the additional sleep under two drugs: t = 4.06, p = 0.0028.
/// let (t, p) = paired_t(&[1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4]).unwrap();
/// assert!((t - 4.0621).abs() < 1e-4 && (p - 0.00283).abs() < 1e-5);
/// ```
#[must_use]
pub fn paired_t(differences: &[f64]) -> Option<(f64, f64)> {
    let n = differences.len() as f64;
    let error = standard_deviation(differences)? / n.sqrt();
    let t = mean(differences)? / error;
    let distribution = StudentsT::new(0.0, 1.0, n - 1.0).ok()?;
    (t.is_finite()).then(|| (t, 2.0 * distribution.cdf(-t.abs())))
}

/// Wilson's score interval of a share at a confidence `level` in 0..1 (Wilson 1927): `successes` of
/// `trials`; `None` of no trials.
///
/// ```
/// use asami_math::statistics::wilson_interval;
/// let [low, high] = wilson_interval(10, 15, 0.95).unwrap();
/// assert!((low - 0.417).abs() < 1e-3 && (high - 0.848).abs() < 1e-3);
/// ```
#[must_use]
pub fn wilson_interval(successes: u32, trials: u32, level: f64) -> Option<[f64; 2]> {
    if trials == 0 || successes > trials || !(0.0..1.0).contains(&level) {
        return None;
    }
    let (n, z) = (f64::from(trials), Normal::new(0.0, 1.0).ok()?.inverse_cdf(0.5 + 0.5 * level));
    let share = f64::from(successes) / n;
    let middle = share + z * z / (2.0 * n);
    let reach = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let below = 1.0 + z * z / n;
    // Where all or none succeed the ends are 0 and 1 but for rounding.
    Some([((middle - reach) / below).clamp(0.0, 1.0), ((middle + reach) / below).clamp(0.0, 1.0)])
}

/// Two-sided p of Wilcoxon's signed-rank test (Wilcoxon 1945) that `differences` are symmetric about
/// zero: exact, conditional on the ranks, ties sharing their mean rank, zeros put aside. `None`
/// where no difference is left.
///
/// ```
/// use asami_math::statistics::wilcoxon_signed_rank;
/// // Five differences of one sign: 2 of the 2^5 sign patterns are as extreme.
/// assert_eq!(wilcoxon_signed_rank(&[1.0, 2.0, 3.0, 4.0, 5.0]), Some(2.0 / 32.0));
/// ```
#[must_use]
pub fn wilcoxon_signed_rank(differences: &[f64]) -> Option<f64> {
    let mut left: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0 && d.is_finite()).collect();
    left.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    if left.is_empty() {
        return None;
    }
    let ranks = doubled_ranks(&left);
    let total: usize = ranks.iter().sum();
    let positive: usize = left.iter().zip(&ranks).filter(|(d, _)| **d > 0.0).map(|(_, rank)| rank).sum();
    // chance[s]: that the ranks of a random choice of signs sum to s.
    let mut chance = vec![0.0; total + 1];
    chance[0] = 1.0;
    for rank in ranks {
        for sum in (0..=total).rev() {
            let with = if sum >= rank { chance[sum - rank] } else { 0.0 };
            chance[sum] = (chance[sum] + with) / 2.0;
        }
    }
    let tail = positive.min(total - positive);
    let one_sided: f64 = chance[..=tail].iter().fold(0.0, |sum, p| sum + p);
    Some((2.0 * one_sided).min(1.0))
}

/// Twice the rank by size of each of `sorted` (by absolute value), so that shared ranks are whole.
fn doubled_ranks(sorted: &[f64]) -> Vec<usize> {
    let mut ranks = Vec::with_capacity(sorted.len());
    while ranks.len() < sorted.len() {
        let first = ranks.len();
        let ties = sorted[first..].iter().take_while(|d| d.abs() == sorted[first].abs()).count();
        // Ranks first+1 ..= first+ties: twice their mean.
        ranks.extend(std::iter::repeat_n(2 * first + ties + 1, ties));
    }
    ranks
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn of_small_lists_as_by_hand() {
        let values = [9.0, 1.0, 4.0, 2.0];
        assert_eq!(mean(&values), Some(4.0));
        assert_eq!(median(&values), Some(3.0));
        assert_eq!(interquartile_mean(&values), Some(3.0));
        assert_eq!(standard_deviation(&values), Some((38.0_f64 / 3.0).sqrt()));
        assert_eq!((mean(&[]), median(&[]), interquartile_mean(&[])), (None, None, None));
        assert_eq!((standard_deviation(&[1.0]), median(&[1.0])), (None, Some(1.0)));
    }

    /// Hollander and Wolfe 1973, p. 29: depression scores before and after; R's documentation of
    /// `wilcox.test` gives a one-sided p of 0.01953.
    #[test]
    #[allow(clippy::approx_constant, reason = "a depression score of 3.14")]
    fn wilcoxon_gives_the_textbook_p() {
        let before = [1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30];
        let after = [0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29];
        let differences: Vec<f64> = before.iter().zip(after).map(|(before, after)| before - after).collect();
        let p = wilcoxon_signed_rank(&differences).unwrap();
        assert!((p - 2.0 * 0.01953125).abs() < 1e-12, "{p}");
    }

    #[test]
    fn wilcoxon_is_symmetric_and_shares_ranks() {
        let differences = [3.0, -1.0, 2.0, 2.0, -2.0, 0.0, 5.0];
        let mirrored = differences.map(|d: f64| -d);
        assert_eq!(wilcoxon_signed_rank(&differences), wilcoxon_signed_rank(&mirrored));
        // Two differences of one size: of four sign patterns two are as extreme as both positive.
        assert_eq!(wilcoxon_signed_rank(&[1.0, 1.0]), Some(0.5));
        assert_eq!(wilcoxon_signed_rank(&[0.0]), None);
    }

    /// Of 400 intervals for the mean of 30 uniform numbers, at 95 % nominal; the percentile interval
    /// is a little too short at this size (about 93 %), and 400 tries have a sd of 1.3 %.
    #[test]
    fn bootstrap_intervals_cover() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let covered = (0..400)
            .filter(|_| {
                let values: Vec<f64> = (0..30).map(|_| rng.random::<f64>()).collect();
                let [low, high] = bootstrap_interval(&values, 0.95, 500, &mut rng).unwrap();
                low < 0.5 && 0.5 < high
            })
            .count();
        assert!((356..=392).contains(&covered), "{covered} of 400");
    }
}
