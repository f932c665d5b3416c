//! Minimisation by covariance matrix adaptation, for functions of many variables without usable slopes.

use rand::{Rng, RngExt};

use crate::decomposition::{dot, svd};
use crate::elementary::{exp, ln, sin_cos};

/// When a search ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// After about so many values of the function; at least one generation is drawn.
    pub evaluations: usize,
    /// Where all values of a generation, and the best of the last few, lie within this of each other.
    pub tolerance: f64,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The best point that was drawn.
    pub at: Vec<f64>,
    /// The value there.
    pub value: f64,
    /// How many values were asked for.
    pub evaluations: usize,
}

/// The (mu/mu_w, lambda)-CMA-ES with the default parameters of Hansen, "The CMA Evolution Strategy: A Tutorial"
/// (arXiv:1604.00772, 2016, Table 1 without negative weights). It starts at `start`, whose value counts
/// too, with steps of about `sigma` in every direction; values that are no numbers are the worst.
///
/// ```
/// use asami_math::cma_es::{Until, minimise};
/// use rand::SeedableRng;
/// let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1000);
/// let bowl = |x: &[f64]| (x[0] - 1.0) * (x[0] - 1.0) + 100.0 * (x[1] + 2.0) * (x[1] + 2.0);
/// let found = minimise(bowl, &[0.0, 0.0], 0.5, Until { evaluations: 2000, tolerance: 1e-12 }, &mut rng);
/// assert!((found.at[0] - 1.0).abs() < 1e-4 && (found.at[1] + 2.0).abs() < 1e-4);
/// ```
pub fn minimise(
    mut f: impl FnMut(&[f64]) -> f64,
    start: &[f64],
    sigma: f64,
    until: Until,
    rng: &mut impl Rng,
) -> Found {
    let mut value_of = |x: &[f64]| Some(f(x)).filter(|value| !value.is_nan()).unwrap_or(f64::INFINITY);
    let mut best = Found { at: start.to_vec(), value: value_of(start), evaluations: 1 };
    if start.is_empty() {
        return best;
    }
    let mut search = Search::new(start, sigma);
    let mut recent: Vec<f64> = Vec::new();
    loop {
        let axes = search.axes();
        let mut drawn: Vec<(f64, Vec<f64>)> = (0..search.lambda)
            .map(|_| {
                let step = axes.stretch(&(0..start.len()).map(|_| normal(rng)).collect::<Vec<_>>());
                let x: Vec<f64> = search.mean.iter().zip(&step).map(|(m, y)| m + search.sigma * y).collect();
                let value = value_of(&x);
                if value < best.value {
                    (best.value, best.at) = (value, x);
                }
                (value, step)
            })
            .collect();
        best.evaluations += search.lambda;
        drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
        recent.push(drawn[0].0);
        search.learn(&drawn, &axes);
        let last = &recent[recent.len().saturating_sub(RECENT)..];
        let values = last.iter().copied().chain(drawn.iter().map(|(value, _)| *value));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let is_flat = recent.len() >= RECENT && high - low <= until.tolerance;
        if is_flat || best.evaluations >= until.evaluations || !(1e-150..1e150).contains(&search.sigma) {
            return best;
        }
    }
}

/// Generations whose best values must agree before a search ends.
const RECENT: usize = 10;

/// The distribution that steps are drawn from, and the paths by which it learns.
struct Search {
    lambda: usize,
    weights: Vec<f64>,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    generation: i32,
    mean: Vec<f64>,
    sigma: f64,
    /// Columns, symmetric.
    covariance: Vec<Vec<f64>>,
    path_sigma: Vec<f64>,
    path_c: Vec<f64>,
}

/// Principal axes of a covariance matrix: columns of unit length and a standard deviation along each.
struct Axes {
    columns: Vec<Vec<f64>>,
    sds: Vec<f64>,
}

impl Axes {
    /// A standard normal vector as one of this covariance.
    fn stretch(&self, z: &[f64]) -> Vec<f64> {
        let scaled: Vec<f64> = z.iter().zip(&self.sds).map(|(z, sd)| z * sd).collect();
        combine(&self.columns, &scaled)
    }

    /// `C^(-1/2) y`.
    fn whiten(&self, y: &[f64]) -> Vec<f64> {
        let along = self.columns.iter().zip(&self.sds).map(|(column, sd)| dot(column, y) / sd);
        combine(&self.columns, &along.collect::<Vec<_>>())
    }
}

fn combine(columns: &[Vec<f64>], by: &[f64]) -> Vec<f64> {
    let n = columns.first().map_or(0, Vec::len);
    (0..n).map(|row| columns.iter().zip(by).fold(0.0, |sum, (column, b)| sum + column[row] * b)).collect()
}

impl Search {
    fn new(start: &[f64], sigma: f64) -> Self {
        let size = start.len();
        let n = size as f64;
        let lambda = 4 + (3.0 * ln(n)) as usize;
        let mu = lambda / 2;
        // Hansen (2016), eq. 49: ln((lambda + 1) / 2) - ln i for the better half.
        let raw: Vec<f64> = (1..=mu).map(|i| ln((lambda as f64 + 1.0) / 2.0) - ln(i as f64)).collect();
        let (sum, squares) = raw.iter().fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
        let mu_eff = sum * sum / squares;
        // Hansen (2016), eqs 55 to 58.
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let c_1 = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff);
        let c_mu = 2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0) * (n + 2.0) + mu_eff);
        Self {
            lambda,
            weights: raw.iter().map(|w| w / sum).collect(),
            mu_eff,
            c_sigma,
            d_sigma: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            c_c: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            c_1,
            c_mu: c_mu.max(0.0).min(1.0 - c_1),
            generation: 0,
            mean: start.to_vec(),
            sigma,
            covariance: (0..size).map(|i| (0..size).map(|j| f64::from(u8::from(i == j))).collect()).collect(),
            path_sigma: vec![0.0; size],
            path_c: vec![0.0; size],
        }
    }

    /// A symmetric positive matrix's singular vectors are its eigenvectors.
    fn axes(&self) -> Axes {
        let svd = svd(&self.covariance);
        let least = svd.values.first().map_or(1.0, |greatest| 1e-14 * greatest).max(f64::MIN_POSITIVE);
        Axes { columns: svd.right, sds: svd.values.iter().map(|value| value.max(least).sqrt()).collect() }
    }

    /// Hansen (2016), eqs 42 to 47; `drawn` are values and steps, the best first.
    fn learn(&mut self, drawn: &[(f64, Vec<f64>)], axes: &Axes) {
        let n = self.mean.len() as f64;
        self.generation += 1;
        let better: Vec<Vec<f64>> = drawn.iter().take(self.weights.len()).map(|(_, step)| step.clone()).collect();
        let step = combine(&better, &self.weights);
        for (m, y) in self.mean.iter_mut().zip(&step) {
            *m += self.sigma * y;
        }
        let gain = (self.c_sigma * (2.0 - self.c_sigma) * self.mu_eff).sqrt();
        for (p, w) in self.path_sigma.iter_mut().zip(axes.whiten(&step)) {
            *p = (1.0 - self.c_sigma) * *p + gain * w;
        }
        // The mean length of a standard normal vector.
        let expected = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
        let length = dot(&self.path_sigma, &self.path_sigma).sqrt();
        let settled = (1.0 - (1.0 - self.c_sigma).powi(2 * self.generation)).sqrt();
        let moves = f64::from(u8::from(length / settled < (1.4 + 2.0 / (n + 1.0)) * expected));
        let gain = moves * (self.c_c * (2.0 - self.c_c) * self.mu_eff).sqrt();
        for (p, y) in self.path_c.iter_mut().zip(&step) {
            *p = (1.0 - self.c_c) * *p + gain * y;
        }
        let kept = 1.0 - self.c_1 - self.c_mu + self.c_1 * (1.0 - moves) * self.c_c * (2.0 - self.c_c);
        for (i, column) in self.covariance.iter_mut().enumerate() {
            for (j, c) in column.iter_mut().enumerate() {
                let rank_mu = better.iter().zip(&self.weights).fold(0.0, |sum, (y, w)| sum + w * y[i] * y[j]);
                *c = kept * *c + self.c_1 * self.path_c[i] * self.path_c[j] + self.c_mu * rank_mu;
            }
        }
        self.sigma *= exp((self.c_sigma / self.d_sigma) * (length / expected - 1.0));
    }
}

/// A standard normal number (Box and Muller 1958).
fn normal(rng: &mut impl Rng) -> f64 {
    let (u, v) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * ln(u)).sqrt() * sin_cos(std::f64::consts::TAU * v).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    const UNTIL: Until = Until { evaluations: 40_000, tolerance: 1e-14 };

    /// Axes a thousand times longer than others, turned: what the method is for (Hansen 2016, section B.2 gives about
    /// 6000 evaluations for an ellipsoid of ten variables down to 1e-10).
    #[test]
    fn a_turned_ellipsoid_is_found_in_the_time_that_it_takes() {
        let n = 10;
        let value = |x: &[f64]| {
            let turned = |i: usize| (0..n).fold(0.0, |sum, j| sum + x[j] * if i == j { 1.0 - 0.2 } else { -0.2 });
            (0..n).fold(0.0, |sum, i| sum + 1e6f64.powf(i as f64 / 9.0) * turned(i) * turned(i))
        };
        let mut calls = 0;
        let mut rng = ChaCha8Rng::seed_from_u64(1000);
        let counted = |x: &[f64]| {
            calls += 1;
            value(x)
        };
        let found = minimise(counted, &[1.0; 10], 0.3, UNTIL, &mut rng);
        assert!(found.value < 1e-10, "{found:?}");
        assert_eq!(found.evaluations, calls);
        assert!((3000..12_000).contains(&calls), "{calls}");
    }

    /// A bent valley: no method that looks along axes alone gets through.
    #[test]
    fn rosenbrocks_valley_is_followed_to_its_end() {
        let value =
            |x: &[f64]| x.windows(2).map(|p| 100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]) * (1.0 - p[0])).sum();
        let mut rng = ChaCha8Rng::seed_from_u64(1001);
        let found = minimise(value, &[0.0; 6], 0.3, UNTIL, &mut rng);
        assert!(found.at.iter().all(|x| (x - 1.0).abs() < 1e-4), "{found:?}");
    }

    /// What the order of the values does not tell, the method does not use.
    #[test]
    fn only_the_order_of_values_counts_and_seeds_give_the_same_bits() {
        let bowl = |x: &[f64]| dot(x, x);
        let search = |f: &dyn Fn(&[f64]) -> f64| {
            let until = Until { evaluations: 300, tolerance: 0.0 };
            minimise(f, &[0.7, -0.3, 2.0], 0.5, until, &mut ChaCha8Rng::seed_from_u64(1002)).at
        };
        let plain = search(&bowl);
        assert_eq!(plain, search(&bowl));
        assert_eq!(plain, search(&|x| exp(bowl(x)) - 5.0));
    }

    #[test]
    fn what_is_no_number_is_the_worst_and_nothing_is_searched_in_no_dimension() {
        let mut rng = ChaCha8Rng::seed_from_u64(1003);
        let half = |x: &[f64]| if x[0] < 0.0 { f64::NAN } else { x[0] };
        let found = minimise(half, &[1.0], 0.3, Until { evaluations: 500, tolerance: 0.0 }, &mut rng);
        assert!((0.0..0.01).contains(&found.value), "{found:?}");
        let found = minimise(|_| f64::NAN, &[1.0, 2.0], 0.3, Until { evaluations: 50, tolerance: 0.0 }, &mut rng);
        assert_eq!(found.at, [1.0, 2.0]);
        assert_eq!(minimise(|_| 7.0, &[], 0.3, UNTIL, &mut rng).value, 7.0);
    }
}
