//! What several of a kind have in common, each measured with an error of its own (Rubin 1981; Gelman et al. 2013, "Bayesian Data
//! Analysis", section 5.4).

use crate::elementary::{erfc, exp, ln};

/// Points of the sum over how far the kind scatters.
const POINTS: usize = 400;
/// Halvings of an interval that holds a quantile.
const HALVINGS: usize = 50;

/// A number as it is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Believed {
    /// Its mean.
    pub mean: f64,
    /// In it with 90 %.
    pub interval: [f64; 2],
}

/// What is believed of several of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomEffects {
    /// The kind's mean.
    pub mean: Believed,
    /// The standard deviation of what the kind scatters by besides errors: as probably greater as smaller.
    pub scatter: f64,
    /// Each of them.
    pub each: Vec<Believed>,
}

/// Normal distributions, each with its share.
struct Mixture(Vec<[f64; 3]>);

impl Mixture {
    /// Mean and variance by how far the kind scatters, with their shares.
    fn new(of: impl Iterator<Item = [f64; 2]>, shares: &[f64]) -> Self {
        Self(of.zip(shares).map(|([mean, variance], share)| [mean, variance.sqrt(), *share]).collect())
    }

    fn mean(&self) -> f64 {
        self.0.iter().fold(0.0, |sum, [mean, _, share]| sum + mean * share)
    }

    fn below(&self, x: f64) -> f64 {
        let normal = |mean: f64, sd: f64| 0.5 * erfc((mean - x) / (sd * std::f64::consts::SQRT_2));
        self.0.iter().fold(0.0, |sum, [mean, sd, share]| sum + share * normal(*mean, *sd))
    }

    fn quantile(&self, level: f64) -> f64 {
        let ends = self.0.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [mean, sd, _]| {
            [low.min(mean - 9.0 * sd), high.max(mean + 9.0 * sd)]
        });
        let found = (0..HALVINGS).fold(ends, |[low, high], _| {
            let middle = 0.5 * (low + high);
            if self.below(middle) < level { [middle, high] } else { [low, middle] }
        });
        0.5 * (found[0] + found[1])
    }

    fn believed(&self) -> Believed {
        Believed { mean: self.mean(), interval: [0.05, 0.95].map(|level| self.quantile(level)) }
    }
}

/// What is believed of `values` of a kind that is normally distributed, each measured with a standard error of `errors`, where
/// beforehand nothing is known of the kind's mean, and every scatter is as probable as any other (Gelman 2006); `None` of fewer
/// than three, and of errors that are not positive.
///
/// ```
/// use asami_math::random_effects::random_effects;
/// // Three that agree are of one kind: each is surer than it is by itself.
/// let found = random_effects(&[1.0, 1.1, 0.9], &[0.5, 0.5, 0.5]).unwrap();
/// assert!((found.mean.mean - 1.0).abs() < 1e-9);
/// assert!(random_effects(&[1.0, 1.1], &[0.5, 0.5]).is_none());
/// ```
#[must_use]
pub fn random_effects(values: &[f64], errors: &[f64]) -> Option<RandomEffects> {
    let sound = values.iter().all(|it| it.is_finite()) && errors.iter().all(|it| it.is_finite() && *it > 0.0);
    if values.len() < 3 || values.len() != errors.len() || !sound {
        return None;
    }
    let most = |of: &[f64]| of.iter().fold(f64::NEG_INFINITY, |most, it| most.max(*it));
    let least = values.iter().fold(f64::INFINITY, |least, it| least.min(*it));
    // From no scatter to any: half of the points lie below the greater of what values differ and err by.
    let unit = (most(values) - least).max(most(errors));
    let scatters: Vec<f64> =
        (0..POINTS).map(|i| (i as f64 + 0.5) / POINTS as f64).map(|share| unit * share / (1.0 - share)).collect();
    // The kind's mean and its variance where it scatters by so much, and how probable that is.
    let at = |scatter: &f64| {
        let precisions = errors.iter().map(|error| 1.0 / (error * error + scatter * scatter));
        let (weight, sum) = precisions.clone().zip(values).fold((0.0, 0.0), |(w, s), (p, x)| (w + p, s + p * x));
        let mean = sum / weight;
        let off = precisions.zip(values).fold(0.0, |off, (p, x)| off + 0.5 * (ln(p) - p * (x - mean) * (x - mean)));
        let stretched = 2.0 * ln(1.0 + scatter / unit);
        ([mean, 1.0 / weight], off - 0.5 * ln(weight) + stretched)
    };
    let (kind, density): (Vec<[f64; 2]>, Vec<f64>) = scatters.iter().map(at).unzip();
    let top = most(&density);
    let shares: Vec<f64> = density.iter().map(|it| exp(it - top)).collect();
    let whole = shares.iter().fold(0.0, |sum, it| sum + it);
    let shares: Vec<f64> = shares.into_iter().map(|it| it / whole).collect();
    let each = values.iter().zip(errors).map(|(value, error)| {
        let own = scatters.iter().zip(&kind).map(|(scatter, [mean, variance])| {
            // By how much it is drawn to the kind.
            let drawn = error * error / (error * error + scatter * scatter);
            [value + drawn * (mean - value), error * error * (1.0 - drawn) + drawn * drawn * variance]
        });
        Mixture::new(own, &shares).believed()
    });
    let below = shares.iter().scan(0.0, |below, share| {
        *below += share;
        Some(*below)
    });
    Some(RandomEffects {
        mean: Mixture::new(kind.iter().copied(), &shares).believed(),
        scatter: scatters[below.take_while(|below| *below < 0.5).count().min(POINTS - 1)],
        each: each.collect(),
    })
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use statrs::distribution::{ContinuousCDF, Normal};

    use super::*;

    /// Coaching in eight schools (Rubin 1981): posterior means as MCMC has them (Gelman et al. 2013, section 5.5, and appendix C).
    #[test]
    fn eight_schools_come_out_as_published() {
        let values = [28.0, 8.0, -3.0, 7.0, -1.0, 1.0, 18.0, 12.0];
        let errors = [15.0, 10.0, 16.0, 11.0, 9.0, 11.0, 10.0, 18.0];
        let found = random_effects(&values, &errors).unwrap();
        for (published, it) in [11.4, 7.9, 6.1, 7.6, 5.2, 6.1, 10.6, 8.4].into_iter().zip(&found.each) {
            assert!((it.mean - published).abs() < 0.25, "{published}: {it:?}");
        }
        assert!((found.mean.mean - 8.0).abs() < 0.2 && (found.scatter - 5.2).abs() < 0.5, "{found:?}");
    }

    /// Where errors are small each stands for itself, and the kind's mean is unsure by what Student's t of the values has it.
    #[test]
    fn what_is_measured_exactly_is_drawn_to_nothing() {
        let values = [1.0, 2.0, 4.0, 5.5, 7.0];
        let found = random_effects(&values, &[1e-4; 5]).unwrap();
        for (value, it) in values.iter().zip(&found.each) {
            assert!(
                (it.mean - value).abs() < 1e-6 && (it.interval[1] - it.interval[0] - 3.29e-4).abs() < 1e-5,
                "{it:?}"
            );
        }
        // Every scatter as probable as any other: t with n - 2 degrees, its 95th percentile of 3, of squares over n - 2.
        let squares: f64 = values.iter().map(|it| (it - 3.9) * (it - 3.9)).sum();
        let half = 2.353 * (squares / 3.0 / 5.0).sqrt();
        let [low, high] = found.mean.interval;
        assert!((low - (3.9 - half)).abs() < 0.02 && (high - (3.9 + half)).abs() < 0.02, "{low} {high} {half}");
    }

    /// Of kinds that scatter as much as their members err, 90 % of the intervals hold the truth.
    #[test]
    fn intervals_hold_what_they_say_of_kinds_that_scatter() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut normal = |mean: f64, sd: f64| mean + sd * Normal::standard().inverse_cdf(rng.random::<f64>());
        let (mut held, mut all) = (0, 0);
        let errors = [0.5, 1.0, 1.0, 1.5, 2.0, 0.7, 1.2, 0.9];
        for _ in 0..300 {
            let truth: Vec<f64> = errors.iter().map(|_| normal(3.0, 1.0)).collect();
            let values: Vec<f64> = truth.iter().zip(errors).map(|(it, error)| normal(*it, error)).collect();
            let found = random_effects(&values, &errors).unwrap();
            let holds = |[low, high]: [f64; 2], it: f64| low <= it && it <= high;
            held += truth.iter().zip(&found.each).filter(|(it, found)| holds(found.interval, **it)).count();
            all += truth.len();
        }
        // Three standard deviations of 300 independent logs of eight.
        let share = held as f64 / all as f64;
        assert!((share - 0.9).abs() < 0.025, "{share}");
    }
}
