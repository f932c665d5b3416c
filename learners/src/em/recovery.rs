//! Robots that were lost, and velocities that cannot be.

use nalgebra::SVector;

use super::pace::SWEEPS;
use super::parameters::Parameters;
use super::run::{Run, Stage};
use super::world::World;

impl<const N: usize, const M: usize, W: World<N, M>> Run<'_, N, M, W> {
    /// Where to try again from. Where a great share of the sightings seemed false, or sizes
    /// err much more than from one sighting to the next, the robot was lost: the `start`, with no
    /// motion of any action, by which robots are lost less than by wrong motion. Else what was `found`, with no motion and the starting noise
    /// for actions whose velocities are far from all others': a turning rate that brings the robot round between two looks is
    /// a likelihood's maximum too. `None` where nothing is odd.
    pub(super) fn tried_anew(&self, start: &Parameters<N>, found: &Parameters<N>) -> Option<Parameters<N>> {
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

    /// Takes the trajectory that an extended Kalman filter leads to if that makes the observations more likely. Where
    /// the robot was lost once it stays lost otherwise: motion and sightings are linearised where it is thought to be.
    pub(super) fn look_again(&mut self, lambda: &Parameters<N>) {
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

/// Iterations from one fresh look for a better trajectory to the next.
pub(super) const LOOK_AGAIN_EVERY: u32 = 25;
