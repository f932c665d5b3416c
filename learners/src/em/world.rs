//! What the EM learners must know of a world: its motion, its displacements, its observations.

use asami_math::kalman::Gaussian;
use nalgebra::{SMatrix, SVector};

use super::curve::SizeCurve;
use crate::plane::{Plane, Seen};

/// A square matrix of the state's size.
pub type Square<const N: usize> = SMatrix<f64, N, N>;

/// A kind of world: states of `N` numbers, observations of `M`.
///
/// The motion is eq. 2.28 of Stronger 2008, `w' ~ w + R(theta) (mu + noise)` with `mu = A(c) dt`, the noise
/// independent and of variances `q` along the robot's own axes; the observation is eq. 2.29.
pub trait World<const N: usize, const M: usize>: Sync {
    /// `a - b`, angles normalised (footnote 3 of chapter 4).
    fn difference(&self, a: &SVector<f64, N>, b: &SVector<f64, N>) -> SVector<f64, N>;

    /// Where `mu` leads from `w`, how the result depends on `w`, and the covariance of the noise in the world.
    fn forth(&self, w: &SVector<f64, N>, mu: &SVector<f64, N>, q: &SVector<f64, N>) -> Moved<N>;

    /// The same on average over where the motion starts: the linear function that fits it best there.
    fn forth_from(&self, from: &Gaussian<N>, mu: &SVector<f64, N>, q: &SVector<f64, N>) -> Moved<N>;

    /// The inverse of [`forth`](World::forth): whence `mu` led to `w`.
    fn back(&self, w: &SVector<f64, N>, mu: &SVector<f64, N>, q: &SVector<f64, N>) -> Moved<N>;

    /// `D(w, w') = R(-theta) (w' - w)` and its derivatives by `w` and by `w'`.
    fn displacement(&self, w: &SVector<f64, N>, next: &SVector<f64, N>) -> (SVector<f64, N>, Square<N>, Square<N>);

    /// `R(theta)`: the robot's axes in the world.
    fn axes(&self, w: &SVector<f64, N>) -> Square<N>;

    /// Means of `D` and of the squares of its parts, of a Gaussian pair of states, exactly.
    fn displacement_moments(&self, pair: &Pair<N>) -> (SVector<f64, N>, SVector<f64, N>);

    /// `o - h(w)`, angles normalised, and the derivative of `h` by `w`.
    fn innovation(&self, w: &SVector<f64, N>, seen: &Seen, f: &SizeCurve) -> (SVector<f64, M>, SMatrix<f64, M, N>);

    /// The same on average over a Gaussian state, to second order.
    fn innovation_from(&self, state: &Gaussian<N>, seen: &Seen, f: &SizeCurve)
    -> (SVector<f64, M>, SMatrix<f64, M, N>);

    /// `dist(w)` and, if bearings are observed, `ang(w)` less the one observed, normalised.
    fn look(&self, w: &SVector<f64, N>, seen: &Seen) -> Look;

    /// The same of a Gaussian state, to second order.
    fn look_moments(&self, state: &Gaussian<N>, seen: &Seen) -> LookMoments;

    /// Keeps a state no more uncertain than not knowing it at all: an angle on the circle.
    fn bound(&self, state: &mut Gaussian<N>);

    /// Inverse of a symmetric positive definite matrix; not finite where it has none.
    fn inverse(&self, a: &Square<N>) -> Square<N>;
}

/// What the states are to be found for: a kind of world, and a log of it.
#[derive(Debug)]
pub struct Problem<'a, W> {
    /// The kind of world.
    pub world: &'a W,
    /// The log.
    pub plane: &'a Plane,
}

impl<W> Clone for Problem<'_, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<W> Copy for Problem<'_, W> {}

/// A step of motion, linearised.
#[derive(Clone, Copy, Debug)]
pub struct Moved<const N: usize> {
    /// Where it leads.
    pub to: SVector<f64, N>,
    /// Derivative by where it starts.
    pub f: Square<N>,
    /// Covariance of the noise.
    pub q: Square<N>,
}

/// Two consecutive states given all data.
#[derive(Clone, Copy, Debug)]
pub struct Pair<const N: usize> {
    /// The earlier.
    pub now: Gaussian<N>,
    /// The later.
    pub next: Gaussian<N>,
    /// Covariance of the later with the earlier.
    pub cross: Square<N>,
}

/// A landmark seen from a pose.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// `dist(w)`, metres.
    pub distance_m: f64,
    /// `ang(w) - o_2`, in `[-pi, pi)`; 0 where bearings are not observed.
    pub bearing_error_rad: f64,
}

/// A landmark seen from an uncertain pose.
#[derive(Clone, Copy, Debug)]
pub struct LookMoments {
    /// Mean of `dist(w)`.
    pub distance_m: f64,
    /// Its variance.
    pub distance_var: f64,
    /// Mean of `ang(w) - o_2`.
    pub bearing_error_rad: f64,
    /// Its variance.
    pub bearing_var: f64,
}
