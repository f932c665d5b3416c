//! A rival of the related work: one extended Kalman filter over pose, velocities and sensor together.

use asami_dataset::{Log, Models, Rng};
use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;

use crate::augmented::{Augmented, Belief};
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::plane::Plane;

learner! {
    /// The state is augmented with all that is unknown of the models, which do not move: each sighting corrects
    /// pose and models at once through their joint covariance (Jazwinski 1970, section 8.4).
    ///
    /// The noise stays as given. Standard errors are the filter's own.
    JointEkf, "joint_ekf",
    "Filters pose, velocities and sensor as one state; the noise stays as given.",
    source "Jazwinski 1970, section 8.4", needs Both,
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

impl Learner for JointEkf {
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

/// One pass over the log.
fn pass(filter: &mut Augmented) -> Option<()> {
    let n = 3 + filter.parameters.len();
    // Rows of the covariance of pose and parameters together.
    let mut p = vec![0.0; n * n];
    for i in 0..n {
        p[i * n + i] = if i < 3 { filter.pose_var[i] } else { filter.parameter_var[i - 3] };
    }
    let (mut w, mut column, mut gain) = (filter.first_pose, vec![0.0; n], vec![0.0; n]);
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
                let variance = filter.variances[kind] + row.by().fold(0.0, |sum, (j, h)| sum + h * column[j]);
                if variance <= 0.0 || !variance.is_finite() {
                    return None;
                }
                filter.log_likelihood += row.log_density(variance);
                for (g, c) in gain.iter_mut().zip(&column) {
                    *g = c / variance;
                }
                for (i, g) in gain.iter().enumerate() {
                    let change = g * row.innovation;
                    if i < 3 {
                        w[i] += change
                    } else {
                        filter.parameters[i - 3] += change
                    }
                    for (p, c) in p[i * n..(i + 1) * n].iter_mut().zip(&column) {
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
fn predict(filter: &Augmented, t: usize, w: &mut [f64; 3], p: &mut [f64], n: usize) {
    let frame = &filter.plane.frames[t];
    let at = 3 + 3 * frame.action;
    let v: [f64; 3] = std::array::from_fn(|i| filter.parameters[at - 3 + i] * frame.dt_s);
    let (sin, cos) = sin_cos(w[2]);
    let moved = [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]];
    let dt_s = frame.dt_s;
    // w' = w + R(theta) v dt: rows x, y and heading take on a part of those of heading and velocity.
    let by: [[(usize, f64); 3]; 3] = [
        [(2, -moved[1]), (at, cos * dt_s), (at + 1, -sin * dt_s)],
        [(2, moved[0]), (at, sin * dt_s), (at + 1, cos * dt_s)],
        [(at + 2, dt_s), (2, 0.0), (2, 0.0)],
    ];
    for (i, by) in by.iter().enumerate() {
        for (from, factor) in by {
            for j in 0..n {
                p[i * n + j] += factor * p[from * n + j];
            }
        }
    }
    for (i, by) in by.iter().enumerate() {
        for j in 0..n {
            p[j * n + i] += by.iter().fold(0.0, |sum, (from, factor)| sum + factor * p[j * n + from]);
        }
    }
    let q = filter.motion_covariance(t, sin, cos);
    for i in 0..3 {
        for j in 0..3 {
            p[i * n + j] += q[i][j];
        }
    }
    *w = [w[0] + moved[0], w[1] + moved[1], wrap_rad(w[2] + moved[2])];
}
