//! All poses and all models at once: residuals, their derivatives, and the bordered normal equations.
//!
//! Expectations over what is still unknown of the poses are taken at a few points around each pose, spread
//! as the last inverse said (Barfoot, Forbes and Yoon 2020, "Exactly sparse Gaussian variational inference"):
//! the sine of an uncertain heading is on average shorter than the sine of the mean heading.

use asami_math::bordered::{Bordered, Link, STATE, Segment};

use super::spread::{Spread, between, given_parameters};
use crate::em::curve::SizeCurve;
use crate::em::parameters::Parameters;
use crate::plane::Plane;

/// Kinds of residuals: size, bearing, motion rightward, forward, turn. Each has a variance of its own.
pub(super) const KINDS: usize = 5;
/// Column of the right-hand sides for what no kind accounts for: scatter over the points, and priors.
const OTHER: usize = KINDS;
/// How vaguely the start of the trajectory is known beforehand, in m and rad.
const START_SD: [f64; STATE] = [100.0, 100.0, 100.0];

/// Everything that is estimated.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    /// `w_t` of each frame; headings are not wrapped.
    pub(super) poses: Vec<[f64; STATE]>,
    /// Velocity of each action, then the sensor's coefficients.
    pub(super) parameters: Vec<f64>,
    /// Variances by kind; those of motion are of a step of median length.
    pub(super) variances: [f64; KINDS],
}

/// A change of an estimate.
pub(super) struct Change {
    pub(super) poses: Vec<[f64; STATE]>,
    pub(super) parameters: Vec<f64>,
}

/// What is added to the information so that a step does not go too far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    /// On poses, 1/m^2 and 1/rad^2.
    pub(super) poses: f64,
    /// Whether the sensor's coefficients are held by the scatter of distances over the points: part of the cost's
    /// curvature, though not of what the sightings tell of the sensor.
    pub(super) sensor: bool,
}

/// The log as the joint estimate sees it.
pub(super) struct Joint<'a> {
    pub(super) plane: &'a Plane,
    /// Where the search began: gives the form of `f`.
    pub(super) start: Parameters<STATE>,
    /// Index of the first sighting of each frame.
    pub(super) first_sighting: Vec<usize>,
    pub(super) spreads: Vec<Spread>,
    /// How much each sighting counts: the chance that it is of what it says.
    pub(super) weights: Vec<f64>,
    /// Information and mean of the parameters beforehand.
    pub(super) prior: Vec<[f64; 2]>,
}

impl<'a> Joint<'a> {
    pub(super) fn new(plane: &'a Plane, start: &Parameters<STATE>, prior: Vec<[f64; 2]>) -> Self {
        let mut first_sighting = vec![0];
        for t in 0..plane.frames.len() {
            first_sighting.push(first_sighting[t] + plane.seen(t).len());
        }
        Self {
            start: start.clone(),
            first_sighting,
            spreads: vec![Spread::default(); plane.frames.len()],
            weights: vec![1.0; plane.sightings.len()],
            prior,
            plane,
        }
    }

    /// The form of the normal equations: a segment for each stretch of one action.
    pub(super) fn system(&self) -> Option<Bordered> {
        let links = self.plane.frames.len().checked_sub(1)?;
        let mut segments: Vec<Segment> = Vec::new();
        let sensor = STATE * self.plane.actions.len();
        for t in 0..links {
            let action = self.plane.frames[t].action;
            match segments.last_mut() {
                Some(last) if last.parameters[0] == STATE * action => last.last = t + 1,
                _ => {
                    let velocity = STATE * action..STATE * (action + 1);
                    let parameters = velocity.chain(sensor..sensor + self.start.f.n).collect();
                    segments.push(Segment { first: t, last: t + 1, parameters });
                }
            }
        }
        Bordered::new(segments, self.prior.len(), KINDS + 1)
    }

    /// `f` at an estimate.
    pub(super) fn f(&self, estimate: &Estimate) -> SizeCurve {
        let mut f = self.start.f;
        f.c[..f.n].copy_from_slice(&estimate.parameters[STATE * self.plane.actions.len()..]);
        f
    }

    /// An estimate as parameters.
    pub(super) fn parameters(&self, estimate: &Estimate) -> Parameters<STATE> {
        let [size_var, bearing_var, motion_var @ ..] = estimate.variances;
        let mut lambda = Parameters { size_var, bearing_var, ..self.start.clone() };
        lambda.set_means(&estimate.parameters);
        lambda.motion_var.fill(motion_var.into());
        lambda
    }

    /// Information and right-hand side of the prior at an estimate.
    pub(super) fn pull(&self, estimate: &Estimate) -> Vec<[f64; 2]> {
        let pull = |([information, mean], value): (&[f64; 2], &f64)| [*information, information * (mean - value)];
        self.prior.iter().zip(&estimate.parameters).map(pull).collect()
    }

    /// Adds what link `t` brings: motion from frame `t` to the next, and what was seen in frame `t` (and in
    /// the last frame, for the last link).
    pub(super) fn fill(&self, estimate: &Estimate, hold: Hold, t: usize, link: &mut Link) {
        self.rows(estimate, t, &mut |row| {
            let information = row.weight / estimate.variances[row.kind];
            for i in row.by {
                let scaled = information * i.mean;
                for j in row.by {
                    *link.at_mut(i.at, j.at) += scaled * j.mean;
                }
                *link.side_mut(i.at, row.kind) -= scaled * row.value;
                *link.side_mut(i.at, OTHER) -= information * i.scatter;
            }
            if hold.sensor {
                for by in row.differences {
                    let sensor = row.by.iter().zip(by).skip(STATE);
                    for (i, by_i) in sensor.clone() {
                        let scaled = information * by_i / row.differences.len() as f64;
                        for (j, by_j) in sensor.clone() {
                            *link.at_mut(i.at, j.at) += scaled * by_j;
                        }
                    }
                }
            }
        });
        if t == 0 {
            for (i, sd) in START_SD.iter().enumerate() {
                *link.at_mut(i, i) += 1.0 / (sd * sd);
            }
        }
        for i in 0..2 * STATE {
            *link.at_mut(i, i) += hold.poses;
        }
    }

    /// What an estimate leaves unexplained.
    pub(super) fn misfit(&self, estimate: &Estimate) -> Misfit {
        let prior = self.prior.iter().zip(&estimate.parameters);
        let prior = prior.fold(0.0, |sum, ([information, mean], x)| sum + information * (x - mean) * (x - mean));
        let mut misfit = Misfit { squares: [0.0; KINDS], cost: prior };
        for t in 0..self.plane.frames.len().saturating_sub(1) {
            self.rows(estimate, t, &mut |row| {
                let information = row.weight / estimate.variances[row.kind];
                misfit.squares[row.kind] += information * row.value * row.value;
                misfit.cost += information * (row.value * row.value + row.scatter);
            });
        }
        misfit
    }

    /// Sums over all residuals that the noise is told from; and what the inverse says is unknown of each pose.
    pub(super) fn sums(&self, estimate: &Estimate, system: &Bordered, change: &Change) -> (Sums, Vec<Spread>) {
        let mut sums = Sums {
            squares: [0.0; KINDS],
            ahead: [0.0; KINDS],
            leverage: [0.0; KINDS],
            count: [0.0; KINDS],
            sightings: vec![[0.0; 2]; self.weights.len()],
        };
        let mut spreads = vec![Spread::default(); self.spreads.len()];
        let mut own = Link { rows: 2 * STATE, width: 2 * STATE, entries: vec![0.0; 4 * STATE * STATE] };
        let mut left = Vec::new();
        system.visit_inverse(|t, covariance| {
            self.rows(estimate, t, &mut |row| {
                let (mut leverage, mut ahead) = (0.0, row.value);
                for i in row.by {
                    ahead += i.mean * self.change_at(change, t, i.at);
                    leverage += i.mean * row.by.iter().fold(0.0, |sum, j| sum + covariance.at(i.at, j.at) * j.mean);
                }
                let per_variance = 1.0 / estimate.variances[row.kind];
                sums.squares[row.kind] += row.weight * per_variance * row.value * row.value;
                sums.ahead[row.kind] += row.weight * per_variance * ahead * ahead;
                sums.leverage[row.kind] += row.weight * per_variance * leverage;
                // Motion counts once, however long it took.
                sums.count[row.kind] += if row.sighting.is_some() { row.weight } else { 1.0 };
                if let Some(sighting) = row.sighting {
                    sums.sightings[sighting][row.kind] = per_variance * (ahead * ahead + leverage);
                }
            });
            given_parameters(covariance, &mut left, &mut own);
            spreads[t] = Spread::of(&own);
        });
        if let [.., before, last] = spreads.as_mut_slice() {
            *last = Spread { displacement: [0.0; 2], ..*before };
        }
        (sums, spreads)
    }

    /// Moves the points half-way to where `spreads` has them: all the way, estimate and spread would chase each other.
    pub(super) fn spread_towards(&mut self, spreads: &[Spread]) {
        for (mine, other) in self.spreads.iter_mut().zip(spreads) {
            *mine = if mine.heading > 0.0 { between(mine, other) } else { *other };
        }
    }

    /// Change of one of the unknowns of link `t`.
    fn change_at(&self, change: &Change, t: usize, at: usize) -> f64 {
        match at {
            0..STATE => change.poses[t][at],
            _ if at < 2 * STATE => change.poses[t + 1][at - STATE],
            _ if at < 3 * STATE => change.parameters[STATE * self.plane.frames[t].action + at - 2 * STATE],
            _ => change.parameters[STATE * self.plane.actions.len() + at - 3 * STATE],
        }
    }

    /// The estimate moved by a part of a change.
    pub(super) fn moved(estimate: &Estimate, change: &Change, part: f64) -> Estimate {
        let mut next = estimate.clone();
        for (w, step) in next.poses.iter_mut().flatten().zip(change.poses.iter().flatten()) {
            *w += part * step;
        }
        for (x, step) in next.parameters.iter_mut().zip(&change.parameters) {
            *x += part * step;
        }
        next
    }
}

/// What an estimate leaves unexplained.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    /// Squares of the residuals by their variances, by kind.
    pub(super) squares: [f64; KINDS],
    /// All of them on average over the points, and the prior's: what is to be made small.
    pub(super) cost: f64,
}

/// Sums over residuals, each divided by its variance, by kind.
pub(super) struct Sums {
    pub(super) squares: [f64; KINDS],
    /// The squares where the change leads that the system was solved for.
    pub(super) ahead: [f64; KINDS],
    /// What is unknown of the residuals themselves.
    pub(super) leverage: [f64; KINDS],
    pub(super) count: [f64; KINDS],
    /// Of each sighting: expected squares of its two residuals.
    pub(super) sightings: Vec<[f64; 2]>,
}
