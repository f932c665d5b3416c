//! A rival of the related work: two extended Kalman filters by turns, one for the pose and one for the models.

use asami_dataset::{Log, Models, Rng};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;

use crate::augmented::{Augmented, Belief};
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::plane::Plane;

learner! {
    /// The pose is filtered with the models as they are; the models are filtered with the pose's prediction as
    /// what they are observed by, which depends on them through all the steps before (Wan and Nelson 2001, "Dual
    /// extended Kalman filter methods", table 5.1, with the recurrent derivatives of its section 5.2.2).
    ///
    /// Unlike the joint filter, neither filter knows how unsure the other is. The noise stays as given. Standard
    /// errors are the filter's own.
    DualEkf, "dual_ekf",
    "Filters the pose and the models by turns; the noise stays as given.",
    source "Wan and Nelson 2001, Dual extended Kalman filter methods", needs Both,
    {
        /// Degree of the sensor model, a polynomial of distance.
        sensor_degree: u32 = 3, "1", 1.0..=8.0;
        /// How well translation is known beforehand.
        velocity_sd_m_per_s: f64 = 0.3, "m/s", 0.001..=100.0;
        /// How well turning is known beforehand.
        turn_sd_rad_per_s: f64 = 1.0, "rad/s", 0.001..=100.0;
        /// How well the sensor is known beforehand, as a share of the sizes' standard deviation in the log.
        sensor_sd_share: f64 = 2.0, "1", 0.001..=1000.0;
        /// Passes over the log; each starts from the models of the one before, and as unsure as the first.
        max_iterations: u32 = 1, "1", 1.0..=1000.0;
    }
}

impl Learner for DualEkf {
    fn about(&self) -> &'static crate::learner::About {
        Self::about()
    }

    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let plane = Plane::try_from(log)?;
        let belief = Belief {
            sensor_degree: self.sensor_degree as usize,
            velocity_sd: [self.velocity_sd_m_per_s, self.velocity_sd_m_per_s, self.turn_sd_rad_per_s],
            sensor_sd_share: self.sensor_sd_share,
        };
        Augmented::new(&plane, given, &belief)?.learn(self.max_iterations, pass)
    }
}

/// The pose and what it owes to the models.
struct Pose {
    w: [f64; 3],
    p: [[f64; 3]; 3],
    /// Derivatives of x, y and heading by each parameter.
    by: [Vec<f64>; 3],
}

/// One pass over the log.
fn pass(filter: &mut Augmented) -> Option<()> {
    let n = filter.parameters.len();
    // Rows of the parameters' covariance.
    let mut p = vec![0.0; n * n];
    for (i, variance) in filter.parameter_var.iter().enumerate() {
        p[i * n + i] = *variance;
    }
    let mut pose = Pose { w: filter.first_pose, p: [[0.0; 3]; 3], by: std::array::from_fn(|_| vec![0.0; n]) };
    for (i, variance) in filter.pose_var.iter().enumerate() {
        pose.p[i][i] = *variance;
    }
    let (mut c, mut column) = (vec![0.0; n], vec![0.0; n]);
    for t in 0..filter.plane.frames.len() {
        if t > 0 {
            predict(filter, t - 1, &mut pose);
        }
        for seen in filter.plane.seen(t) {
            for kind in 0..2 {
                let row = filter.row(&pose.w, seen, kind);
                // How the prediction depends on the pose, and on the models: directly, and through the pose.
                let mut h = [0.0; 3];
                c.fill(0.0);
                for (j, by) in row.by() {
                    if j < 3 {
                        h[j] = by;
                        for (c, through) in c.iter_mut().zip(&pose.by[j]) {
                            *c += by * through;
                        }
                    } else {
                        c[j - 3] += by;
                    }
                }
                let ph: [f64; 3] = std::array::from_fn(|i| (0..3).fold(0.0, |sum, j| sum + pose.p[i][j] * h[j]));
                let own = filter.variances[kind] + (0..3).fold(0.0, |sum, i| sum + h[i] * ph[i]);
                for (x, row) in column.iter_mut().zip(p.chunks_exact(n)) {
                    *x = row.iter().zip(&c).fold(0.0, |sum, (p, c)| sum + p * c);
                }
                let variance = own + column.iter().zip(&c).fold(0.0, |sum, (x, c)| sum + x * c);
                if own <= 0.0 || variance <= 0.0 || !own.is_finite() || !variance.is_finite() {
                    return None;
                }
                filter.log_likelihood += row.log_density(own);
                for (i, x) in column.iter().enumerate() {
                    filter.parameters[i] += x / variance * row.innovation;
                    for (p, y) in p[i * n..(i + 1) * n].iter_mut().zip(&column) {
                        *p -= x / variance * y;
                    }
                }
                for i in 0..3 {
                    let gain = ph[i] / own;
                    pose.w[i] += gain * row.innovation;
                    for (by, c) in pose.by[i].iter_mut().zip(&c) {
                        *by -= gain * c;
                    }
                    for (p, ph) in pose.p[i].iter_mut().zip(&ph) {
                        *p -= gain * ph;
                    }
                }
            }
        }
    }
    filter.learned_var = (0..n).map(|i| p[i * n + i]).collect();
    Some(())
}

/// Moves the pose by frame `t`'s action, with its covariance and its derivatives by the models.
fn predict(filter: &Augmented, t: usize, pose: &mut Pose) {
    let frame = &filter.plane.frames[t];
    let at = 3 * frame.action;
    let v: [f64; 3] = std::array::from_fn(|i| filter.parameters[at + i] * frame.dt_s);
    let (sin, cos) = sin_cos(pose.w[2]);
    let moved = [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]];
    let by_heading = [-moved[1], moved[0]];
    for (i, factor) in by_heading.into_iter().enumerate() {
        let (others, heading) = pose.by.split_at_mut(2);
        for (by, through) in others[i].iter_mut().zip(&heading[0]) {
            *by += factor * through;
        }
        for j in 0..3 {
            pose.p[i][j] += factor * pose.p[2][j];
        }
    }
    for row in &mut pose.p {
        for (i, factor) in by_heading.into_iter().enumerate() {
            row[i] += factor * row[2];
        }
    }
    let dt_s = frame.dt_s;
    pose.by[0][at] += cos * dt_s;
    pose.by[0][at + 1] -= sin * dt_s;
    pose.by[1][at] += sin * dt_s;
    pose.by[1][at + 1] += cos * dt_s;
    pose.by[2][at + 2] += dt_s;
    let q = filter.motion_covariance(t, sin, cos);
    for (p, q) in pose.p.iter_mut().flatten().zip(q.iter().flatten()) {
        *p += q;
    }
    for (w, moved) in pose.w.iter_mut().zip(moved) {
        *w += moved;
    }
    pose.w[2] = wrap_rad(pose.w[2]);
}
