//! Expectation-maximisation over a robot's states (chapter 4 of Stronger 2008), as one loop with replaceable
//! questions. Every combination that has a name is a learner of its own.
//!
//! | question | answers | where |
//! |---|---|---|
//! | E-step | two filters, as published; RTS smoother; iterated smoother | [`two_filter`], [`smoother`] |
//! | M-step | one sample a frame, as published; exact moments | [`sums`] |
//! | noise of the motion | given; learned for each action | [`sums`] |
//! | outliers | gate, as published; mixture of true and false sightings | [`filter`], [`outliers`] |
//! | acceleration | none; squared extrapolation | [`squarem`] |
//! | structure | a table; velocities that borrow strength from each other | [`structure`] |
//! | kind of world | the plane; a line | [`field`], [`track`] |
//!
//! Standard errors come from the innovations' [`information`], for all of them.

pub mod consistency;
pub mod curve;
pub mod field;
pub mod filter;
pub mod information;
pub mod noise;
pub mod outliers;
pub mod parameters;
pub mod smoother;
pub mod squarem;
pub mod start;
pub mod structure;
pub mod sums;
pub mod track;
pub mod two_filter;
pub mod world;

use asami_dataset::{ActionModel, Log, Models, Rng};
use asami_math::kalman::Gaussian;
use nalgebra::SVector;

use crate::learner::{CannotLearn, Lack, Learned, Step, Verdict};
use crate::plane::Plane;
use field::Field;
use filter::{About, Forward, Weight};
use outliers::{UNJUDGED, judge};
use parameters::{Parameters, given_sensor};
use squarem::Squarem;
use sums::Sums;
use track::Track;
use world::{Problem, World};

/// How the distribution of the states is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// A forward and a backward filter, combined (section 4.2).
    TwoFilters,
    /// Forward filter and RTS smoother.
    Rts,
    /// The same, linearised about the trajectory smoothed last.
    Iterated,
    /// The same, linearised on average over the states smoothed last.
    Averaged,
}

/// What becomes of the noise of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionNoise {
    /// It stays as given.
    Given,
    /// It is learned along each of the robot's axes, for each action; each action's variances are drawn to those
    /// of all actions as if so many steps of these had been executed besides. Needs exact moments.
    Learned {
        /// How many.
        pooled_steps: f64,
    },
}

/// What becomes of false sightings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outliers {
    /// Every sighting is taken as it is.
    None,
    /// The gate of section 4.4.1, in the first iteration.
    Gate,
    /// Sightings are a mixture of true ones and false ones, the latter of any size and bearing; needs exact
    /// moments.
    Mixture,
}

/// How iterations are made fewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acceleration {
    /// Not.
    None,
    /// Squared extrapolation (Varadhan and Roland 2008).
    Squarem,
    /// The same, and now and then a Newton step with the information of the innovations.
    Newton,
}

/// What the velocities of different actions have to do with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// Nothing.
    Table,
    /// They lie about a smooth function of the attempted velocities.
    Smooth,
}

/// The answers to the questions.
#[derive(Clone, Debug)]
pub struct Em {
    /// How the distribution of the states is found.
    pub expectation: Expectation,
    /// Exact moments in the M-step, rather than a sample.
    pub exact: bool,
    /// What becomes of the noise of the motion.
    pub motion: MotionNoise,
    /// What becomes of false sightings.
    pub outliers: Outliers,
    /// How iterations are made fewer.
    pub acceleration: Acceleration,
    /// What the velocities of different actions have to do with each other.
    pub structure: Structure,
    /// Whether learning is tried again where the robot seems to have been lost, or an action's velocity is unlike all
    /// others'.
    pub second_try: bool,
    /// Coefficients of `f`.
    pub coefficients: usize,
    /// Stops after so many iterations without a new best likelihood.
    pub patience: u32,
    /// Stops when the likelihood grows by less an iteration, in nats.
    pub tolerance: f64,
    /// Stops after so many iterations at the latest.
    pub max_iterations: u32,
}

impl Default for Em {
    /// As published.
    fn default() -> Self {
        Self {
            expectation: Expectation::TwoFilters,
            exact: false,
            motion: MotionNoise::Given,
            outliers: Outliers::Gate,
            acceleration: Acceleration::None,
            structure: Structure::Table,
            second_try: false,
            coefficients: 4,
            patience: 50,
            tolerance: 0.0,
            max_iterations: 5000,
        }
    }
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
        let lacks = lacks(&plane, given, false);
        Ok(Learned { lacks, ..Run::new(self, &world, &plane).learn(lambda, rng) })
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
        let lacks = lacks(&plane, given, true);
        Ok(Learned { lacks, ..Run::new(self, &Track, &plane).learn(lambda, rng) })
    }
}

/// What the log lacks, actions included that are in the starting models and never executed.
fn lacks(plane: &Plane, given: &Models, along_a_line: bool) -> Vec<Lack> {
    let mut lacks = plane.lacks(along_a_line);
    let entries = match &given.action {
        Some(ActionModel::Table(entries)) => &entries[..],
        _ => &[],
    };
    let used = |id: u16| plane.actions.iter().any(|action| action.id == Some(id));
    let unused: Vec<u16> = entries.iter().map(|entry| entry.action).filter(|id| !used(*id)).collect();
    if !unused.is_empty() {
        lacks.push(Lack::UnusedActions { actions: unused });
    }
    lacks
}

/// The filter's breaking down, as a verdict.
const BROKE_DOWN: Verdict = Verdict::Diverged { rule: "the filter broke down" };

/// One run of EM on one log: the room that the iterations use again.
struct Run<'a, const N: usize, const M: usize, W> {
    em: &'a Em,
    problem: Problem<'a, W>,
    forward: Forward<N>,
    /// How far each sighting is trusted.
    weights: Vec<Weight>,
    /// The states given all data, of the last smoother.
    trajectory: Vec<Gaussian<N>>,
    stage: Stage,
    /// Room for the next.
    smoothed: Vec<Gaussian<N>>,
    /// Derivative of the log-likelihood by velocities and `f`, of the last iteration.
    score: Vec<f64>,
    /// Weights, trajectory and EM map of the best parameters so far.
    kept: (Vec<Weight>, Vec<Gaussian<N>>, Option<Parameters<N>>),
}

impl<'a, const N: usize, const M: usize, W: World<N, M>> Run<'a, N, M, W> {
    fn new(em: &'a Em, world: &'a W, plane: &'a Plane) -> Self {
        Self {
            em,
            problem: Problem { world, plane },
            forward: Forward::new(plane.frames.len()),
            weights: vec![1.0; plane.sightings.len()],
            trajectory: vec![start::nowhere(); plane.frames.len()],
            stage: Stage::Filters,
            smoothed: vec![start::nowhere(); plane.frames.len()],
            score: Vec::new(),
            kept: (Vec::new(), Vec::new(), None),
        }
    }

    /// Learns from `lambda` on; the best model is returned (section 4.4.1).
    fn learn(&mut self, lambda: Parameters<N>, rng: &mut Rng) -> Learned {
        let mut learned = Learned::default();
        let mut best = self.converge(lambda.clone(), &mut learned, rng);
        if self.em.second_try
            && let Some(lambda) = self.tried_anew(&lambda, &best.1)
        {
            *self = Self::new(self.em, self.problem.world, self.problem.plane);
            let again = self.converge(lambda, &mut learned, rng);
            if again.0 > best.0 {
                best = again;
            }
        }
        learned.models = self.with_errors(best.1);
        learned
    }

    /// Where to try again from. Where a great share of the sightings seemed false, or sizes
    /// err much more than from one sighting to the next, the robot was lost: the `start`, with no
    /// motion of any action, by which robots are lost less than by wrong motion. Else what was `found`, with no motion and the starting noise
    /// for actions whose velocities are far from all others': a turning rate that brings the robot round between two looks is
    /// a likelihood's maximum too. `None` where nothing is odd.
    fn tried_anew(&self, start: &Parameters<N>, found: &Parameters<N>) -> Option<Parameters<N>> {
        let noise = self.problem.plane.local_noise();
        if found.false_share > LOST || found.size_var > POOR * noise * noise {
            return Some(Parameters { velocity: vec![SVector::zeros(); start.velocity.len()], ..start.clone() });
        }
        let mut next = found.clone();
        let mut odd = false;
        for axis in 0..N {
            let mut values: Vec<f64> = found.velocity.iter().map(|v| v[axis]).collect();
            let middle = median(&mut values);
            let mut off: Vec<f64> = values.iter().map(|v| (v - middle).abs()).collect();
            let usual = median(&mut off);
            for (a, v) in found.velocity.iter().enumerate() {
                if (v[axis] - middle).abs() > ODD * usual {
                    (next.velocity[a], next.motion_var[a]) = (SVector::zeros(), start.motion_var[a]);
                    odd = true;
                }
            }
        }
        odd.then_some(next)
    }

    /// Iterates from `lambda` to convergence: the greatest log-likelihood, and the parameters.
    fn converge(&mut self, mut lambda: Parameters<N>, learned: &mut Learned, rng: &mut Rng) -> (f64, Parameters<N>) {
        let mut best = (f64::NEG_INFINITY, lambda.clone());
        let mut pace = Pace::default();
        let (mut since_best, mut settled, mut last) = (0, 0, f64::NEG_INFINITY);
        for i in 0..self.em.max_iterations {
            if pace.jumped {
                self.settle(&lambda, SWEEPS);
            }
            if self.iterates() && i >= FILTERS_FIRST && (i - FILTERS_FIRST).is_multiple_of(LOOK_AGAIN_EVERY) {
                self.look_again(&lambda);
            }
            let found = self.iterate(&lambda, i, rng);
            learned.iterations = Some(learned.iterations.unwrap_or(0) + 1);
            since_best += 1;
            if let Some((log_likelihood, next)) = &found {
                let models = lambda.models(self.problem.plane, None);
                learned.history.push(Step { t_s: None, log_likelihood: Some(*log_likelihood), models });
                // The likelihood of a part of the sightings is no rival to that of all.
                let partial = i == 0 && self.em.outliers == Outliers::Gate || self.preliminary(i);
                if *log_likelihood > best.0 && !partial {
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
                _ if i < UNACCELERATED || self.preliminary(i) => found.map(|(_, next)| next),
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

    /// Remembers where the best parameters led, with the trajectory: a bad step must not leave its own behind, for
    /// the next sweep would be linearised about it.
    fn keep(&mut self, next: &Parameters<N>) {
        if self.em.acceleration != Acceleration::None {
            self.kept.0.clone_from(&self.weights);
            self.kept.1.clone_from(&self.trajectory);
            self.kept.2 = Some(next.clone());
        }
    }

    /// Brings the trajectory to where `lambda` has it, after a step too long for the one sweep of an E-step: the
    /// likelihood about another's trajectory may be far too great or too small.
    fn settle(&mut self, lambda: &Parameters<N>, sweeps: u32) {
        for _ in 0..sweeps {
            let _ = self.sweep(lambda, false, None);
        }
    }

    /// Whether sweeps are linearised about the trajectory of the sweep before.
    fn iterates(&self) -> bool {
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

    /// Takes the trajectory that an extended Kalman filter leads to if that makes the observations more likely. Where
    /// the robot was lost once it stays lost otherwise: motion and sightings are linearised where it is thought to be.
    fn look_again(&mut self, lambda: &Parameters<N>) {
        let weights = self.weights.clone();
        // Sightings that seemed false may have seemed so to a robot that was lost.
        self.weights.fill(1.0);
        self.settle(lambda, 1);
        let (log_likelihood, trajectory) = (self.forward.log_likelihood, self.trajectory.clone());
        let had_one = self.stage == Stage::Trajectory;
        self.stage = Stage::Smoother;
        self.settle(lambda, 1);
        self.stage = Stage::Trajectory;
        self.settle(lambda, SWEEPS + 1);
        if had_one && self.forward.log_likelihood <= log_likelihood + 1.0 {
            (self.weights, self.trajectory) = (weights, trajectory);
        }
    }

    /// Where to make the next E-step, after what the one at `lambda` found.
    fn accelerated(
        &mut self,
        lambda: &Parameters<N>,
        found: Option<(f64, Parameters<N>)>,
        pace: &mut Pace<N>,
    ) -> Option<Parameters<N>> {
        let (log_likelihood, next) = match (found, &self.kept.2) {
            (Some((log_likelihood, next)), _) if log_likelihood >= pace.reference - FALLEN => (log_likelihood, next),
            (Some(found), None) => found,
            (None, None) => return None,
            // Back to the best, and slowly on from there.
            (_, Some(kept)) => {
                self.weights.clone_from(&self.kept.0);
                self.trajectory.clone_from(&self.kept.1);
                // A step of EM proper may be worse too: it is taken nevertheless.
                *pace = Pace { squarem: pace.squarem.slower(), ..Pace::default() };
                return Some(kept.clone());
            }
        };
        pace.steps += 1;
        pace.reference = pace.reference.max(log_likelihood);
        if self.em.acceleration == Acceleration::Newton && pace.steps.is_multiple_of(NEWTON_EVERY) {
            pace.squarem = Squarem::default();
            pace.jumped = true;
            return self.newton(lambda, &next).or(Some(next));
        }
        let next = pace.squarem.advance(lambda, next);
        pace.jumped = pace.squarem.far;
        next
    }

    /// Whether the likelihood is not yet that of the iterations to come.
    fn preliminary(&self, i: u32) -> bool {
        self.unjudged(i) || self.iterates() && i < FILTERS_FIRST
    }

    /// Whether the mixture of true and false sightings has not come into play yet.
    fn unjudged(&self, i: u32) -> bool {
        self.em.outliers == Outliers::Mixture && i < UNJUDGED
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
        self.score = sums.score(plane, lambda, &next);
        if let (Some(looks), false) = (&sums.looks, self.unjudged(i)) {
            judge(plane, looks, &mut self.weights, &mut next);
        }
        next.is_finite().then_some((log_likelihood, next))
    }

    /// The EM map's `next`, but velocities, `f` and what noise is learned where the log-likelihood's quadratic
    /// approximation at `lambda` has its maximum.
    fn newton(&self, lambda: &Parameters<N>, next: &Parameters<N>) -> Option<Parameters<N>> {
        let trajectory = &self.trajectory;
        let information = information::information(self.problem, lambda, trajectory, &self.weights)?;
        let step = information::solve(&information, &self.score)?;
        // Far from the maximum the approximation holds for a part of the way only.
        let gain = 0.5 * asami_math::decomposition::dot(&step, &self.score);
        let part = if gain > LONGEST_GAIN { (LONGEST_GAIN / gain).sqrt() } else { 1.0 };
        let mut far = next.clone();
        far.set_means(&lambda.means().iter().zip(step).map(|(mean, step)| mean + part * step).collect::<Vec<f64>>());
        if let MotionNoise::Learned { .. } = self.em.motion {
            let steps = noise::derivatives(self.problem, lambda, trajectory, &self.weights)?.newton()?;
            far.set_noise(lambda, &steps);
        }
        Some(far)
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

    /// The models of `lambda` with standard errors, after sharing between actions where the method does.
    fn with_errors(&mut self, mut lambda: Parameters<N>) -> Models {
        let plane = self.problem.plane;
        if let MotionNoise::Learned { .. } = self.em.motion {
            let _ = self.restrict(&mut lambda);
        }
        let Some(information) = self.information(&lambda) else { return lambda.models(plane, None) };
        if self.em.structure == Structure::Smooth
            && let Some(shared) = structure::shared(plane, N, &lambda.means(), &information)
        {
            lambda.set_means(&shared.parameters);
            return lambda.models(plane, Some(&information::errors(plane, &shared.covariance, true)));
        }
        let covariance = information::covariance(&information);
        lambda.models(plane, covariance.map(|c| information::errors(plane, &c, false)).as_ref())
    }

    /// Makes up for what the velocities have taken of the motion's noise: from the greatest likelihood to the
    /// greatest restricted likelihood (Patterson and Thompson 1971), `log p - 1/2 log det I`, in one Newton step. `I`, the
    /// information about velocities and `f`, is differentiated by differences.
    fn restrict(&mut self, lambda: &mut Parameters<N>) -> Option<()> {
        const CHANGE: f64 = 0.1;
        let information = self.information(lambda)?;
        let covariance = information::covariance(&information)?;
        let mut derivatives = noise::derivatives(self.problem, lambda, &self.smoothed, &self.weights)?;
        derivatives.score.fill(0.0);
        for axis in 0..N {
            let mut changes = vec![0.0; N + M];
            changes[axis] = CHANGE;
            let mut other = lambda.clone();
            other.set_noise(lambda, &changes);
            let changed = information::information(self.problem, &other, &self.smoothed, &self.weights)?;
            let rows = covariance.iter().zip(changed.iter().zip(&information));
            let trace = rows.fold(0.0, |sum, (c, (a, b))| {
                sum + c.iter().zip(a.iter().zip(b)).fold(0.0, |sum, (c, (a, b))| sum + c * (a - b))
            });
            derivatives.score[axis] = -0.5 * trace / CHANGE;
        }
        let steps = derivatives.newton()?;
        let before = lambda.clone();
        lambda.set_noise(&before, &steps);
        Some(())
    }

    /// The information about the smoothed trajectory of `lambda`; of units that the log leaves open, as if they
    /// were agreed on.
    fn information(&mut self, lambda: &Parameters<N>) -> Option<information::Information> {
        let (problem, weights) = (self.problem, &mut self.weights);
        self.forward.run(problem, lambda, About::Own, weights, false)?;
        smoother::backward(problem, lambda, About::Own, &self.forward, weights, &mut self.smoothed, None)?;
        let mut information = information::information(problem, lambda, &self.smoothed, weights)?;
        for free in lambda.free_units() {
            information::agree(&mut information, &free);
        }
        Some(information)
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// A robot was lost that found more than this share of its sightings false.
const LOST: f64 = 0.1;

/// A robot was lost whose sizes' variance is so many times that from one sighting to the next.
const POOR: f64 = 4.0;

/// A velocity is odd that is so many times farther from the middle than usual.
const ODD: f64 = 5.0;

/// Where an iterated smoother stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Two filters come first.
    Filters,
    /// A smoother makes a trajectory to start with.
    Smoother,
    /// Sweeps are linearised about the trajectory.
    Trajectory,
}

/// Iterations with two filters, before any are linearised about a smoothed trajectory.
const FILTERS_FIRST: u32 = 20;

/// Iterations from one fresh look for a better trajectory to the next.
const LOOK_AGAIN_EVERY: u32 = 25;

/// Iterations before extrapolation.
const UNACCELERATED: u32 = 22;

/// Iterations from one Newton step to the next.
const NEWTON_EVERY: u32 = 12;

/// A Newton step that promises more, in nats, is shortened.
const LONGEST_GAIN: f64 = 100.0;

/// A likelihood that is so much worse than the best, in nats, is given up.
const FALLEN: f64 = 5.0;

/// Sweeps after a long step.
const SWEEPS: u32 = 2;

/// How acceleration is getting on.
struct Pace<const N: usize> {
    squarem: Squarem<N>,
    /// The best log-likelihood since the last time that it went wrong.
    reference: f64,
    /// Steps since then.
    steps: u32,
    /// Whether the next E-step is made after a long step.
    jumped: bool,
}

impl<const N: usize> Default for Pace<N> {
    fn default() -> Self {
        Self { squarem: Squarem::default(), reference: f64::NEG_INFINITY, steps: 0, jumped: false }
    }
}

/// Iterations in a row that must gain less than the tolerance.
const SETTLED: u32 = 3;
