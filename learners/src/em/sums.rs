//! What the M-step needs of the E-step: sums over frames and steps; and the M-step's formulas.

use std::ops::Range;

use asami_dataset::Rng;
use asami_math::decomposition::{cholesky, cholesky_solve};
use asami_math::elementary::{ln, sin_cos};
use asami_math::kalman::Gaussian;
use nalgebra::SVector;
use rand::RngExt;

use super::curve::{MOST, SizeCurve};
use super::filter::Weight;
use super::parameters::Parameters;
use super::world::{LookMoments, Pair, World};
use crate::plane::{Plane, Seen};

/// Sums for one action.
#[derive(Clone, Copy, Debug)]
pub struct ActionSums<const N: usize> {
    /// Steps of some length.
    pub steps: f64,
    /// Their lengths, in steps of median length.
    pub length: f64,
    /// Mean displacements `E D`.
    pub d: SVector<f64, N>,
    /// `E D^2 / length`, part by part; only where moments are exact.
    pub d2: SVector<f64, N>,
}

/// The sums; and how they are taken: by one sample a frame as published, or of exact moments.
#[derive(Debug)]
pub struct Sums<'a, const N: usize> {
    /// Whether moments are exact.
    pub exact: bool,
    rng: &'a mut Rng,
    /// Per action.
    pub actions: Vec<ActionSums<N>>,
    /// `sum w u^j` of scaled distances `u`.
    powers: [f64; 2 * MOST - 1],
    /// `sum w u^j o_1`.
    sizes: [f64; MOST],
    /// `sum w o_1^2`.
    size2: f64,
    /// `sum w (ang - o_2)^2`.
    bearing2: f64,
    /// `sum w`.
    pub weight: f64,
    /// `gamma_0`.
    pub first: Option<Gaussian<N>>,
    /// The looks at each sighting, where a method asks for them.
    pub looks: Option<Vec<LookMoments>>,
    f: SizeCurve,
}

impl<'a, const N: usize> Sums<'a, N> {
    /// Empty sums.
    pub fn new(exact: bool, plane: &Plane, f: SizeCurve, keep_looks: bool, rng: &'a mut Rng) -> Self {
        let none = ActionSums { steps: 0.0, length: 0.0, d: SVector::zeros(), d2: SVector::zeros() };
        let look = LookMoments { distance_m: 0.0, distance_var: 0.0, bearing_error_rad: 0.0, bearing_var: 0.0 };
        Self {
            exact,
            rng,
            actions: vec![none; plane.actions.len()],
            powers: [0.0; 2 * MOST - 1],
            sizes: [0.0; MOST],
            size2: 0.0,
            bearing2: 0.0,
            weight: 0.0,
            first: None,
            looks: keep_looks.then(|| vec![look; plane.sightings.len()]),
            f,
        }
    }

    /// Counts the step from frame `t` to the next by its mean displacement alone (eq. 4.18).
    pub fn displacement(&mut self, plane: &Plane, t: usize, d: &SVector<f64, N>) {
        let frame = &plane.frames[t];
        let length = frame.dt_s / plane.step_s;
        if length > 0.0 {
            let sums = &mut self.actions[frame.action];
            sums.steps += 1.0;
            sums.length += length;
            sums.d += d;
        }
    }

    /// The same by the moments of both states.
    pub fn pair<const M: usize, W: World<N, M>>(&mut self, world: &W, plane: &Plane, t: usize, pair: &Pair<N>) {
        if self.exact {
            let frame = &plane.frames[t];
            let length = frame.dt_s / plane.step_s;
            if length > 0.0 {
                let (d, d2) = world.displacement_moments(pair);
                self.actions[frame.action].d2 += d2 / length;
                self.displacement(plane, t, &d);
            }
        } else {
            // "Approximating D as linear", E D = D(mu_xi) (section 4.3.1).
            self.displacement(plane, t, &world.displacement(&pair.now.mean, &pair.next.mean).0);
        }
    }

    /// Counts the sightings of frame `t`, of which `index` are the numbers. `None` where a sample cannot be
    /// drawn.
    pub fn frame<const M: usize, W: World<N, M>>(
        &mut self,
        world: &W,
        t: usize,
        gamma: &Gaussian<N>,
        seen: &[Seen],
        index: Range<usize>,
        weights: &[Weight],
    ) -> Option<()> {
        if t == 0 {
            self.first = Some(*gamma);
        }
        if self.exact {
            for ((seen, weight), i) in seen.iter().zip(weights).zip(index) {
                let look = world.look_moments(gamma, seen);
                if let Some(looks) = &mut self.looks {
                    looks[i] = look;
                }
                if *weight > 0.0 {
                    self.look(&look, seen, *weight);
                }
            }
        } else if weights.iter().any(|weight| *weight > 0.0) {
            // w^(i) = mu + L z, Sigma = L L^T (section 4.3.2).
            let l = gamma.covariance.cholesky()?;
            let sample = gamma.mean + l.l_dirty().lower_triangle() * normals(self.rng);
            for (seen, weight) in seen.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
                let look = world.look(&sample, seen);
                let look = LookMoments {
                    distance_m: look.distance_m,
                    distance_var: 0.0,
                    bearing_error_rad: look.bearing_error_rad,
                    bearing_var: 0.0,
                };
                self.look(&look, seen, *weight);
            }
        }
        Some(())
    }

    fn look(&mut self, look: &LookMoments, seen: &Seen, weight: Weight) {
        let n = self.f.n;
        let (u, var) = (self.f.scaled(look.distance_m), look.distance_var / (self.f.scale_m * self.f.scale_m));
        // Moments of a Gaussian: E u^(j+1) = u E u^j + j var E u^(j-1).
        let (mut before, mut power) = (0.0, weight);
        for j in 0..2 * n - 1 {
            self.powers[j] += power;
            if j < n {
                self.sizes[j] += power * seen.size;
            }
            (before, power) = (power, u * power + j as f64 * var * before);
        }
        self.size2 += weight * seen.size * seen.size;
        let e = look.bearing_error_rad;
        self.bearing2 += weight * (e * e + look.bearing_var);
        self.weight += weight;
    }

    /// The next `f`, `sigma_1^2`, `sigma_2^2`: eqs 4.25 to 4.28, into `lambda`. False where the sightings do not
    /// determine `f`: it stays then.
    pub fn sensor(&self, lambda: &mut Parameters<N>) -> bool {
        let n = self.f.n;
        let normal: Vec<Vec<f64>> = (0..n).map(|i| self.powers[i..i + n].to_vec()).collect();
        let determined = match cholesky(&normal).map(|l| cholesky_solve(&l, &self.sizes[..n])) {
            Some(c) if c.iter().all(|c| c.is_finite()) => {
                lambda.f.c[..n].copy_from_slice(&c);
                true
            }
            _ => false,
        };
        if self.weight > 0.0 {
            let c = &lambda.f.c;
            let mut error2 = self.size2;
            for i in 0..n {
                error2 -= 2.0 * c[i] * self.sizes[i];
                for j in 0..n {
                    error2 += c[i] * c[j] * self.powers[i + j];
                }
            }
            lambda.size_var = floored(error2 / self.weight, lambda.size_var);
            lambda.bearing_var = floored(self.bearing2 / self.weight, lambda.bearing_var);
        }
        determined
    }

    /// The next velocities, `v = sum E D / sum dt` (eq. 4.18), into `lambda`; actions never executed keep theirs.
    pub fn velocities(&self, plane: &Plane, lambda: &mut Parameters<N>) {
        for (v, sums) in lambda.velocity.iter_mut().zip(&self.actions) {
            if sums.length > 0.0 {
                *v = sums.d / (sums.length * plane.step_s);
            }
        }
    }
}

/// A variance that stays positive: no less than a millionth of what it was.
fn floored(var: f64, before: f64) -> f64 {
    let least = 1e-6 * before;
    if var > least { var } else { least }
}

/// Standard normal numbers, two at a time (Box and Muller 1958).
fn normals<const N: usize>(rng: &mut Rng) -> SVector<f64, N> {
    let mut z = SVector::zeros();
    for i in (0..N).step_by(2) {
        let radius = (-2.0 * ln(1.0 - rng.random::<f64>())).sqrt();
        let (s, c) = sin_cos(std::f64::consts::TAU * rng.random::<f64>());
        z[i] = radius * c;
        if i + 1 < N {
            z[i + 1] = radius * s;
        }
    }
    z
}
