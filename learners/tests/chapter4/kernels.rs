//! The kernels of the plane against finite differences and numerical integration.

use asami_learners::em::curve::SizeCurve;
use asami_learners::em::field::Field;
use asami_learners::em::world::{Pair, World};
use asami_learners::plane::Seen;
use asami_math::angle::wrap_rad;
use asami_math::kalman::Gaussian;
use asami_math::polynomial::Polynomial;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use proptest::prelude::*;

const FIELD: Field = Field { sensor_origin_m: [0.03, 0.2] };

fn pose() -> impl Strategy<Value = Vector3<f64>> {
    (-1.5..1.5f64, -1.5..1.5f64, -3.1..3.1f64).prop_map(|(x, y, t)| Vector3::new(x, y, t))
}

fn step() -> impl Strategy<Value = Vector3<f64>> {
    (-0.3..0.3f64, -0.3..0.3f64, -0.5..0.5f64).prop_map(|(x, y, t)| Vector3::new(x, y, t))
}

fn f() -> SizeCurve {
    let p = Polynomial { coefficients: vec![14.0, -8.0, 4.0, -2.0], centre: 2.7, scale: 1.45 };
    SizeCurve::new(&p, 4, 3.0, 2.0)
}

fn seen() -> Seen {
    Seen { landmark: 0, landmark_m: [2.5, 3.0], size: 20.0, bearing_rad: 0.4 }
}

/// Central differences of a function of a pose.
fn slope<const M: usize>(at: &Vector3<f64>, f: impl Fn(&Vector3<f64>) -> SVector<f64, M>) -> SMatrix<f64, M, 3> {
    const H: f64 = 1e-6;
    let mut slope = SMatrix::<f64, M, 3>::zeros();
    for i in 0..3 {
        let mut h = Vector3::zeros();
        h[i] = H;
        slope.set_column(i, &((f(&(at + h)) - f(&(at - h))) / (2.0 * H)));
    }
    slope
}

/// Nodes and weights of Gauss and Hermite's rule for a standard normal, five points.
const RULE: [(f64, f64); 5] = [
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_266, 0.222_075_922_005_612_6),
    (-1.355_626_179_974_266, 0.222_075_922_005_612_6),
    (2.856_970_013_872_805_6, 0.011_257_411_327_720_691),
    (-2.856_970_013_872_805_6, 0.011_257_411_327_720_691),
];

/// Mean of a function of three Gaussian numbers.
fn mean<const M: usize>(
    mean: &Vector3<f64>,
    covariance: &Matrix3<f64>,
    f: impl Fn(&Vector3<f64>) -> SVector<f64, M>,
) -> SVector<f64, M> {
    let l = covariance.cholesky().expect("positive").l();
    let mut sum = SVector::zeros();
    for (a, u) in RULE {
        for (b, v) in RULE {
            for (c, w) in RULE {
                sum += f(&(mean + l * Vector3::new(a, b, c))) * (u * v * w);
            }
        }
    }
    sum
}

fn covariance(size: f64) -> impl Strategy<Value = Matrix3<f64>> {
    proptest::collection::vec(-1.0..1.0f64, 9).prop_map(move |m| {
        let m = Matrix3::from_row_slice(&m) * size;
        m * m.transpose() + Matrix3::identity() * (0.01 * size * size)
    })
}

proptest! {
    #[test]
    fn derivatives_are_limits_of_differences(w in pose(), mu in step(), next in pose()) {
        let (field, q) = (FIELD, Vector3::new(1e-4, 4e-4, 1e-2));
        let forth = field.forth(&w, &mu, &q);
        let back = field.back(&forth.to, &mu, &q);
        prop_assert!(field.difference(&back.to, &w).norm() < 1e-12);
        prop_assert!((forth.f * back.f - Matrix3::identity()).norm() < 1e-12);
        // Noise that is carried back is noise that was carried forth.
        prop_assert!((forth.f * back.q * forth.f.transpose() - forth.q).norm() < 1e-12);
        let (d, by_w, by_next) = field.displacement(&w, &forth.to);
        prop_assert!((d - mu).norm() < 1e-12);
        let away = |x: &Vector3<f64>| field.difference(x, &forth.to);
        prop_assert!((slope(&w, |w| away(&field.forth(w, &mu, &q).to)) - forth.f).norm() < 1e-8);
        prop_assert!((slope(&w, |w| field.displacement(w, &forth.to).0) - by_w).norm() < 1e-8);
        prop_assert!((slope(&forth.to, |next| field.displacement(&w, next).0) - by_next).norm() < 1e-8);
        prop_assert!((field.axes(&w) * mu - field.difference(&field.forth(&w, &mu, &q).to, &w)).norm() < 1e-12);
        let (_, h) = field.innovation(&next, &seen(), &f());
        let found = slope(&next, |w| field.innovation(w, &seen(), &f()).0);
        prop_assert!((found + h).norm() < 1e-6 * (1.0 + h.norm()), "{found} {h}");
    }

    #[test]
    fn moments_of_a_displacement_are_exact(w in pose(), mu in step(), p in covariance(0.2), c in -0.9..0.9f64) {
        // The next state moves with this one, in part, and has noise of its own.
        let next = FIELD.forth(&w, &mu, &Vector3::zeros()).to;
        let part = Matrix3::identity() * c;
        let own = Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03));
        let pair = Pair {
            now: Gaussian { mean: w, covariance: p },
            next: Gaussian { mean: next, covariance: part * p * part.transpose() + own },
            cross: part * p,
        };
        let (d, d2) = FIELD.displacement_moments(&pair);
        // Given theta, the step (x, y) is Gaussian: integrate over theta, dx, dy.
        let s = pair.next.covariance + p - pair.cross - pair.cross.transpose();
        let with_theta = pair.cross - p;
        let joint = Matrix3::new(
            p[(2, 2)], with_theta[(0, 2)], with_theta[(1, 2)],
            with_theta[(0, 2)], s[(0, 0)], s[(0, 1)],
            with_theta[(1, 2)], s[(1, 0)], s[(1, 1)],
        );
        let centre = Vector3::new(w[2], next[0] - w[0], next[1] - w[1]);
        let found = mean(&centre, &joint, |v| {
            let (sin, cos) = v[0].sin_cos();
            let (x, y) = (cos * v[1] + sin * v[2], cos * v[2] - sin * v[1]);
            SVector::<f64, 4>::new(x, y, x * x, y * y)
        });
        let turn = wrap_rad(next[2] - w[2]);
        prop_assert!((found - SVector::<f64, 4>::new(d[0], d[1], d2[0], d2[1])).norm() < 2e-5, "{found} {d} {d2}");
        prop_assert!((d[2] - turn).abs() < 1e-12 && (d2[2] - turn * turn - s[(2, 2)]).abs() < 1e-12);
    }

    #[test]
    fn looks_are_right_to_second_order(w in pose(), p in covariance(0.05)) {
        let state = Gaussian { mean: w, covariance: p };
        let look = FIELD.look_moments(&state, &seen());
        let first = FIELD.look(&w, &seen());
        let found = mean(&w, &p, |w| {
            let look = FIELD.look(w, &seen());
            let off = wrap_rad(look.bearing_error_rad - first.bearing_error_rad);
            let d = look.distance_m;
            SVector::<f64, 4>::new(d, d * d, off, off * off)
        });
        let var = found[1] - found[0] * found[0];
        // Fourth order: variances of up to 0.01 make steps of up to 1e-4.
        prop_assert!((look.distance_m - found[0]).abs() < 3e-5, "{look:?} {found}");
        prop_assert!((look.distance_var - var).abs() < 0.02 * var + 3e-5);
        let off = wrap_rad(look.bearing_error_rad - first.bearing_error_rad);
        prop_assert!((off - found[2]).abs() < 1e-4, "{look:?} {found}");
        let var = found[3] - found[2] * found[2];
        prop_assert!((look.bearing_var - var).abs() < 0.02 * var + 1e-4);
        let (e, _) = FIELD.innovation_from(&state, &seen(), &f());
        let found = mean(&w, &p, |w| SVector::<f64, 1>::new(f().at(FIELD.look(w, &seen()).distance_m).0));
        prop_assert!((seen().size - e[0] - found[0]).abs() < 1e-3);
    }

    #[test]
    fn linear_motion_on_average(w in pose(), mu in step(), p in covariance(0.2)) {
        // The best linear function has the mean of the motion, and its covariance with the start.
        let q = Vector3::zeros();
        let moved = FIELD.forth_from(&Gaussian { mean: w, covariance: p }, &mu, &q);
        let to = |v: &Vector3<f64>| {
            let (s, c) = v[2].sin_cos();
            Vector3::new(v[0] + c * mu[0] - s * mu[1], v[1] + s * mu[0] + c * mu[1], v[2] + mu[2])
        };
        let centre = mean(&w, &p, to);
        prop_assert!(FIELD.difference(&moved.to, &centre).norm() < 1e-6);
        for i in 0..3 {
            let cross = mean(&w, &p, |v| (to(v) - centre) * (v[i] - w[i]));
            prop_assert!((moved.f * p.column(i) - cross).norm() < 1e-6);
        }
    }

    #[test]
    fn no_heading_is_less_known_than_any(w in pose(), p in covariance(3.0)) {
        let mut state = Gaussian { mean: w, covariance: p };
        FIELD.bound(&mut state);
        let any = std::f64::consts::PI.powi(2) / 3.0;
        let bounded = state.covariance;
        prop_assert!((bounded[(2, 2)] - p[(2, 2)].min(any)).abs() < 1e-12);
        // Places stay as uncertain, and as correlated with the heading.
        prop_assert!(bounded[(0, 0)] == p[(0, 0)] && bounded[(1, 1)] == p[(1, 1)]);
        let correlation = |m: &Matrix3<f64>| m[(0, 2)] / (m[(0, 0)] * m[(2, 2)]).sqrt();
        prop_assert!((correlation(&bounded) - correlation(&p)).abs() < 1e-12);
        prop_assert!((bounded - bounded.transpose()).norm() == 0.0);
    }

    #[test]
    fn inverses_are(p in covariance(1.0)) {
        prop_assert!((FIELD.inverse(&p) * p - Matrix3::identity()).norm() < 1e-6);
    }
}
