//! Expectation-maximisation over a robot's states (chapter 4 of Stronger 2008), as one loop with replaceable
//! questions. Every combination that has a name is a learner of its own.
//!
//! | question | answers | where |
//! |---|---|---|
//! | E-step | two filters, as published; RTS smoother; iterated smoother | [`two_filter`], [`smoother`] |
//! | M-step | one sample a frame, as published; exact moments | [`sums`] |
//! | noise of the motion | given; learned for each action | [`sums`] |
//! | bearings of one frame | each wrong by itself; partly all alike | [`head`] |
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
pub mod head;
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

mod learner;
mod pace;
mod recovery;
mod run;
mod uncertainty;

use asami_dataset::{ActionModel, Log, Models, Rng};
use asami_math::kalman::Gaussian;

use crate::learner::{CannotLearn, Lack, Learned};
use crate::plane::Plane;
use field::Field;
pub(crate) use learner::em_learner;
use parameters::{Parameters, given_sensor};
use run::Run;
use track::Track;

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
    /// Whether bearings of one frame have a part of their errors in common, as those of one head have. Needs exact
    /// moments.
    pub one_head: bool,
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
            one_head: false,
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
    /// With a smoother linearised on average over the states smoothed last, and exact moments.
    #[must_use]
    pub fn exact() -> Self {
        Self { expectation: Expectation::Averaged, exact: true, ..Self::default() }
    }

    /// The answers that do best, each, together; each action's noise of motion drawn to that of all as in
    /// [`MotionNoise::Learned`].
    #[must_use]
    pub fn best(pooled_steps: f64) -> Self {
        Self {
            motion: MotionNoise::Learned { pooled_steps },
            one_head: true,
            outliers: Outliers::Mixture,
            acceleration: Acceleration::Newton,
            second_try: true,
            ..Self::exact()
        }
    }

    /// Learns in the plane.
    ///
    /// # Errors
    /// What the log or the starting models lack.
    pub fn in_plane(&self, log: &Log, given: &Models, rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let plane = Plane::try_from(log)?;
        let lambda = start::in_plane(&plane, given, self.coefficients)?;
        let lacks = lacks(&plane, given, false);
        Ok(Learned { lacks, ..Run::new(self, &Field::of(&plane), &plane).learn(lambda, rng) })
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

/// The velocities that so many iterations with exact moments lead to, and the trajectory under these: what other
/// methods start from. Sensor and noise stay as given: half learned, they are worse than poor ones.
pub(crate) fn warmed(
    plane: &Plane,
    lambda: Parameters<3>,
    iterations: u32,
    rng: &mut Rng,
) -> (Parameters<3>, Vec<Gaussian<3>>) {
    let em = Em { max_iterations: iterations, ..Em::exact() };
    let found = Run::new(&em, &Field::of(plane), plane).converge(lambda.clone(), &mut Learned::default(), rng).1;
    let lambda = Parameters { velocity: found.velocity, prior: found.prior, ..lambda };
    let states = smoothed(plane, &lambda);
    (lambda, states)
}

/// The states given all data, by an iterated smoother that begins anew.
pub(crate) fn smoothed(plane: &Plane, lambda: &Parameters<3>) -> Vec<Gaussian<3>> {
    let (em, world) = (Em::exact(), Field::of(plane));
    let mut run = Run::new(&em, &world, plane);
    run.look_again(lambda);
    run.trajectory
}

/// What the log lacks, actions included that are in the starting models and never executed.
pub(crate) fn lacks(plane: &Plane, given: &Models, along_a_line: bool) -> Vec<Lack> {
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
