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
use super::head::Frames;
use super::parameters::Parameters;
use super::world::{LookMoments, World};
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
    /// Frames of several bearings, where moments are exact.
    together: Frames,
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
            together: Frames::default(),
            first: None,
            looks: keep_looks.then(|| vec![look; plane.sightings.len()]),
            f,
        }
    }

    /// Counts the step from frame `t` to the next by `E D` and `E D^2`, part by part.
    pub fn displacement(&mut self, plane: &Plane, t: usize, d: &SVector<f64, N>, d2: &SVector<f64, N>) {
        let frame = &plane.frames[t];
        let length = frame.dt_s / plane.step_s;
        if length > 0.0 {
            let sums = &mut self.actions[frame.action];
            sums.steps += 1.0;
            sums.length += length;
            sums.d += d;
            sums.d2 += d2 / length;
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
            if M > 1 && seen.len() > 1 {
                self.several(world, gamma, seen, weights);
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

    /// Counts a frame of several bearings.
    fn several<const M: usize, W: World<N, M>>(
        &mut self,
        world: &W,
        gamma: &Gaussian<N>,
        seen: &[Seen],
        weights: &[Weight],
    ) {
        let (mut k, mut squares, mut sum, mut by) = (0.0, 0.0, 0.0, SVector::<f64, N>::zeros());
        for (seen, weight) in seen.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
            let (e, h) = world.innovation(&gamma.mean, seen, &self.f);
            let h_i = h.row(M - 1).transpose();
            k += weight;
            squares += weight * (e[M - 1] * e[M - 1] + h_i.dot(&(gamma.covariance * h_i)));
            sum += weight * e[M - 1];
            by += *weight * h_i;
        }
        self.together.add(k, squares, sum * sum + by.dot(&(gamma.covariance * by)));
    }

    /// The next `sigma_2^2`, and the share of it that the bearings of one frame have in common, after `before`, into
    /// `lambda`.
    pub fn common(&self, before: &Parameters<N>, lambda: &mut Parameters<N>) {
        let (var, share) = (before.bearing_var, before.common_share);
        if let Some((var, share)) = self.together.split(self.weight, self.bearing2, var, share) {
            (lambda.bearing_var, lambda.common_share) = (var, share);
        }
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

impl<const N: usize> Sums<'_, N> {
    /// The derivative of the expected log-likelihood at `lambda` by velocities and coefficients of `f`, which is that of the
    /// log-likelihood too (Fisher's identity): the complete data's information times the M-step to `next`.
    #[must_use]
    pub fn score(&self, plane: &Plane, lambda: &Parameters<N>, next: &Parameters<N>) -> Vec<f64> {
        let mut score = Vec::new();
        for (a, sums) in self.actions.iter().enumerate() {
            let information = lambda.motion_var[a].map(|q| sums.length * plane.step_s * plane.step_s / q);
            score.extend(information.component_mul(&(next.velocity[a] - lambda.velocity[a])).iter());
        }
        let n = self.f.n;
        score.extend((0..n).map(|i| {
            let row = (0..n).map(|j| self.powers[i + j] * (next.f.c[j] - lambda.f.c[j]));
            row.sum::<f64>() / lambda.size_var
        }));
        score
    }

    /// The next noise of the motion, into `lambda`, about its velocities: for each action and axis
    /// `E (D - v dt)^2 / length` over its steps and, as if these were its own too, `pooled_steps` of all actions.
    pub fn motion(&self, plane: &Plane, pooled_steps: f64, lambda: &mut Parameters<N>) {
        let square = |sums: &ActionSums<N>, v: &SVector<f64, N>| {
            let mu = v * plane.step_s;
            sums.d2 - 2.0 * mu.component_mul(&sums.d) + mu.component_mul(&mu) * sums.length
        };
        let (mut all, mut steps) = (SVector::<f64, N>::zeros(), 0.0);
        for (sums, v) in self.actions.iter().zip(&lambda.velocity) {
            all += square(sums, v);
            steps += sums.steps;
        }
        if steps <= 0.0 {
            return;
        }
        let mean = all / steps;
        for ((q, v), sums) in lambda.motion_var.iter_mut().zip(&lambda.velocity).zip(&self.actions) {
            let next = (square(sums, v) + mean * pooled_steps) / (sums.steps + pooled_steps);
            *q = next.zip_map(q, floored);
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
