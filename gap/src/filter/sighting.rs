//! What a sighting tells of the robot's pose: what is expected of it, and how that hangs on the pose.

use std::ops::AddAssign;

use asami_math::angle::wrap_rad;
use asami_math::elementary::exp;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use super::told::{Odd, Told};
use super::{Kalman, Ready, by_pose};
use crate::memory::Memory;
use crate::shape::{Numbers, Sight};
use crate::state::{Belief, State};
use crate::tails::Tails;
use crate::view::{Seen, View};

/// What a sighting tells is as good as linear where it turns the robot by less, in radians, or moves it by less of the distance.
const NEAR: f64 = 0.01;
/// Sightings that are off by less, as a square in standard deviations, are likelier by hundreds of times without any.
const RULED_OUT: f64 = 12.0;
/// Variances of 1 m to each side, and of 1 rad, where a robot may have jumped.
const JUMPS_TO: [f64; 3] = [1.0; 3];
/// A bearing that was put in, and not measured, holds the robot on its rail so closely, and says nothing.
const RAIL_RAD: f64 = 1e-3;

impl Ready<'_> {
    /// The state a step farther.
    pub(super) fn step<const N: usize>(&self, state: &mut State<N>, step: &SVector<f64, N>) {
        match self.kalman {
            Kalman::Extended => state.add(step),
            Kalman::Invariant => state.twist(step),
        }
    }

    /// What a sighting tells.
    pub(super) fn odd<const N: usize>(&mut self, view: &View, i: usize, seen: usize, state: &mut State<N>) -> Odd<N> {
        let held = self.held.of(view.seen[seen].landmark, state);
        let (odd, distance_m) = self.odd_about(view, i, seen, (state, held), SVector::zeros());
        if self.kalman == Kalman::Extended {
            return odd;
        }
        let step = odd.told(&state.covariance).map(|told| told.step);
        let is_far = |step: &SVector<f64, N>| step[2].abs() > NEAR || step[0].hypot(step[1]) > NEAR * distance_m;
        match step.filter(is_far) {
            Some(step) => self.odd_about(view, i, seen, (state, held), step).0,
            None => odd,
        }
    }

    /// What a sighting tells, linearised about the state a step farther, and how far away the landmark is there.
    fn odd_about<const N: usize>(
        &mut self,
        view: &View,
        i: usize,
        seen: usize,
        (state, held): (&State<N>, Option<usize>),
        step: SVector<f64, N>,
    ) -> (Odd<N>, f64) {
        let Seen { landmark, size, bearing_rad } = view.seen[seen];
        let mut there = *state;
        self.step(&mut there, &step);
        let belief = there.belief();
        let sight = self.sight(view, i, landmark, &belief);
        let (expected, mut of_pose) = self.expected(view, &sight, &belief);
        if self.kalman == Kalman::Invariant {
            // Of motions about where the robot was believed to be, not about where it is then.
            let moved = there.mean - state.mean;
            let turned = of_pose.column(1) * moved[0] - of_pose.column(0) * moved[1];
            of_pose.column_mut(2).add_assign(&turned);
        }
        let sways = self.sways(view, i);
        let [of_size, of_bearing] = self.noise_vars(sight.distance_m);
        let vars = [of_size, if view.aims { of_bearing } else { RAIL_RAD * RAIL_RAD }];
        let vars = [0, 1].map(|k| vars[k] * sways[k].scale * sways[k].scale);
        let plain = Vector2::new(size - expected[0], wrap_rad(bearing_rad - expected[1]));
        let mut plain = plain + of_pose * step.fixed_rows::<3>(0);
        let mut h = SMatrix::<f64, 2, N>::zeros();
        h.fixed_view_mut::<2, 3>(0, 0).copy_from(&of_pose);
        let Memory { spread, tails, lasting, .. } = self.memory;
        let swaying = State::<N>::sways().enumerate().map(|(k, at)| (k, at, sways[k].share));
        let held = held.map(|at| (0, at, lasting.share));
        let mut shared = [0.0; 2];
        for (k, at, share) in swaying.chain(held) {
            shared[k] = share;
            h[(k, at)] = (share * vars[k]).sqrt();
            plain[k] -= h[(k, at)] * state.mean[at];
        }
        let white_var = |k: usize| vars[k] * (1.0 - shared[k]);
        let r = Matrix2::from_diagonal(&Vector2::new(white_var(0), white_var(1)));
        let tails = if view.aims { tails } else { Tails::default() };
        (Odd { plain, h, r, spread, tails, aims: view.aims }, sight.distance_m)
    }

    /// Variances of what sizes and bearings of a landmark so far away scatter by. Of a real robot they change evenly from the middle of one
    /// band of distances to that of the next: whatever size moves a robot from one into another would step over nats between them.
    fn noise_vars(&self, distance_m: f64) -> [f64; 2] {
        let band = self.shape.band(distance_m);
        match self.kalman {
            Kalman::Extended => [self.size_vars[band], self.bearing_vars[band]],
            Kalman::Invariant => {
                let near = self.shape.between_bands(distance_m);
                [Numbers::SizeNoise, Numbers::BearingNoise].map(|noise| {
                    let ln_sds = &self.numbers[self.shape.range(noise)];
                    exp(2.0 * near.iter().fold(0.0, |sum, (band, weight)| sum + weight * ln_sds[*band]))
                })
            }
        }
    }

    /// What a sighting tells that a robot's belief rules out, had the robot jumped.
    pub(super) fn jumped<const N: usize>(&self, odd: &Odd<N>, told: &Told<N>, state: &State<N>) -> Option<Told<N>> {
        if !self.memory.sways() || told.squares() < RULED_OUT {
            return None;
        }
        let mut covariance = state.covariance;
        JUMPS_TO.iter().enumerate().for_each(|(axis, var)| covariance[(axis, axis)] += var);
        odd.told(&covariance)
    }

    /// Size and bearing to be expected, and their derivatives with respect to the pose.
    fn expected(&mut self, view: &View, sight: &Sight, belief: &Belief) -> ([f64; 2], SMatrix<f64, 2, 3>) {
        let mut slopes = [0.0; 4];
        self.shape.size_columns(sight, &mut self.size_columns, &mut slopes);
        self.shape.bearing_columns(sight, &mut self.bearing_columns);
        let (for_size, for_bearing) = (&self.numbers[self.size.clone()], &self.numbers[self.bearing.clone()]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
        let slope = dot(&slopes[..self.shape.curve_width()], for_size);
        let [size_by_off, bearing_by_off] = self.shape.off_slopes(sight, for_size, for_bearing);
        // No eye, however it is turned, read a bearing that was put in.
        let (read, bearing_by_off) =
            if view.aims { (dot(&self.bearing_columns, for_bearing), bearing_by_off) } else { (0.0, 0.0) };
        let expected = [dot(&self.size_columns, for_size), sight.bearing_rad + read];
        let d = sight.distance_m.max(0.05);
        let [ux, uy] = self.towards(view, sight.landmark, belief).map(|it| it / d);
        let [far, off] = by_pose([ux, uy], d, view.out(belief.mean.z).1);
        (expected, SMatrix::from_rows(&[slope * far + size_by_off * off, (1.0 + bearing_by_off) * off]))
    }
}
