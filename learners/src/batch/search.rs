//! The ascent: poses and models by damped Gauss-Newton, the noise between.

use asami_math::bordered::Bordered;
use asami_math::elementary::{exp, ln};

use super::joint::{Change, Estimate, Hold, Joint, KINDS, Misfit, Sums};
use super::noise::{self, Information};
use super::{Batch, poses};
use crate::em::{self, field::Field, parameters::Parameters, start};
use crate::learner::{Step, Verdict};

/// The noise is told from residuals only once a solve promises less than so many nats.
const NEAR: f64 = 30.0;
/// Points are spread about the poses once a step of the noise promises less than so many nats.
const FINE: f64 = 2.0;
/// Near the end, than so many.
const SETTLED: f64 = 2.0;
/// How often they are spread anew.
const SPREADS: u32 = 8;
/// Climbing ends, too, where so many steps of the noise do not raise the likelihood by so many nats.
const PATIENCE: usize = 8;
/// See [`PATIENCE`].
const STALL: f64 = 0.2;
/// Greatest number of smoothers run again under what was learned.
const REFRESHES: u32 = 6;

/// The ascent under way.
pub(super) struct Search<'a> {
    limits: &'a Batch,
    pub(super) joint: Joint<'a>,
    pub(super) estimate: Estimate,
    pub(super) system: Bordered,
    information: Information,
    damping: f64,
    /// What the last solve promised.
    promised: f64,
    false_share: f64,
    refreshes: u32,
    pub(super) solves: u32,
    pub(super) history: Vec<Step>,
}

/// Why the ascent ended where it did not converge.
type Broke = &'static str;

/// A solve and the step it led to.
struct Solve {
    /// How many nats the linearised system promised.
    promised: f64,
    /// Where it was linearised.
    from: Estimate,
    /// The whole step.
    change: Change,
    /// What is left where it led; `None` if no step lowered the cost.
    misfit: Option<Misfit>,
}

impl<'a> Search<'a> {
    pub(super) fn new(limits: &'a Batch, joint: Joint<'a>, estimate: Estimate) -> Option<Self> {
        Some(Self {
            limits,
            system: joint.system()?,
            joint,
            estimate,
            information: Information::default(),
            damping: 1.0,
            promised: f64::INFINITY,
            false_share: limits.false_share,
            refreshes: 0,
            solves: 0,
            history: Vec::new(),
        })
    }

    /// Climbs until no solve promises anything.
    pub(super) fn climb(&mut self) -> Verdict {
        let climbed = self.try_to_climb();
        // The last solve may have been of a trajectory that was dropped.
        match climbed.and(self.factorise(Hold { poses: 0.0, sensor: false })) {
            Ok(()) => Verdict::Converged,
            Err(rule) => Verdict::Diverged { rule },
        }
    }

    fn try_to_climb(&mut self) -> Result<(), Broke> {
        self.descend()?;
        while self.refresh(0.002)? {}
        self.refreshes = 0;
        let (mut fine, mut spread, mut since) = (false, 0, 0);
        loop {
            let solve = self.solve()?;
            let near = if fine { SETTLED } else { NEAR };
            if self.damping > 0.0 || solve.misfit.is_none() || solve.promised > near {
                continue;
            }
            let (sums, spreads) = self.joint.sums(&solve.from, &self.system, &solve.change);
            self.record(&sums, solve.misfit);
            let step = noise::step(&sums, &self.system, &mut self.information);
            self.estimate.variances = noise::stepped(&self.estimate.variances, &step);
            if self.limits.false_share > 0.0 {
                self.judge(&sums.sightings);
            }
            if !fine {
                fine = step.gain < FINE && !self.refresh(0.0)?;
            } else if solve.promised + step.gain < self.limits.tolerance || self.stalls(since) {
                return Ok(());
            } else {
                since += 1;
            }
            if fine && spread < SPREADS {
                spread += 1;
                self.joint.spread_towards(&spreads);
            }
        }
    }

    /// Whether the likelihood no longer rises, of the last `since` points kept.
    fn stalls(&self, since: usize) -> bool {
        let best =
            |steps: &[Step]| steps.iter().filter_map(|step| step.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
        let kept = &self.history[self.history.len().saturating_sub(since)..];
        kept.len() > PATIENCE && {
            let (before, lately) = kept.split_at(kept.len() - PATIENCE);
            best(lately) < best(before) + STALL
        }
    }

    /// Solves until little is promised, the noise as it is.
    fn descend(&mut self) -> Result<(), Broke> {
        for _solve in 0..20 {
            let solve = self.solve()?;
            if solve.misfit.is_some() && solve.promised < NEAR {
                break;
            }
        }
        Ok(())
    }

    /// Runs filter and smoother again under what was learned: where the robot had not seen anything for long,
    /// Gauss-Newton cannot turn a trajectory that went round the wrong way. Whether that gave a trajectory of a cost
    /// lower by a `share`.
    fn refresh(&mut self, share: f64) -> Result<bool, Broke> {
        self.refreshes += 1;
        if self.refreshes > REFRESHES {
            return Ok(false);
        }
        let plane = self.joint.plane;
        let learned = self.joint.parameters(&self.estimate);
        let prior = start::prior_in_plane(&Field::of(plane), plane, &learned);
        let states = em::smoothed(plane, &Parameters { prior, ..learned });
        let (before, cost) = (self.estimate.clone(), self.joint.misfit(&self.estimate).cost);
        self.estimate.poses = poses(&states);
        self.damping = 1.0;
        self.descend()?;
        // A nat of the likelihood is two of the cost.
        let better = self.joint.misfit(&self.estimate).cost < (1.0 - share) * cost - 2.0;
        if !better {
            self.estimate = before;
            self.damping = 0.0;
        }
        Ok(better)
    }

    /// Linearises, solves, and moves along the solution as far as the cost falls.
    fn solve(&mut self) -> Result<Solve, Broke> {
        if self.solves == self.limits.max_iterations {
            return Err("the likelihood still rose at the last solve");
        }
        self.solves += 1;
        let damping = self.damping;
        self.factorise(Hold { poses: damping, sensor: true })?;
        let pairs = (0..=KINDS).flat_map(|c| (0..=KINDS).map(move |d| (c, d)));
        let promised = 0.5 * pairs.fold(0.0, |sum, (c, d)| sum + self.system.gram(c, d));
        if !promised.is_finite() {
            return Err("the estimate is not finite");
        }
        let from = self.estimate.clone();
        // Where the cost bends more than it is linearised, whole steps would swing from side to side.
        let swings = promised < NEAR && promised > 0.5 * self.promised;
        self.promised = promised;
        let change = Change { poses: self.system.solution(), parameters: self.system.parameters() };
        let misfit = self.step(&change, if swings { 0.5 } else { 1.0 });
        self.damping = match misfit {
            Some(_) if damping < 1e-3 => 0.0,
            Some(_) => 0.1 * damping,
            None if damping > 1e6 => return Err("no step lowers the cost"),
            None => (10.0 * damping).max(1e-2),
        };
        Ok(Solve { promised, from, change, misfit })
    }

    fn factorise(&mut self, hold: Hold) -> Result<(), Broke> {
        let (joint, estimate) = (&self.joint, &self.estimate);
        self.system
            .factorise(&joint.pull(estimate), |t, link| joint.fill(estimate, hold, t, link))
            .ok_or("the normal equations are not positive definite")
    }

    /// Moves along the solution, as far as the cost falls, and says what is left there; `None` if it does not.
    fn step(&mut self, change: &Change, whole: f64) -> Option<Misfit> {
        let before = self.joint.misfit(&self.estimate).cost;
        let mut part = whole;
        for _halving in 0..4 {
            let next = Joint::moved(&self.estimate, change, part);
            let misfit = self.joint.misfit(&next);
            if misfit.cost < before + 1e-6 * before {
                self.estimate = next;
                return Some(misfit);
            }
            part *= 0.5;
        }
        None
    }

    /// Keeps the models and their likelihood, poses and parameters integrated out (Laplace's approximation).
    fn record(&mut self, sums: &Sums, misfit: Option<Misfit>) {
        let Some(misfit) = misfit else { return };
        let variances = self.estimate.variances.iter().zip(sums.count);
        let volume = variances.fold(0.0, |sum, (variance, n)| sum + n * ln(*variance));
        // As many factors of 2 pi as there are sightings: those of motion leave with the poses.
        let sightings = (sums.count[0] + sums.count[1]) * ln(std::f64::consts::TAU);
        let log_likelihood = -0.5 * (misfit.cost + self.system.log_det() + volume + sightings);
        let models = self.joint.parameters(&self.estimate).models(self.joint.plane, None);
        self.history.push(Step { t_s: None, log_likelihood: Some(log_likelihood), models });
    }

    /// How likely each sighting is one of what it says: false ones have any size and bearing.
    fn judge(&mut self, squares: &[[f64; 2]]) {
        let [v1, v2, ..] = self.estimate.variances;
        let sizes = self.joint.plane.sightings.iter().map(|seen| seen.size);
        let (least, greatest) = sizes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), o| (a.min(o), b.max(o)));
        let tau = std::f64::consts::TAU;
        let log_false = ln(self.false_share) - ln((greatest - least).max(1e-9) * tau);
        let log_true = ln(1.0 - self.false_share) - ln(tau) - 0.5 * ln(v1 * v2);
        let mut kept = 0.0;
        for (weight, [s1, s2]) in self.joint.weights.iter_mut().zip(squares) {
            let odds = log_false - (log_true - 0.5 * (s1 + s2));
            *weight = 1.0 / (1.0 + exp(odds.min(700.0)));
            kept += *weight;
        }
        let share = 1.0 - kept / squares.len().max(1) as f64;
        self.false_share = share.clamp(1e-4, 0.5);
    }
}
