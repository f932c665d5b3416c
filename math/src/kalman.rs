//! The Kalman filter (Kalman 1960) and the Rauch-Tung-Striebel smoother (1965) for small states.
//!
//! `N` is the size of the state, `M` that of an observation; a scalar filter is `N = M = 1`. Sizes are
//! known to the compiler, so that the order of operations is fixed.

use nalgebra::{SMatrix, SVector};

/// A mean and a covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian<const N: usize> {
    /// Mean.
    pub mean: SVector<f64, N>,
    /// Covariance.
    pub covariance: SMatrix<f64, N, N>,
}

/// How the state moves: `x' = f x + drift + noise`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<const N: usize> {
    /// Transition matrix.
    pub f: SMatrix<f64, N, N>,
    /// Known part of the motion.
    pub drift: SVector<f64, N>,
    /// Covariance of the unknown part.
    pub q: SMatrix<f64, N, N>,
}

/// What is seen of the state: `y = h x + noise`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<const N: usize, const M: usize> {
    /// Observation matrix.
    pub h: SMatrix<f64, M, N>,
    /// What was seen.
    pub y: SVector<f64, M>,
    /// Covariance of the noise.
    pub r: SMatrix<f64, M, M>,
}

/// A filtered state, and what the observation said about the prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update<const N: usize, const M: usize> {
    /// State given the observation too.
    pub state: Gaussian<N>,
    /// Observation less its prediction.
    pub innovation: SVector<f64, M>,
    /// Its covariance.
    pub innovation_covariance: SMatrix<f64, M, M>,
    /// Squared Mahalanobis length of the innovation (NIS): on average `M` if the model is right.
    pub nis: f64,
    /// Logarithm of the determinant of the innovation's covariance.
    pub log_det: f64,
}

impl<const N: usize, const M: usize> Update<N, M> {
    /// Log-density of the observation given all before it, in nats.
    #[must_use]
    pub fn log_likelihood(&self) -> f64 {
        -0.5 * (self.nis + self.log_det + M as f64 * crate::elementary::ln(std::f64::consts::TAU))
    }
}

impl<const N: usize> Gaussian<N> {
    /// The state after `motion`.
    #[must_use]
    pub fn predict(&self, motion: &Motion<N>) -> Self {
        Self {
            mean: motion.f * self.mean + motion.drift,
            covariance: motion.f * self.covariance * motion.f.transpose() + motion.q,
        }
    }

    /// The state given `seen`, by Joseph's form, which keeps the covariance positive; `None` where
    /// the innovation's covariance is not positive definite.
    #[must_use]
    pub fn update<const M: usize>(&self, seen: &Observation<N, M>) -> Option<Update<N, M>> {
        let innovation = seen.y - seen.h * self.mean;
        let innovation_covariance = seen.h * self.covariance * seen.h.transpose() + seen.r;
        let factor = innovation_covariance.cholesky()?;
        let gain = factor.solve(&(seen.h * self.covariance)).transpose();
        let left = SMatrix::<f64, N, N>::identity() - gain * seen.h;
        let state = Gaussian {
            mean: self.mean + gain * innovation,
            covariance: left * self.covariance * left.transpose() + gain * seen.r * gain.transpose(),
        };
        let log_det = (0..M).fold(0.0, |sum, i| sum + 2.0 * crate::elementary::ln(factor.l_dirty()[(i, i)]));
        Some(Update {
            state,
            innovation,
            innovation_covariance,
            nis: innovation.dot(&factor.solve(&innovation)),
            log_det,
        })
    }

    /// One step of the smoother, backwards: the state given all data, from the `filtered` state
    /// (`self`), the motion after it and the `next` state given all data. Also the covariance of the
    /// next state with this one, given all data.
    #[must_use]
    pub fn smooth(&self, motion: &Motion<N>, next: &Gaussian<N>) -> Option<(Self, SMatrix<f64, N, N>)> {
        let predicted = self.predict(motion);
        let gain = predicted.covariance.cholesky()?.solve(&(motion.f * self.covariance)).transpose();
        let state = Gaussian {
            mean: self.mean + gain * (next.mean - predicted.mean),
            covariance: self.covariance + gain * (next.covariance - predicted.covariance) * gain.transpose(),
        };
        Some((state, next.covariance * gain.transpose()))
    }
}

/// The same for a random walk with known drift and scalar observations, without matrices.
pub mod scalar {
    /// Mean and variance of a scalar state.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct State {
        /// Mean.
        pub mean: f64,
        /// Variance.
        pub variance: f64,
    }

    /// What an observation said about the prediction.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Innovation {
        /// Observation less its prediction.
        pub value: f64,
        /// Its variance.
        pub variance: f64,
    }

    impl State {
        /// The state after a walk of known `drift` and unknown part of some `variance`.
        #[must_use]
        pub fn predict(self, drift: f64, variance: f64) -> Self {
            Self { mean: self.mean + drift, variance: self.variance + variance }
        }

        /// The state given an observation `y = h x + noise`, and the innovation; `None` where the
        /// innovation's variance is not positive.
        #[must_use]
        pub fn update(self, h: f64, y: f64, variance: f64) -> Option<(Self, Innovation)> {
            let innovation = Innovation { value: y - h * self.mean, variance: h * h * self.variance + variance };
            if innovation.variance <= 0.0 || innovation.variance.is_nan() {
                return None;
            }
            let gain = h * self.variance / innovation.variance;
            let left = 1.0 - gain * h;
            let state = Self {
                mean: self.mean + gain * innovation.value,
                variance: left * left * self.variance + gain * gain * variance,
            };
            Some((state, innovation))
        }

        /// One step of the smoother, backwards: the state given all data, from the filtered state, the
        /// walk after it, and the `next` state given all data.
        #[must_use]
        pub fn smooth(self, drift: f64, variance: f64, next: Self) -> Self {
            let predicted = self.predict(drift, variance);
            if predicted.variance <= 0.0 {
                return Self { mean: next.mean - drift, ..self };
            }
            let gain = self.variance / predicted.variance;
            Self {
                mean: self.mean + gain * (next.mean - predicted.mean),
                variance: self.variance + gain * gain * (next.variance - predicted.variance),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const STEPS: usize = 12;

    struct Case {
        prior: Gaussian<2>,
        motions: Vec<Motion<2>>,
        seen: Vec<Observation<2, 1>>,
    }

    fn case(seed: u64) -> Case {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || rng.random::<f64>() - 0.5;
        let spd = |a: f64, b: f64| SMatrix::<f64, 2, 2>::new(0.7 + a, b / 3.0, b / 3.0, 0.8 + a);
        Case {
            prior: Gaussian { mean: SVector::from([draw(), draw()]), covariance: spd(draw(), draw()) * 3.0 },
            motions: (1..STEPS)
                .map(|_| Motion {
                    f: SMatrix::<f64, 2, 2>::new(1.0, draw(), draw(), 0.9),
                    drift: SVector::from([draw(), draw()]),
                    q: spd(draw(), draw()) * 0.1,
                })
                .collect(),
            seen: (0..STEPS)
                .map(|_| Observation {
                    h: SMatrix::<f64, 1, 2>::new(1.0, draw()),
                    y: SVector::from([draw()]),
                    r: SMatrix::<f64, 1, 1>::new(0.3),
                })
                .collect(),
        }
    }

    /// Mean and covariance of all states at once given all observations, and the density of these,
    /// out of one big Gaussian.
    fn oracle(case: &Case) -> (DVector<f64>, DMatrix<f64>, f64) {
        let n = 2 * STEPS;
        let (mut mean, mut prior) = (DVector::zeros(n), DMatrix::zeros(n, n));
        mean.rows_mut(0, 2).copy_from(&case.prior.mean);
        prior.view_mut((0, 0), (2, 2)).copy_from(&case.prior.covariance);
        for (k, motion) in case.motions.iter().enumerate() {
            let (now, next) = (2 * k, 2 * k + 2);
            let moved = motion.f * mean.fixed_rows::<2>(now) + motion.drift;
            mean.fixed_rows_mut::<2>(next).copy_from(&moved);
            let cross = motion.f * prior.view((now, 0), (2, next));
            prior.view_mut((next, 0), (2, next)).copy_from(&cross);
            let transposed = cross.transpose();
            prior.view_mut((0, next), (next, 2)).copy_from(&transposed);
            let own = motion.f * prior.fixed_view::<2, 2>(now, now) * motion.f.transpose() + motion.q;
            prior.fixed_view_mut::<2, 2>(next, next).copy_from(&own);
        }
        let h = DMatrix::from_fn(STEPS, n, |i, j| if j / 2 == i { case.seen[i].h[(0, j % 2)] } else { 0.0 });
        let r = DMatrix::from_diagonal(&DVector::from_fn(STEPS, |i, _| case.seen[i].r[0]));
        let innovation = DVector::from_fn(STEPS, |i, _| case.seen[i].y[0]) - &h * &mean;
        let s = &h * &prior * h.transpose() + r;
        let inverse = s.clone().try_inverse().unwrap();
        let gain = &prior * h.transpose() * &inverse;
        let log_density = -0.5
            * ((innovation.transpose() * &inverse * &innovation)[0]
                + s.determinant().ln()
                + STEPS as f64 * std::f64::consts::TAU.ln());
        (mean + &gain * innovation, &prior - &gain * h * &prior, log_density)
    }

    #[test]
    fn filter_and_smoother_are_conditioning_one_big_gaussian() {
        for seed in 0..20 {
            let case = case(seed);
            let (mean, covariance, log_density) = oracle(&case);
            let (mut state, mut filtered, mut sum) = (case.prior, Vec::new(), 0.0);
            for k in 0..STEPS {
                if k > 0 {
                    state = state.predict(&case.motions[k - 1]);
                }
                let update = state.update(&case.seen[k]).unwrap();
                sum += update.log_likelihood();
                state = update.state;
                filtered.push(state);
            }
            assert!((sum - log_density).abs() < 1e-9, "{sum} {log_density}");
            let mut next = state;
            for k in (0..STEPS).rev() {
                if k + 1 < STEPS {
                    let (smoothed, cross) = filtered[k].smooth(&case.motions[k], &next).unwrap();
                    let expected = covariance.fixed_view::<2, 2>(2 * k + 2, 2 * k);
                    assert!((cross - expected).norm() < 1e-9);
                    next = smoothed;
                }
                assert!((next.mean - mean.fixed_rows::<2>(2 * k)).norm() < 1e-9);
                assert!((next.covariance - covariance.fixed_view::<2, 2>(2 * k, 2 * k)).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn scalars_are_matrices_of_one_entry() {
        let one = |x: f64| SMatrix::<f64, 1, 1>::new(x);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut state = scalar::State { mean: 0.3, variance: 2.0 };
        let mut matrix = Gaussian { mean: one(0.3), covariance: one(2.0) };
        for _ in 0..50 {
            let (drift, q, h, y) =
                (rng.random::<f64>(), rng.random::<f64>(), rng.random::<f64>() - 0.5, rng.random::<f64>());
            let motion = Motion { f: one(1.0), drift: one(drift), q: one(q) };
            let (before, matrix_before) = (state, matrix);
            let (next, innovation) = state.predict(drift, q).update(h, y, 0.2).unwrap();
            let update = matrix.predict(&motion).update(&Observation { h: one(h), y: one(y), r: one(0.2) }).unwrap();
            assert!((innovation.value.powi(2) / innovation.variance - update.nis).abs() < 1e-12);
            assert!((innovation.variance.ln() - update.log_det).abs() < 1e-12);
            (state, matrix) = (next, update.state);
            assert!((state.mean - matrix.mean[0]).abs() < 1e-12);
            assert!((state.variance - matrix.covariance[0]).abs() < 1e-12);
            let (back, expected) = (before.smooth(drift, q, state), matrix_before.smooth(&motion, &matrix).unwrap().0);
            assert!((back.mean - expected.mean[0]).abs() < 1e-12);
            assert!((back.variance - expected.covariance[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn a_scalar_walk_settles_at_the_riccati_root() {
        let (q, r) = (0.04, 0.9);
        let mut state = scalar::State { mean: 0.0, variance: 100.0 };
        for _ in 0..500 {
            state = state.predict(0.0, q).update(1.0, 0.0, r).unwrap().0;
        }
        // Predicted variance p solves p^2 - q p - q r = 0.
        let p = 0.5 * (q + f64::sqrt(q * q + 4.0 * q * r));
        assert!((state.variance + q - p).abs() < 1e-12);
    }

    #[test]
    fn an_impossible_observation_is_refused() {
        let state = scalar::State { mean: 0.0, variance: 1.0 };
        assert!(state.update(1.0, 0.0, -2.0).is_none());
        assert!(state.update(f64::NAN, 0.0, 1.0).is_none());
    }
}
