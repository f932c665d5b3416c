//! A line: the place along it, and sizes alone (section 4.4.3 of Stronger 2008, "in one dimension").

use asami_math::kalman::Gaussian;
use nalgebra::{Matrix1, Vector1};

use super::curve::SizeCurve;
use super::world::{Look, LookMoments, Moved, Pair, World};
use crate::plane::Seen;

/// The line on which the robot faces its one landmark, which stands at 0; the robot's place is minus its
/// distance.
#[derive(Clone, Copy, Debug)]
pub struct Track;

impl World<1, 1> for Track {
    fn difference(&self, a: &Vector1<f64>, b: &Vector1<f64>) -> Vector1<f64> {
        a - b
    }

    fn forth(&self, w: &Vector1<f64>, mu: &Vector1<f64>, q: &Vector1<f64>) -> Moved<1> {
        Moved { to: w + mu, f: Matrix1::new(1.0), q: *q }
    }

    fn forth_from(&self, from: &Gaussian<1>, mu: &Vector1<f64>, q: &Vector1<f64>) -> Moved<1> {
        self.forth(&from.mean, mu, q)
    }

    fn back(&self, w: &Vector1<f64>, mu: &Vector1<f64>, q: &Vector1<f64>) -> Moved<1> {
        Moved { to: w - mu, f: Matrix1::new(1.0), q: *q }
    }

    fn displacement(&self, w: &Vector1<f64>, next: &Vector1<f64>) -> (Vector1<f64>, Matrix1<f64>, Matrix1<f64>) {
        (next - w, Matrix1::new(-1.0), Matrix1::new(1.0))
    }

    fn axes(&self, _w: &Vector1<f64>) -> Matrix1<f64> {
        Matrix1::new(1.0)
    }

    fn displacement_moments(&self, pair: &Pair<1>) -> (Vector1<f64>, Vector1<f64>) {
        let d = pair.next.mean - pair.now.mean;
        (d, d * d[0] + pair.next.covariance + pair.now.covariance - 2.0 * pair.cross)
    }

    fn innovation(&self, w: &Vector1<f64>, seen: &Seen, f: &SizeCurve) -> (Vector1<f64>, Matrix1<f64>) {
        let (size, slope) = f.at(-w[0]);
        (Vector1::new(seen.size - size), Matrix1::new(-slope))
    }

    fn innovation_from(&self, state: &Gaussian<1>, seen: &Seen, f: &SizeCurve) -> (Vector1<f64>, Matrix1<f64>) {
        let (e, h) = self.innovation(&state.mean, seen, f);
        (e - 0.5 * f.curvature_at(-state.mean[0]) * state.covariance, h)
    }

    fn look(&self, w: &Vector1<f64>, _seen: &Seen) -> Look {
        Look { distance_m: -w[0], bearing_error_rad: 0.0 }
    }

    fn look_moments(&self, state: &Gaussian<1>, _seen: &Seen) -> LookMoments {
        LookMoments {
            distance_m: -state.mean[0],
            distance_var: state.covariance[0],
            bearing_error_rad: 0.0,
            bearing_var: 0.0,
        }
    }

    fn bound(&self, _state: &mut Gaussian<1>) {}

    fn inverse(&self, a: &Matrix1<f64>) -> Matrix1<f64> {
        Matrix1::new(1.0 / a[0])
    }
}
