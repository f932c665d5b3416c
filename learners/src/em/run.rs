//! One run of EM on one log: E-step and M-step in turn, until it has converged.

use asami_dataset::Rng;
use asami_math::kalman::Gaussian;

use super::filter::{About, Forward, Weight};
use super::outliers::{UNJUDGED, judge};
use super::pace::{Pace, SWEEPS, UNACCELERATED};
use super::parameters::Parameters;
use super::recovery::LOOK_AGAIN_EVERY;
use super::sums::Sums;
use super::world::{Problem, World};
use super::{Acceleration, Em, Expectation, MotionNoise, Outliers, smoother, start, two_filter};
use crate::learner::{Learned, Step, Verdict};
use crate::plane::Plane;

/// One run of EM on one log: the room that the iterations use again.
pub(super) struct Run<'a, const N: usize, const M: usize, W> {
    pub(super) em: &'a Em,
    pub(super) problem: Problem<'a, W>,
    pub(super) forward: Forward<N>,
    /// How far each sighting is trusted.
    pub(super) weights: Vec<Weight>,
    /// The states given all data, of the last smoother.
    pub(super) trajectory: Vec<Gaussian<N>>,
    pub(super) stage: Stage,
    /// The longest time between two frames with sightings.
    unseen_s: f64,
    /// Room for the next.
    pub(super) smoothed: Vec<Gaussian<N>>,
    /// Derivative of the log-likelihood by velocities and `f`, of the last iteration.
    pub(super) score: Vec<f64>,
    /// Weights, trajectory and EM map of the best parameters so far.
    pub(super) kept: (Vec<Weight>, Vec<Gaussian<N>>, Option<Parameters<N>>),
}

/// The filter's breaking down, as a verdict.
const BROKE_DOWN: Verdict = Verdict::Diverged { rule: "the filter broke down" };

impl<'a, const N: usize, const M: usize, W: World<N, M>> Run<'a, N, M, W> {
    pub(super) fn new(em: &'a Em, world: &'a W, plane: &'a Plane) -> Self {
        Self {
            em,
            problem: Problem { world, plane },
            forward: Forward::new(plane.frames.len()),
            weights: vec![1.0; plane.sightings.len()],
            trajectory: vec![start::nowhere(); plane.frames.len()],
            stage: Stage::Filters,
            unseen_s: plane.longest_unseen_s(),
            smoothed: vec![start::nowhere(); plane.frames.len()],
            score: Vec::new(),
            kept: (Vec::new(), Vec::new(), None),
        }
    }

    /// Learns from `lambda` on; the best model is returned (section 4.4.1).
    pub(super) fn learn(&mut self, lambda: Parameters<N>, rng: &mut Rng) -> Learned {
        let mut learned = Learned::default();
        let mut best = self.converge(lambda.clone(), &mut learned, rng);
        if self.em.second_try
            && let Some(lambda) = self.tried_anew(&lambda, &best.1)
        {
            *self = Self::new(self.em, self.problem.world, self.problem.plane);
            let verdict = learned.verdict;
            let again = self.converge(lambda, &mut learned, rng);
            if again.0 > best.0 {
                best = again;
            } else {
                learned.verdict = verdict;
            }
        }
        learned.models = self.with_errors(best.1);
        learned
    }

    /// Iterates from `lambda` to convergence: the greatest log-likelihood, and the parameters.
    pub(super) fn converge(
        &mut self,
        mut lambda: Parameters<N>,
        learned: &mut Learned,
        rng: &mut Rng,
    ) -> (f64, Parameters<N>) {
        let mut best = (f64::NEG_INFINITY, lambda.clone());
        let mut pace = Pace::default();
        let (mut since_best, mut settled, mut last) = (0, 0, f64::NEG_INFINITY);
        for i in 0..self.em.max_iterations {
            if pace.jumped {
                self.settle(&lambda, SWEEPS);
            }
            let first = self.filters_first();
            if self.iterates() && i >= first && (i - first).is_multiple_of(LOOK_AGAIN_EVERY) {
                self.look_again(&lambda);
            }
            let found = self.iterate(&lambda, i, rng);
            learned.iterations = Some(learned.iterations.unwrap_or(0) + 1);
            if let Some((log_likelihood, next)) = &found {
                let models = lambda.models(self.problem.plane, None);
                learned.history.push(Step { t_s: None, log_likelihood: Some(*log_likelihood), models });
                // The likelihood of a part of the sightings is no rival to that of all.
                let partial = i == 0 && self.em.outliers == Outliers::Gate || self.preliminary(i);
                since_best = if partial { 0 } else { since_best + 1 };
                if partial {
                    best.1 = lambda.clone();
                } else if *log_likelihood > best.0 {
                    best = (*log_likelihood, lambda.clone());
                    since_best = 0;
                    self.keep(next);
                }
                settled = if (log_likelihood - last).abs() < self.em.tolerance { settled + 1 } else { 0 };
                last = *log_likelihood;
            }
            let next = match self.em.acceleration {
                Acceleration::None => found.map(|(_, next)| next),
                // The first steps are long, and all over the place.
                _ if i < UNACCELERATED.max(self.filters_first() + 2) || self.preliminary(i) => {
                    found.map(|(_, next)| next)
                }
                _ => self.accelerated(&lambda, found, &mut pace),
            };
            let Some(next) = next else {
                learned.verdict = BROKE_DOWN;
                break;
            };
            let steady = self.em.acceleration == Acceleration::None || pace.steps > SETTLED;
            if since_best >= self.em.patience || settled >= SETTLED && steady && !self.preliminary(i) {
                break;
            }
            lambda = next;
        }
        best
    }

    /// Brings the trajectory to where `lambda` has it, after a step too long for the one sweep of an E-step: the
    /// likelihood about another's trajectory may be far too great or too small.
    pub(super) fn settle(&mut self, lambda: &Parameters<N>, sweeps: u32) {
        for _ in 0..sweeps {
            let _ = self.sweep(lambda, false, None);
        }
    }

    /// Whether sweeps are linearised about the trajectory of the sweep before.
    pub(super) fn iterates(&self) -> bool {
        matches!(self.em.expectation, Expectation::Iterated | Expectation::Averaged)
    }

    /// The E-step in use: an iterated smoother is no good before there is a trajectory to iterate about, and two
    /// filters go astray less than one while the models are poor.
    fn method(&self) -> Expectation {
        match self.stage {
            Stage::Filters if self.iterates() => Expectation::TwoFilters,
            Stage::Smoother if self.iterates() => Expectation::Rts,
            _ => self.em.expectation,
        }
    }

    /// Whether the likelihood is not yet that of the iterations to come.
    fn preliminary(&self, i: u32) -> bool {
        self.unjudged(i) || self.iterates() && i < self.filters_first()
    }

    /// Iterations with two filters, before any are linearised about a smoothed trajectory. None where nothing is seen
    /// for long: the backward filter knows nothing of the robot on the far side of such a gap.
    fn filters_first(&self) -> u32 {
        if self.unseen_s > LONG_UNSEEN_S { 0 } else { FILTERS_FIRST }
    }

    /// Whether the mixture of true and false sightings has not come into play yet.
    fn unjudged(&self, i: u32) -> bool {
        self.em.outliers == Outliers::Mixture && i < self.filters_first() + UNJUDGED
    }

    /// One iteration: the log-likelihood of `lambda`, and the parameters that maximise the expected
    /// log-likelihood (eq. 4.15), term by term.
    fn iterate(&mut self, lambda: &Parameters<N>, i: u32, rng: &mut Rng) -> Option<(f64, Parameters<N>)> {
        let (log_likelihood, sums) = self.expect(lambda, i, rng)?;
        let (plane, mut next) = (self.problem.plane, lambda.clone());
        // pi' = gamma_0 maximises the first term.
        if let Some(first) = sums.first {
            next.prior = first;
        }
        sums.velocities(plane, &mut next);
        // Two filters do not say how displacements vary.
        if let (MotionNoise::Learned { pooled_steps }, false) =
            (self.em.motion, self.method() == Expectation::TwoFilters)
        {
            sums.motion(plane, pooled_steps, &mut next);
        }
        sums.sensor(&mut next);
        if self.em.one_head && self.method() != Expectation::TwoFilters {
            sums.common(lambda, &mut next);
        }
        self.score = sums.score(plane, lambda, &next);
        if let (Some(looks), false) = (&sums.looks, self.unjudged(i)) {
            judge(plane, looks, &mut self.weights, &mut next);
        }
        next.is_finite().then_some((log_likelihood, next))
    }

    /// The E-step: the log-likelihood of `lambda`, and the sums that the M-step needs.
    fn expect<'r>(&mut self, lambda: &Parameters<N>, i: u32, rng: &'r mut Rng) -> Option<(f64, Sums<'r, N>)> {
        let plane = self.problem.plane;
        let mixture = self.em.outliers == Outliers::Mixture;
        if !mixture {
            self.weights.fill(1.0);
        }
        let gate = i == 0 && self.em.outliers == Outliers::Gate;
        let mut sums = Sums::new(self.em.exact, plane, lambda.f, mixture, rng);
        self.sweep(lambda, gate, Some(&mut sums))?;
        Some((self.forward.log_likelihood, sums))
    }

    /// Forward and back over the log once.
    fn sweep(&mut self, lambda: &Parameters<N>, gate: bool, sums: Option<&mut Sums<'_, N>>) -> Option<()> {
        let (problem, trajectory) = (self.problem, &self.trajectory);
        let about = match self.method() {
            Expectation::Iterated => About::Means(trajectory),
            Expectation::Averaged => About::States(trajectory),
            Expectation::Rts | Expectation::TwoFilters => About::Own,
        };
        self.forward.run(problem, lambda, about, &mut self.weights, gate)?;
        match (self.method(), sums) {
            (Expectation::TwoFilters, None) => {}
            (Expectation::TwoFilters, Some(sums)) => {
                two_filter::backward(problem, lambda, &self.forward, &self.weights, sums)?;
            }
            (Expectation::Rts | Expectation::Iterated | Expectation::Averaged, sums) => {
                let smoothed = &mut self.smoothed;
                smoother::backward(problem, lambda, about, &self.forward, &self.weights, smoothed, sums)?;
                std::mem::swap(&mut self.smoothed, &mut self.trajectory);
            }
        }
        Some(())
    }
}

/// Where an iterated smoother stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// Two filters come first.
    Filters,
    /// A smoother makes a trajectory to start with.
    Smoother,
    /// Sweeps are linearised about the trajectory.
    Trajectory,
}

/// Iterations with two filters, before any are linearised about a smoothed trajectory.
pub(super) const FILTERS_FIRST: u32 = 20;

/// Longer than any head takes to scan.
const LONG_UNSEEN_S: f64 = 20.0;

/// Iterations in a row that must gain less than the tolerance.
const SETTLED: u32 = 3;
