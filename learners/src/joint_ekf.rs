//! A rival of the related work: one extended Kalman filter over pose, velocities and sensor together.

use asami_math::angle::wrap_rad;
use nalgebra::Vector3;

use crate::augmented::{Augmented, augmented};

augmented! {
    /// The state is augmented with all that is unknown of the models, which do not move: each sighting corrects
    /// pose and models at once through their joint covariance (Jazwinski 1970, section 8.4).
    ///
    /// The noise stays as given. Standard errors are the filter's own.
    JointEkf, "joint_ekf",
    "Filters pose, velocities and sensor as one state; the noise stays as given.",
    source "Jazwinski 1970, section 8.4"
}

/// One pass over the log.
fn pass(filter: &mut Augmented) -> Option<()> {
    let n = 3 + filter.parameter_var.len();
    let prior = filter.prior();
    // Rows of the covariance of pose and parameters together.
    let mut p = vec![0.0; n * n];
    for i in 0..n {
        p[i * n + i] = if i < 3 { prior.covariance[(i, i)] } else { filter.parameter_var[i - 3] };
    }
    let (mut w, mut column, mut gain) = (prior.mean, vec![0.0; n], vec![0.0; n]);
    for t in 0..filter.plane.frames.len() {
        if t > 0 {
            predict(filter, t - 1, &mut w, &mut p, n);
        }
        for seen in filter.plane.seen(t) {
            // One component after the other: their noise is independent. The second is linearised anew.
            for kind in 0..2 {
                let row = filter.row(&w, seen, kind);
                column.fill(0.0);
                for (j, h) in row.by() {
                    for (c, p) in column.iter_mut().zip(&p[j * n..(j + 1) * n]) {
                        *c += h * p;
                    }
                }
                let variance = row.variance + row.by().fold(0.0, |sum, (j, h)| sum + h * column[j]);
                if variance <= 0.0 || !variance.is_finite() {
                    return None;
                }
                filter.log_likelihood += row.log_density(variance);
                for (g, c) in gain.iter_mut().zip(&column) {
                    *g = c / variance;
                }
                for (w, g) in w.iter_mut().zip(&gain) {
                    *w += g * row.innovation;
                }
                filter.correct(gain[3..].iter().map(|g| g * row.innovation));
                for (row, g) in p.chunks_exact_mut(n).zip(&gain) {
                    for (p, c) in row.iter_mut().zip(&column) {
                        *p -= g * c;
                    }
                }
            }
        }
    }
    filter.learned_var = (3..n).map(|i| p[i * n + i]).collect();
    Some(())
}

/// Moves the pose by frame `t`'s action, and the covariance with it.
fn predict(filter: &Augmented, t: usize, w: &mut Vector3<f64>, p: &mut [f64], n: usize) {
    let stride = filter.stride(t, w);
    let at = 3 + stride.first;
    let mut three = [0.0; 3];
    let by = |i: usize, entry: &dyn Fn(usize) -> f64| {
        (0..3).fold(0.0, |sum, k| sum + stride.moved.f[(i, k)] * entry(k) + stride.by_velocity[(i, k)] * entry(at + k))
    };
    for j in 0..n {
        for (i, three) in three.iter_mut().enumerate() {
            *three = by(i, &|k| p[k * n + j]);
        }
        for (i, three) in three.iter().enumerate() {
            p[i * n + j] = *three;
        }
    }
    for row in p.chunks_exact_mut(n) {
        for (i, three) in three.iter_mut().enumerate() {
            *three = by(i, &|k| row[k]);
        }
        row[..3].copy_from_slice(&three);
    }
    for i in 0..3 {
        for j in 0..3 {
            p[i * n + j] += stride.moved.q[(i, j)];
        }
    }
    *w = stride.moved.to;
    w[2] = wrap_rad(w[2]);
}
