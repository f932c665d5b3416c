//! A rival of the related work: two extended Kalman filters by turns, one for the pose and one for the models.

use asami_math::angle::wrap_rad;
use asami_math::kalman::Gaussian;
use nalgebra::{DMatrix, DVector, Matrix3xX, Vector3};

use crate::augmented::{Augmented, Row, augmented};

augmented! {
    /// The pose is filtered with the models as they are; the models are filtered with the pose's prediction as
    /// what they are observed by, which depends on them through all the steps before (Wan and Nelson 2001, "Dual
    /// extended Kalman filter methods", table 5.1, with the recurrent derivatives of its section 5.2.2).
    ///
    /// Unlike the joint filter, neither filter knows how unsure the other is. The noise stays as given. Standard
    /// errors are the filter's own.
    DualEkf, "dual_ekf",
    "Filters the pose and the models by turns; the noise stays as given.",
    source "Wan and Nelson 2001, Dual extended Kalman filter methods"
}

/// The pose and what it owes to the models.
struct Pose {
    state: Gaussian<3>,
    /// Derivatives of x, y and heading by each parameter, a column each.
    by: Matrix3xX<f64>,
}

/// One pass over the log.
fn pass(filter: &mut Augmented) -> Option<()> {
    let n = filter.parameter_var.len();
    let mut p = DMatrix::from_diagonal(&DVector::from_column_slice(&filter.parameter_var));
    let mut pose = Pose { state: filter.prior(), by: Matrix3xX::zeros(n) };
    for t in 0..filter.plane.frames.len() {
        if t > 0 {
            predict(filter, t - 1, &mut pose);
        }
        for seen in filter.plane.seen(t) {
            for kind in 0..2 {
                let row = filter.row(&pose.state.mean, seen, kind);
                observe(filter, &row, &mut pose, &mut p)?;
            }
        }
    }
    filter.learned_var = p.diagonal().iter().copied().collect();
    Some(())
}

/// Corrects the models, and then the pose, by one component of a sighting.
fn observe(filter: &mut Augmented, row: &Row, pose: &mut Pose, p: &mut DMatrix<f64>) -> Option<()> {
    // How the prediction depends on the pose, and on the models: directly, and through the pose.
    let (mut h, mut direct) = (Vector3::zeros(), Vec::new());
    for (j, by) in row.by() {
        if j < 3 {
            h[j] = by;
        } else {
            direct.push((j - 3, by));
        }
    }
    let mut c = pose.by.tr_mul(&h);
    for (j, by) in direct {
        c[j] += by;
    }
    let p_h = pose.state.covariance * h;
    let own = row.variance + h.dot(&p_h);
    let mut p_c = DVector::zeros(c.len());
    p_c.gemv(1.0, p, &c, 0.0);
    let variance = own + p_c.dot(&c);
    if own <= 0.0 || variance <= 0.0 || !own.is_finite() || !variance.is_finite() {
        return None;
    }
    filter.log_likelihood += row.log_density(own);
    filter.correct(p_c.iter().map(|x| x / variance * row.innovation));
    p.ger(-1.0 / variance, &p_c, &p_c, 1.0);
    let gain = p_h / own;
    pose.state.mean += gain * row.innovation;
    pose.by.ger(-1.0, &gain, &c, 1.0);
    pose.state.covariance -= gain * p_h.transpose();
    Some(())
}

/// Moves the pose by frame `t`'s action, with its covariance and its derivatives by the models.
fn predict(filter: &Augmented, t: usize, pose: &mut Pose) {
    let stride = filter.stride(t, &pose.state.mean);
    let moved = &stride.moved;
    pose.by = moved.f * &pose.by;
    let mut own = pose.by.fixed_columns_mut::<3>(stride.first);
    own += stride.by_velocity;
    let covariance = moved.f * pose.state.covariance * moved.f.transpose() + moved.q;
    pose.state = Gaussian { mean: moved.to, covariance };
    pose.state.mean[2] = wrap_rad(pose.state.mean[2]);
}
