//! The plane: poses `(x, y, theta)`, observations of size and bearing (section 2.5.1 of Stronger 2008).

use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, exp, sin_cos};
use asami_math::kalman::Gaussian;
use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

use super::curve::SizeCurve;
use super::world::{Look, LookMoments, Moved, Pair, Square, World};
use crate::plane::{Plane, Seen};
use crate::view::View;

/// The plane, for a sensor somewhere on the robot.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Where the sensor sits in the robot frame: right, forward.
    pub sensor_origin_m: [f64; 2],
}

/// `R(theta) v` in the plane.
fn turned(s: f64, c: f64, x: f64, y: f64) -> (f64, f64) {
    (c * x - s * y, s * x + c * y)
}

/// The noise along the robot's axes, seen from the world.
fn spread(s: f64, c: f64, q: &Vector3<f64>) -> Matrix3<f64> {
    let (xx, xy, yy) = (c * c * q[0] + s * s * q[1], c * s * (q[0] - q[1]), s * s * q[0] + c * c * q[1]);
    Matrix3::new(xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, q[2])
}

impl Field {
    /// That of a log.
    #[must_use]
    pub fn of(plane: &Plane) -> Self {
        Self { sensor_origin_m: plane.sensor_origin_m }
    }

    fn view(&self, w: &Vector3<f64>, seen: &Seen) -> View {
        View::of(&[w[0], w[1], w[2]], seen.landmark_m, self.sensor_origin_m)
    }
}

impl World<3, 2> for Field {
    fn difference(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(a[0] - b[0], a[1] - b[1], wrap_rad(a[2] - b[2]))
    }

    fn forth(&self, w: &Vector3<f64>, mu: &Vector3<f64>, q: &Vector3<f64>) -> Moved<3> {
        // w' = w + R(theta) mu (Stronger 2008, eq. 2.28).
        let (s, c) = sin_cos(w[2]);
        let (x, y) = turned(s, c, mu[0], mu[1]);
        let f = Matrix3::new(1.0, 0.0, -y, 0.0, 1.0, x, 0.0, 0.0, 1.0);
        Moved { to: Vector3::new(w[0] + x, w[1] + y, wrap_rad(w[2] + mu[2])), f, q: spread(s, c, q) }
    }

    fn forth_from(&self, from: &Gaussian<3>, mu: &Vector3<f64>, q: &Vector3<f64>) -> Moved<3> {
        // E R(theta) = exp(-var/2) R(E theta), and E R'(theta) likewise.
        let shrink = exp(-0.5 * from.covariance[(2, 2)]);
        self.forth(&from.mean, &Vector3::new(shrink * mu[0], shrink * mu[1], mu[2]), q)
    }

    fn back(&self, w: &Vector3<f64>, mu: &Vector3<f64>, q: &Vector3<f64>) -> Moved<3> {
        // w = w' - R(theta' - mu_theta) mu: the noise of the turn moves the origin too, F Q F^T.
        let theta = wrap_rad(w[2] - mu[2]);
        let (s, c) = sin_cos(theta);
        let (x, y) = turned(s, c, mu[0], mu[1]);
        let f = Matrix3::new(1.0, 0.0, y, 0.0, 1.0, -x, 0.0, 0.0, 1.0);
        let mut noise = spread(s, c, q);
        noise += Matrix3::new(y * y, -x * y, y, -x * y, x * x, -x, y, -x, 0.0) * q[2];
        Moved { to: Vector3::new(w[0] - x, w[1] - y, theta), f, q: noise }
    }

    fn displacement(&self, w: &Vector3<f64>, next: &Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>, Matrix3<f64>) {
        // D(w, w') = R(-theta) (w' - w) (section 4.2).
        let (s, c) = sin_cos(w[2]);
        let (x, y) = turned(-s, c, next[0] - w[0], next[1] - w[1]);
        let d = Vector3::new(x, y, wrap_rad(next[2] - w[2]));
        let by_next = Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0);
        let by_w = Matrix3::new(-c, -s, y, s, -c, -x, 0.0, 0.0, -1.0);
        (d, by_w, by_next)
    }

    fn axes(&self, w: &Vector3<f64>) -> Matrix3<f64> {
        let (s, c) = sin_cos(w[2]);
        Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
    }

    fn displacement_moments(&self, pair: &Pair<3>) -> (Vector3<f64>, Vector3<f64>) {
        // With z = exp(-i theta) delta, delta the step in the world as a complex number, Gaussian together with
        // theta, c = cov(theta, delta): E z = exp(-i theta - var/2) (delta - i c), and
        // E z^2 = exp(-2 i theta - 2 var) ((delta - 2 i c)^2 + E (delta - E delta)^2).
        let (now, next, cross) = (&pair.now, &pair.next, &pair.cross);
        let (x, y) = (next.mean[0] - now.mean[0], next.mean[1] - now.mean[1]);
        let var = now.covariance[(2, 2)];
        let (c_x, c_y) = (cross[(0, 2)] - now.covariance[(0, 2)], cross[(1, 2)] - now.covariance[(1, 2)]);
        let delta =
            |i: usize, j: usize| next.covariance[(i, j)] + now.covariance[(i, j)] - cross[(i, j)] - cross[(j, i)];
        let (xx, xy, yy, tt) = (delta(0, 0), delta(0, 1), delta(1, 1), delta(2, 2));
        let (s, c) = sin_cos(now.mean[2]);
        let shrink = exp(-0.5 * var);
        let (d_x, d_y) = turned(-s, c, x + c_y, y - c_x);
        // (delta - 2 i c)^2 + pseudo-variance, turned by -2 theta.
        let (u, v) = (x + 2.0 * c_y, y - 2.0 * c_x);
        let (re, im) = (u * u - v * v + xx - yy, 2.0 * (u * v + xy));
        let (s2, c2) = (2.0 * s * c, c * c - s * s);
        let shrink4 = shrink * shrink * shrink * shrink;
        let square_re = shrink4 * (c2 * re + s2 * im);
        let length = x * x + y * y + xx + yy;
        let turn = wrap_rad(next.mean[2] - now.mean[2]);
        let mean = Vector3::new(shrink * d_x, shrink * d_y, turn);
        let squares = Vector3::new(0.5 * (length + square_re), 0.5 * (length - square_re), turn * turn + tt);
        (mean, squares)
    }

    fn innovation(&self, w: &Vector3<f64>, seen: &Seen, f: &SizeCurve) -> (Vector2<f64>, Matrix2x3<f64>) {
        let view = self.view(w, seen);
        let (size, slope) = f.at(view.distance_m);
        let e = Vector2::new(seen.size - size, wrap_rad(seen.bearing_rad - view.bearing_rad));
        let ([a, b, t], [d, g, h]) = (view.distance_by, view.bearing_by);
        (e, Matrix2x3::new(slope * a, slope * b, slope * t, d, g, h))
    }

    fn innovation_from(&self, state: &Gaussian<3>, seen: &Seen, f: &SizeCurve) -> (Vector2<f64>, Matrix2x3<f64>) {
        let (_, h) = self.innovation(&state.mean, seen, f);
        let look = self.look_moments(state, seen);
        let (size, _) = f.at(look.distance_m);
        let bent = 0.5 * f.curvature_at(look.distance_m) * look.distance_var;
        (Vector2::new(seen.size - size - bent, -look.bearing_error_rad), h)
    }

    fn look(&self, w: &Vector3<f64>, seen: &Seen) -> Look {
        let view = self.view(w, seen);
        Look { distance_m: view.distance_m, bearing_error_rad: wrap_rad(view.bearing_rad - seen.bearing_rad) }
    }

    fn look_moments(&self, state: &Gaussian<3>, seen: &Seen) -> LookMoments {
        let p = &state.covariance;
        let (s, c) = sin_cos(state.mean[2]);
        let (u_x, u_y) = turned(-s, c, seen.landmark_m[0] - state.mean[0], seen.landmark_m[1] - state.mean[1]);
        // The sensor's place is bent inwards by the uncertain heading: its origin shrinks by 1 - var/2.
        let bent = 1.0 - 0.5 * p[(2, 2)];
        let [o_x, o_y] = self.sensor_origin_m;
        let (x, y) = (u_x - bent * o_x, u_y - bent * o_y);
        let distance = (x * x + y * y).sqrt();
        // Unit vectors in the robot frame towards the landmark and, counter-clockwise, across; the sensor
        // moves by R(theta) (-o_y, o_x) for each radian.
        let (t_x, t_y) = (x / distance, y / distance);
        let (n_x, n_y) = (-t_y, t_x);
        let world = |x: f64, y: f64| turned(s, c, x, y);
        let ((tx, ty), (nx, ny)) = (world(t_x, t_y), world(n_x, n_y));
        let (t_o, n_o) = (t_y * o_x - t_x * o_y, n_y * o_x - n_x * o_y);
        let towards = Vector3::new(tx, ty, t_o);
        let across = Vector3::new(nx, ny, n_o);
        let (p_t, p_n) = (p * towards, p * across);
        let (var_t, var_n, cov_tn) = (towards.dot(&p_t), across.dot(&p_n), towards.dot(&p_n));
        // ang = (direction of landmark in the world) - theta; moving across by n turns the direction by -n/d.
        let bearing = Vector3::new(-nx / distance, -ny / distance, -n_o / distance - 1.0);
        let bearing_var = bearing.dot(&(p * bearing));
        LookMoments {
            distance_m: distance + 0.5 * var_n / distance,
            distance_var: var_t,
            bearing_error_rad: wrap_rad(atan2(-x, y) - seen.bearing_rad - cov_tn / (distance * distance)),
            bearing_var,
        }
    }

    fn bound(&self, state: &mut Gaussian<3>) {
        // The variance of an angle that may be any.
        const ANY: f64 = std::f64::consts::PI * std::f64::consts::PI / 3.0;
        let var = state.covariance[(2, 2)];
        if var > ANY {
            let shrink = (ANY / var).sqrt();
            for i in 0..3 {
                state.covariance[(i, 2)] *= shrink;
                state.covariance[(2, i)] *= shrink;
            }
        }
    }

    fn inverse(&self, a: &Square<3>) -> Square<3> {
        symmetric_inverse(a)
    }
}

/// Inverse of a symmetric matrix by its adjugate.
fn symmetric_inverse(a: &Matrix3<f64>) -> Matrix3<f64> {
    let (xx, xy, xt, yy, yt, tt) = (a[(0, 0)], a[(1, 0)], a[(2, 0)], a[(1, 1)], a[(2, 1)], a[(2, 2)]);
    let (c_xx, c_xy, c_xt) = (yy * tt - yt * yt, xt * yt - xy * tt, xy * yt - xt * yy);
    let inverse = 1.0 / (xx * c_xx + xy * c_xy + xt * c_xt);
    let (c_yy, c_yt, c_tt) = (xx * tt - xt * xt, xy * xt - xx * yt, xx * yy - xy * xy);
    Matrix3::new(c_xx, c_xy, c_xt, c_xy, c_yy, c_yt, c_xt, c_yt, c_tt) * inverse
}
