//! Sizes at which an effect is played, and what it does between them.

use asami_math::decomposition::{cholesky, cholesky_solve, dot};
use asami_math::elementary::{exp, ln};

use crate::plant::Variant;

/// So many sizes of a kind of effect, log-spaced from its law's least to its greatest.
#[must_use]
pub fn spaced(variant: &Variant, n: usize) -> Vec<f64> {
    let (least, greatest) = variant.sizes();
    (0..n).map(|i| least * exp(i as f64 / (n - 1) as f64 * ln(greatest / least))).collect()
}

/// Weights of what was found at `sizes`, increasing, on straight lines in `scale` of the size; below the least, in the
/// size itself from none at all.
#[must_use]
pub fn straight(sizes: &[f64], size: f64, scale: fn(f64) -> f64) -> Vec<f64> {
    let mut weights = vec![0.0; sizes.len()];
    let above = sizes.partition_point(|it| *it < size).min(sizes.len() - 1);
    match above.checked_sub(1) {
        None => weights[above] = size / sizes[above],
        Some(below) => {
            let [at, low, high] = [size, sizes[below], sizes[above]].map(scale);
            weights[above] = (at - low) / (high - low);
            weights[below] = 1.0 - weights[above];
        }
    }
    weights
}

/// The same on cubics through the four sizes about each, which bend with what bends: the logarithm of a noise that a size is
/// added to, the log-odds of a share.
#[must_use]
pub fn curved(sizes: &[f64], size: f64, scale: fn(f64) -> f64) -> Vec<f64> {
    const POINTS: usize = 4;
    let above = sizes.partition_point(|it| *it < size);
    if sizes.len() < POINTS || above == 0 {
        return straight(sizes, size, scale);
    }
    let first = above.saturating_sub(POINTS / 2).min(sizes.len() - POINTS);
    let of = first..first + POINTS;
    lagrange(sizes, of, scale, size, |_| 1.0)
}

/// Weights on the polynomial through nothing at no size and what was found at some of the sizes.
#[must_use]
pub fn through(sizes: &[f64], of: std::ops::Range<usize>, size: f64) -> Vec<f64> {
    lagrange(sizes, of, |size| size, size, |at| size / at)
}

/// Weights on the cubic smoothing spline through nothing at no size (Kimeldorf and Wahba 1970): near to a straight line where sizes
/// are small, so that all of them steady what each of few logs says by itself, and near to what was found where they are large and
/// far apart. `bends` is the variance of its second derivative over shares of the greatest size, in that of what is found.
#[must_use]
pub fn smoothed(sizes: &[f64], size: f64, bends: f64) -> Vec<f64> {
    let greatest = sizes.last().copied().unwrap_or(1.0);
    let shares: Vec<f64> = sizes.iter().map(|size| size / greatest).collect();
    let covariance = |a: f64, b: f64| bends * a.min(b) * a.min(b) * (3.0 * a.max(b) - a.min(b)) / 6.0;
    let row = |a: f64| shares.iter().map(|b| covariance(a, *b)).collect::<Vec<f64>>();
    let mut covariances: Vec<Vec<f64>> = shares.iter().map(|share| row(*share)).collect();
    covariances.iter_mut().enumerate().for_each(|(i, row)| row[i] += 1.0);
    // Only sizes that are no numbers have none.
    let Some(l) = cholesky(&covariances) else { return vec![f64::NAN; sizes.len()] };
    let line = cholesky_solve(&l, &shares);
    let information = dot(&shares, &line);
    let at = size / greatest;
    let near = cholesky_solve(&l, &row(at));
    let slope = (at - dot(&shares, &near)) / information;
    near.iter().zip(&line).map(|(near, line)| near + slope * line).collect()
}

/// Weights on the polynomial in `scale` of the size through some of the sizes (Lagrange); `besides` is what further points, at
/// which nothing is found, make of the weight of each.
fn lagrange(
    sizes: &[f64],
    of: std::ops::Range<usize>,
    scale: fn(f64) -> f64,
    size: f64,
    besides: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let mut weights = vec![0.0; sizes.len()];
    for k in of.clone() {
        let others = of.clone().filter(|j| *j != k).map(|j| scale(sizes[j]));
        let first = besides(sizes[k]);
        weights[k] = others.fold(first, |weight, other| weight * (scale(size) - other) / (scale(sizes[k]) - other));
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [f64; 4] = [0.1, 0.3, 0.8, 2.0];

    fn at(weights: &[f64], of: impl Fn(f64) -> f64) -> f64 {
        weights.iter().zip(SIZES).fold(0.0, |sum, (weight, size)| sum + weight * of(size))
    }

    #[test]
    fn lines_and_logarithms_run_straight() {
        for size in [0.05, 0.1, 0.2, 0.8, 1.7, 2.0] {
            let line = at(&straight(&SIZES, size, |size| size), |size| 3.0 * size);
            assert!((line - 3.0 * size).abs() < 1e-12, "{size}: {line}");
        }
        let logarithm = at(&straight(&SIZES, 0.5, ln), |size| 2.0 + ln(size));
        assert!((logarithm - (2.0 + ln(0.5))).abs() < 1e-12, "{logarithm}");
    }

    /// Between sizes that lie a factor of three apart; straight lines are off by 0.12 at the worst of these.
    #[test]
    fn curves_bend_with_noise_and_shares() {
        for (of, about) in [
            ((|size| ln(1.0 + size)) as fn(f64) -> f64, "logarithm of a noise"),
            (|share| ln(share / (3.3 - share)), "log-odds"),
        ] {
            for size in [0.05, 0.1, 0.15, 0.2, 0.5, 0.8, 1.3, 2.0] {
                let curve = at(&curved(&SIZES, size, ln), of);
                let expected = if size < 0.1 { size / 0.1 * of(0.1) } else { of(size) };
                assert!((curve - expected).abs() < 0.05, "{about}, {size}: {curve} {expected}");
            }
        }
    }

    #[test]
    fn a_polynomial_without_a_constant_is_found_again() {
        let cubic = |s: f64| 1.5 * s - 0.7 * s * s + 0.2 * s * s * s;
        for size in [0.02, 0.1, 0.5, 1.1, 2.0] {
            let found = at(&through(&SIZES, 1..4, size), cubic);
            assert!((found - cubic(size)).abs() < 1e-12, "{size}: {found}");
        }
    }

    /// Where nothing bends, the line by least squares; where all may bend at will, what was found; between them, small sizes take
    /// after large ones.
    #[test]
    fn a_smoothing_spline_lies_between_a_line_and_what_was_found() {
        let found = |size: f64| 2.0 * size - 0.4 * size * size;
        let squares = SIZES.iter().fold(0.0, |sum, size| sum + size * size);
        let slope = SIZES.iter().fold(0.0, |sum, size| sum + size * found(*size)) / squares;
        for size in SIZES {
            let [stiff, some, none] = [0.0, 1e2, 1e12].map(|bends| smoothed(&SIZES, size, bends));
            assert!((at(&stiff, found) - slope * size).abs() < 1e-9, "{size}");
            assert!((at(&none, found) - found(size)).abs() < 1e-6, "{size}");
            let spread = some.iter().fold(0.0, |sum, weight| sum + weight * weight).sqrt();
            assert!(spread < 1.0 && (size > 0.1 || spread < 0.5), "{size}: {spread}");
            assert!((at(&some, |size| 3.0 * size) - 3.0 * size).abs() < 1e-9, "a line is found again at {size}");
        }
        let spread =
            |size: f64| smoothed(&SIZES, size, 1e2).iter().fold(0.0, |sum, weight| sum + weight * weight).sqrt();
        assert!(spread(0.05) < 0.6 * spread(0.1), "{} {}", spread(0.05), spread(0.1));
        assert!(spread(2.0) > 0.9, "{}", spread(2.0));
    }

    /// The curve has the least of a sum of squares and of bending: what is added to it, a line too, makes that more.
    #[test]
    fn no_other_curve_has_less_of_misfit_and_bending() {
        let bends = 50.0;
        let found = |size: f64| (3.0 * size).sin();
        // Bending is the integral of the second derivative's square over shares of the greatest size.
        let cost = |curve: &dyn Fn(f64) -> f64| {
            let misfit = SIZES.iter().fold(0.0, |sum, size| sum + (curve(*size) - found(*size)).powi(2));
            let h = 1e-3;
            let second = |u: f64| (curve((u - h) * 2.0) - 2.0 * curve(u * 2.0) + curve((u + h) * 2.0)) / (h * h);
            let bending = (1..999).fold(0.0, |sum, i| sum + second(f64::from(i) * 1e-3).powi(2) * 1e-3);
            misfit + bending / bends
        };
        let spline = |size: f64| at(&smoothed(&SIZES, size, bends), found);
        let least = cost(&spline);
        let others: [fn(f64) -> f64; 3] = [|u| u, |u| u * u, |u| u * u * u - u];
        for other in others {
            for by in [-0.05, 0.05] {
                let more = cost(&|size| spline(size) + by * other(size / 2.0));
                assert!(more > least, "{least} {more}");
            }
        }
    }
}
