//! Squared extrapolation of the EM map (Varadhan and Roland 2008, scheme S3), held back by the likelihood.

use asami_math::elementary::{exp, ln};

use super::parameters::Parameters;

/// Where the next E-step is to be made, by what the last ones found.
#[derive(Clone, Debug)]
pub struct Squarem<const N: usize> {
    points: Vec<Vec<f64>>,
    /// Longest extrapolation allowed.
    longest: f64,
    /// Whether the last point was extrapolated: a plain step is to follow.
    pub far: bool,
}

impl<const N: usize> Default for Squarem<N> {
    fn default() -> Self {
        Self { points: Vec::new(), longest: 4.0, far: false }
    }
}

impl<const N: usize> Squarem<N> {
    /// A fresh one, for use after the last extrapolation turned out bad.
    #[must_use]
    pub fn slower(&self) -> Self {
        let longest = if self.longest > 4.0 { 0.25 * self.longest } else { 2.0 };
        Self { points: Vec::new(), longest, far: false }
    }

    /// The next point, where `next` is the EM map of `lambda`.
    pub fn advance(&mut self, lambda: &Parameters<N>, next: Parameters<N>) -> Option<Parameters<N>> {
        if self.far {
            self.far = false;
            return Some(next);
        }
        self.points.push(coordinates(lambda));
        if self.points.len() < 2 {
            return Some(next);
        }
        let (x0, x1, x2) = (&self.points[0], &self.points[1], coordinates(&next));
        // r = F(x) - x, v = F(F(x)) - F(x) - r, alpha = -|r| / |v|; x - 2 alpha r + alpha^2 v.
        let r: Vec<f64> = x1.iter().zip(x0).map(|(a, b)| a - b).collect();
        let v: Vec<f64> = x2.iter().zip(x1).zip(&r).map(|((a, b), r)| a - b - r).collect();
        let length = |x: &[f64]| x.iter().fold(0.0, |sum, x| sum + x * x).sqrt();
        let mut alpha = length(&r) / length(&v);
        if alpha >= self.longest {
            alpha = self.longest;
            self.longest *= 4.0;
        }
        let x: Vec<f64> = (0..r.len()).map(|i| x0[i] + 2.0 * alpha * r[i] + alpha * alpha * v[i]).collect();
        self.points.clear();
        let extrapolated = at(&next, &x);
        self.far = alpha > 1.0 && extrapolated.is_finite();
        Some(if self.far { extrapolated } else { next })
    }
}

/// A large change of a velocity, m/s or rad/s; a large change of a logarithm is 1.
const VELOCITY: f64 = 0.1;

/// A large change of a coefficient of `f`, in its unit.
const SIZE: f64 = 1.0;

/// The parameters as a vector of comparable numbers, variances as logarithms.
fn coordinates<const N: usize>(lambda: &Parameters<N>) -> Vec<f64> {
    let mut x: Vec<f64> = lambda.velocity.iter().flat_map(|v| v.iter().map(|v| v / VELOCITY)).collect();
    x.extend(lambda.f.c[..lambda.f.n].iter().map(|c| c / SIZE));
    x.extend([ln(lambda.size_var), ln(lambda.bearing_var)]);
    x.extend(lambda.motion_var.iter().flat_map(|q| q.iter().map(|q| ln(*q))));
    x
}

/// The parameters of a vector; the prior and whatever has no coordinate are those of `like`.
fn at<const N: usize>(like: &Parameters<N>, x: &[f64]) -> Parameters<N> {
    let mut lambda = like.clone();
    let mut x = x.iter().copied();
    let mut next = || x.next().unwrap_or(0.0);
    for v in &mut lambda.velocity {
        for v in v.iter_mut() {
            *v = VELOCITY * next();
        }
    }
    let n = lambda.f.n;
    for c in &mut lambda.f.c[..n] {
        *c = SIZE * next();
    }
    lambda.size_var = exp(next());
    lambda.bearing_var = exp(next());
    for q in &mut lambda.motion_var {
        for q in q.iter_mut() {
            *q = exp(next());
        }
    }
    lambda
}
