//! Expectation-maximisation over a robot's states (chapter 4 of Stronger 2008), as one loop with replaceable
//! questions. Every combination that has a name is a learner of its own.
//!
//! | question | answers | where |
//! |---|---|---|
//! | E-step | two filters, as published; RTS smoother; iterated smoother | [`two_filter`], [`smoother`] |
//! | M-step | one sample a frame, as published; exact moments | [`sums`] |
//! | kind of world | the plane; a line | [`field`], [`track`] |

pub mod curve;
pub mod field;
pub mod filter;
pub mod parameters;
pub mod smoother;
pub mod start;
pub mod sums;
pub mod track;
pub mod two_filter;
pub mod world;

use asami_dataset::{Log, Models, Rng};
use nalgebra::SVector;

use crate::learner::{CannotLearn, Learned, Step, Verdict};
use crate::plane::Plane;
use field::Field;
use filter::{Forward, Weight};
use parameters::{Parameters, given_sensor};
use sums::Sums;
use track::Track;
use world::World;

/// How the distribution of the states is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// A forward and a backward filter, combined (section 4.2).
    TwoFilters,
    /// Forward filter and RTS smoother.
    Rts,
    /// The same, linearised about the trajectory smoothed last.
    Iterated,
}

/// The answers to the questions.
#[derive(Clone, Debug)]
pub struct Em {
    /// How the distribution of the states is found.
    pub expectation: Expectation,
    /// Exact moments in the M-step, rather than a sample.
    pub exact: bool,
    /// The outlier gate in the first iteration.
    pub gate: bool,
    /// Coefficients of `f`.
    pub coefficients: usize,
    /// Stops after so many iterations without a new best likelihood.
    pub patience: u32,
    /// Stops when the likelihood grows by less, in nats.
    pub tolerance: f64,
    /// Stops after so many iterations at the latest.
    pub max_iterations: u32,
}

impl Em {
    /// Learns in the plane.
    ///
    /// # Errors
    /// What the log or the starting models lack.
    pub fn in_plane(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let plane = Plane::try_from(log)?;
        let world = Field { sensor_origin_m: plane.sensor_origin_m };
        let f = start::curve_in_plane(&plane, &given_sensor(&plane, given)?, self.coefficients);
        let mut lambda = Parameters::given(&plane, given, f, start::nowhere())?;
        plane.require(self.coefficients + 3)?;
        lambda.prior = start::prior_in_plane(&world, &plane, &lambda);
        Ok(Learned { lacks: plane.lacks(false), ..Run::new(self, &world, &plane).learn(lambda, rng) })
    }

    /// Learns along a line.
    ///
    /// # Errors
    /// What the log or the starting models lack.
    pub fn along_line(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let plane = Plane::along_a_line(log)?;
        let f = start::curve_along_line(&plane, &given_sensor(&plane, given)?, self.coefficients);
        let prior = start::prior_along_line(&plane, &f);
        let lambda = Parameters::given(&plane, given, f, prior)?;
        plane.require(self.coefficients + 3)?;
        Ok(Learned { lacks: plane.lacks(true), ..Run::new(self, &Track, &plane).learn(lambda, rng) })
    }
}

/// One run of EM on one log: the room that the iterations use again.
pub(crate) struct Run<'a, const N: usize, const M: usize, W> {
    em: &'a Em,
    world: &'a W,
    plane: &'a Plane,
    forward: Forward<N>,
    weights: Vec<Weight>,
    trajectory: Vec<SVector<f64, N>>,
    smoothed: bool,
}

/// The filter's breaking down, as a verdict.
const BROKE_DOWN: Verdict = Verdict::Diverged { rule: "the filter broke down" };

impl<'a, const N: usize, const M: usize, W: World<N, M>> Run<'a, N, M, W> {
    fn new(em: &'a Em, world: &'a W, plane: &'a Plane) -> Self {
        Self {
            em,
            world,
            plane,
            forward: Forward::new(plane.frames.len()),
            weights: vec![1.0; plane.sightings.len()],
            trajectory: vec![SVector::zeros(); plane.frames.len()],
            smoothed: false,
        }
    }

    /// Iterates from `lambda` to convergence; the best model is returned (section 4.4.1).
    fn learn(&mut self, mut lambda: Parameters<N>, rng: &mut Rng) -> Learned {
        let mut learned = Learned::default();
        let mut best = (f64::NEG_INFINITY, lambda.clone());
        let (mut since_best, mut last) = (0, f64::NEG_INFINITY);
        for i in 0..self.em.max_iterations {
            let Some((log_likelihood, next)) = self.iterate(&lambda, i, rng) else {
                learned.verdict = BROKE_DOWN;
                break;
            };
            let models = lambda.models(self.plane, None);
            learned.history.push(Step { t_s: None, log_likelihood: Some(log_likelihood), models });
            learned.iterations = Some(i + 1);
            since_best += 1;
            // The likelihood of a part of the sightings is no rival to that of all.
            let gated = i == 0 && self.em.gate;
            if log_likelihood > best.0 && !gated {
                best = (log_likelihood, lambda);
                since_best = 0;
            }
            let settled = (log_likelihood - last).abs() < self.em.tolerance && !gated;
            if since_best >= self.em.patience || settled {
                break;
            }
            (lambda, last) = (next, log_likelihood);
        }
        learned.models = best.1.models(self.plane, None);
        learned
    }

    /// One iteration: the log-likelihood of `lambda`, and the next.
    fn iterate(&mut self, lambda: &Parameters<N>, i: u32, rng: &mut Rng) -> Option<(f64, Parameters<N>)> {
        let (log_likelihood, sums) = self.expect(lambda, self.em.gate && i == 0, rng)?;
        let next = maximised(self.plane, lambda, &sums);
        next.is_finite().then_some((log_likelihood, next))
    }

    /// The E-step: the log-likelihood of `lambda`, and the sums that the M-step needs.
    fn expect<'r>(&mut self, lambda: &Parameters<N>, gate: bool, rng: &'r mut Rng) -> Option<(f64, Sums<'r, N>)> {
        let (world, plane) = (self.world, self.plane);
        self.weights.fill(1.0);
        let mut sums = Sums::new(self.em.exact, plane, lambda.f, false, rng);
        let about = (self.em.expectation == Expectation::Iterated && self.smoothed).then_some(&self.trajectory[..]);
        self.forward.run(world, plane, lambda, about, &mut self.weights, gate)?;
        match self.em.expectation {
            Expectation::TwoFilters => {
                two_filter::backward(world, plane, lambda, &self.forward, &self.weights, &mut sums)?;
            }
            Expectation::Rts | Expectation::Iterated => {
                let trajectory = &mut self.trajectory;
                smoother::backward(world, plane, &self.forward, &self.weights, trajectory, Some(&mut sums))?;
                self.smoothed = true;
            }
        }
        Some((self.forward.log_likelihood, sums))
    }
}

/// The M-step: the parameters that maximise the expected log-likelihood (eq. 4.15), term by term.
fn maximised<const N: usize>(plane: &Plane, lambda: &Parameters<N>, sums: &Sums<'_, N>) -> Parameters<N> {
    let mut next = lambda.clone();
    // pi' = gamma_0 maximises the first term.
    if let Some(first) = sums.first {
        next.prior = first;
    }
    sums.velocities(plane, &mut next);
    sums.sensor(&mut next);
    next
}
