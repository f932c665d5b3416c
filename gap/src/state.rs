//! What the filter believes: the pose, and the sways of the sensor.

use std::ops::Range;

use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector3};

use crate::memory::Sway;

/// A pose with its covariance: world x, world y, heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// Mean.
    pub mean: Vector3<f64>,
    /// Covariance.
    pub covariance: Matrix3<f64>,
}

/// A pose, and after it, where anything sways, the sways of sizes and of bearings at this frame and the one before; or, where
/// landmarks' errors last, those of the few that were seen last. Each is of variance 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<const N: usize> {
    pub(crate) mean: SVector<f64, N>,
    pub(crate) covariance: SMatrix<f64, N, N>,
}

/// A twist by less is along a line.
const STRAIGHT_RAD: f64 = 1e-6;
/// Where a state holds the sways of sizes and of bearings.
pub(crate) const SWAYS: [usize; 2] = [3, 5];
/// Where it holds landmarks' errors.
pub(crate) const ERRORS: Range<usize> = 3..LASTING;
/// Numbers of a state with sways, of one with errors, and of one without either.
pub(crate) const SWAYING: usize = 7;
pub(crate) const LASTING: usize = 8;
pub(crate) const STEADY: usize = 3;

impl<const N: usize> State<N> {
    /// Where it holds sways, if it does.
    pub(crate) fn sways() -> impl Iterator<Item = usize> {
        SWAYS.into_iter().filter(|_| N == SWAYING)
    }

    /// Where it holds landmarks' errors, if it does.
    pub(crate) fn errors() -> Range<usize> {
        if N == LASTING { ERRORS } else { 0..0 }
    }

    pub(crate) fn new(belief: &Belief) -> Self {
        let mut mean = SVector::<f64, N>::zeros();
        let mut covariance = SMatrix::<f64, N, N>::zeros();
        mean.fixed_rows_mut::<3>(0).copy_from(&belief.mean);
        covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&belief.covariance);
        let mut state = Self { mean, covariance };
        state.forget_sways(&[Sway::default(); 2]);
        Self::errors().for_each(|at| state.forget_error(at));
        state
    }

    pub(crate) fn belief(&self) -> Belief {
        Belief {
            mean: self.mean.fixed_rows::<3>(0).into_owned(),
            covariance: self.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
        }
    }

    /// Of the sways nothing is known but how they are distributed.
    pub(crate) fn forget_sways(&mut self, sways: &[Sway; 2]) {
        for (at, sway) in Self::sways().zip(sways) {
            [at, at + 1].into_iter().for_each(|i| self.clear(i));
            let [var, next] = sway.correlations::<2>();
            self.covariance.fixed_view_mut::<2, 2>(at, at).copy_from(&Matrix2::new(var, next, next, var));
        }
    }

    /// The mean farther by a step.
    pub(crate) fn add(&mut self, step: &SVector<f64, N>) {
        self.mean += step;
        self.mean[2] = wrap_rad(self.mean[2]);
    }

    /// The same, where the step of the pose is a twist of the plane about where it is, and the covariance is one of twists: of such
    /// about where it is then.
    pub(crate) fn twist(&mut self, step: &SVector<f64, N>) {
        let turned = step[2];
        let (sin, cos) = sin_cos(turned);
        let (along, across) =
            if turned.abs() < STRAIGHT_RAD { (1.0, 0.5 * turned) } else { (sin / turned, (1.0 - cos) / turned) };
        let [x, y] = [along * step[0] - across * step[1], across * step[0] + along * step[1]];
        let mut farther = *step;
        (farther[0], farther[1]) = (x, y);
        self.add(&farther);
        self.carry([-y, x]);
    }

    /// Carries the covariance on by a displacement whose derivatives with respect to the heading are these, of x and of y.
    pub(crate) fn carry(&mut self, by_heading: [f64; 2]) {
        let p = &mut self.covariance;
        for i in 0..N {
            (0..2).for_each(|axis| p[(axis, i)] += by_heading[axis] * p[(2, i)]);
        }
        for i in 0..N {
            (0..2).for_each(|axis| p[(i, axis)] += p[(i, 2)] * by_heading[axis]);
        }
    }

    /// The sway at `at` a frame later, but for what is new in it: so much of what it was, and so much of what it was before.
    pub(crate) fn sway_on(&mut self, at: usize, on: [f64; 2]) {
        let next = |now: f64, before: f64| (on[0] * now + on[1] * before, now);
        let p = &mut self.covariance;
        (self.mean[at], self.mean[at + 1]) = next(self.mean[at], self.mean[at + 1]);
        for i in 0..N {
            (p[(at, i)], p[(at + 1, i)]) = next(p[(at, i)], p[(at + 1, i)]);
        }
        for i in 0..N {
            (p[(i, at)], p[(i, at + 1)]) = next(p[(i, at)], p[(i, at + 1)]);
        }
    }

    /// So much is kept of the error at `at`.
    pub(crate) fn fade(&mut self, at: usize, kept: f64) {
        self.mean[at] *= kept;
        self.covariance.row_mut(at).scale_mut(kept);
        self.covariance.column_mut(at).scale_mut(kept);
    }

    /// Of the error at `at` nothing is known any more.
    pub(crate) fn forget_error(&mut self, at: usize) {
        self.clear(at);
        self.covariance[(at, at)] = 1.0;
    }

    fn clear(&mut self, i: usize) {
        self.mean[i] = 0.0;
        self.covariance.row_mut(i).fill(0.0);
        self.covariance.column_mut(i).fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// A state whose numbers all hang together.
    fn some<const N: usize>() -> State<N> {
        let root = SMatrix::<f64, N, N>::from_fn(|i, j| ((3 * i + 5 * j * j) as f64).sin());
        State { mean: SVector::from_fn(|i, _| i as f64), covariance: root * root.transpose() }
    }

    fn assert_carried<const N: usize>(before: &State<N>, by: &SMatrix<f64, N, N>, after: &State<N>) {
        let expected = by * before.covariance * by.transpose();
        assert!((after.covariance - expected).norm() < 1e-12, "{} {expected}", after.covariance);
    }

    #[test]
    fn what_is_carried_on_is_what_the_whole_derivative_makes_of_it() {
        let (before, [x, y]) = (some::<SWAYING>(), [0.3, -0.7]);
        let mut by = SMatrix::<f64, SWAYING, SWAYING>::identity();
        (by[(0, 2)], by[(1, 2)]) = (x, y);
        let mut after = before;
        after.carry([x, y]);
        for (at, on) in SWAYS.into_iter().zip([[1.2, -0.5], [0.4, 0.1]]) {
            by.fixed_view_mut::<2, 2>(at, at).copy_from(&Matrix2::new(on[0], on[1], 1.0, 0.0));
            after.sway_on(at, on);
            let [now, earlier] = [before.mean[at], before.mean[at + 1]];
            assert_eq!([after.mean[at], after.mean[at + 1]], [on[0] * now + on[1] * earlier, now]);
        }
        assert_carried(&before, &by, &after);
    }

    /// Half a turn along half a circle ends a diameter aside; what was unsure of the heading is then of the place as well.
    #[test]
    fn a_twist_goes_around() {
        let before = some::<STEADY>();
        let before = State { mean: SVector::from([1.0, 2.0, 0.5]), ..before };
        let (mut after, mut by) = (before, SMatrix::<f64, STEADY, STEADY>::identity());
        after.twist(&SVector::from([PI, 0.0, PI]));
        (by[(0, 2)], by[(1, 2)]) = (-2.0, 0.0);
        assert!((after.mean - SVector::from([1.0, 4.0, 0.5 - PI])).norm() < 1e-12, "{}", after.mean);
        assert_carried(&before, &by, &after);
        // Without a turn it is a step.
        let step = SVector::from([0.3, -0.2, 0.0]);
        let [mut twisted, mut added] = [before; 2];
        twisted.twist(&step);
        added.add(&step);
        assert!((twisted.mean - added.mean).norm() < 1e-12);
        // As it is with next to none.
        let mut turned = before;
        turned.twist(&SVector::from([0.3, -0.2, 2.0 * STRAIGHT_RAD]));
        assert!((turned.mean - added.mean).norm() < 1e-5 && (turned.covariance - twisted.covariance).norm() < 1e-5);
    }

    #[test]
    fn errors_fade_with_all_that_hangs_on_them() {
        let before = some::<LASTING>();
        let (mut after, mut by) = (before, SMatrix::<f64, LASTING, LASTING>::identity());
        for at in ERRORS {
            by[(at, at)] = 0.8;
            after.fade(at, 0.8);
            assert_eq!(after.mean[at], 0.8 * before.mean[at]);
        }
        assert_carried(&before, &by, &after);
    }
}
