//! Velocities that borrow strength from each other: a smooth function of the attempted velocities, and what each
//! action has of its own.
//!
//! With the log's information about all parameters, the velocities' prior is
//! `v_a ~ N(B(u_a) beta, tau^2)` along each axis, `beta` free and `tau^2` at its greatest marginal likelihood
//! (empirical Bayes; Efron and Morris 1975). `f` moves with them as far as the information ties it to them.

use asami_math::decomposition::{cholesky, cholesky_solve};

use super::information::Information;
use crate::plane::Plane;

/// Features of an action: constant, the attempted velocities in units of their greatest, and their signed squares.
fn features(attempted: &[f64; 3], greatest: &[f64; 3]) -> Vec<f64> {
    let u = [0, 1, 2].map(|i| if greatest[i] > 0.0 { attempted[i] / greatest[i] } else { 0.0 });
    [1.0].into_iter().chain(u).chain(u.map(|u| u * u.abs())).collect()
}

/// The parameters and their covariance after sharing.
#[derive(Clone, Debug)]
pub struct Shared {
    /// Velocities, then coefficients of `f`.
    pub parameters: Vec<f64>,
    /// Their covariance.
    pub covariance: Vec<Vec<f64>>,
    /// `tau` along each axis.
    pub tau: Vec<f64>,
}

/// Shares among the first `axes * actions` of `parameters`. `None` if the equations have no solution.
pub fn shared(plane: &Plane, axes: usize, parameters: &[f64], information: &Information) -> Option<Shared> {
    let (n, actions) = (parameters.len(), plane.actions.len());
    let greatest = plane
        .actions
        .iter()
        .fold([0.0f64; 3], |most, action| [0, 1, 2].map(|i| most[i].max(action.attempted[i].abs())));
    let features: Vec<Vec<f64>> = plane.actions.iter().map(|action| features(&action.attempted, &greatest)).collect();
    let k = features[0].len();
    // Unknowns: the parameters, then beta for each axis.
    let total = n + axes * k;
    let mut tau2 = vec![0.1 * 0.1; axes];
    let target: Vec<f64> = (0..n).map(|i| dot_row(&information[i], parameters)).collect();
    let mut solution = None;
    for _ in 0..60 {
        let mut matrix = vec![vec![0.0; total]; total];
        for i in 0..n {
            matrix[i][..n].copy_from_slice(&information[i]);
            matrix[i][i] += 1e-8;
        }
        for (a, b) in features.iter().enumerate() {
            for (axis, tau2) in tau2.iter().enumerate() {
                let (v, first, weight) = (axes * a + axis, n + axis * k, 1.0 / tau2);
                matrix[v][v] += weight;
                for p in 0..k {
                    matrix[v][first + p] -= weight * b[p];
                    matrix[first + p][v] -= weight * b[p];
                    for q in 0..k {
                        matrix[first + p][first + q] += weight * b[p] * b[q];
                    }
                }
            }
        }
        for (i, row) in matrix.iter_mut().enumerate().skip(n) {
            // Features that no action has.
            row[i] += 1e-6;
        }
        let l = cholesky(&matrix)?;
        let right: Vec<f64> = target.iter().copied().chain(std::iter::repeat_n(0.0, total - n)).collect();
        let x = cholesky_solve(&l, &right);
        let column = |i: usize| {
            let unit: Vec<f64> = (0..total).map(|j| f64::from(u8::from(i == j))).collect();
            cholesky_solve(&l, &unit)
        };
        let covariance: Vec<Vec<f64>> = (0..total).map(column).collect();
        // EM for tau^2: mean of E (v - B beta)^2.
        let before = tau2.clone();
        for (axis, tau2) in tau2.iter_mut().enumerate() {
            let square = |(a, b): (usize, &Vec<f64>)| {
                let (v, first) = (axes * a + axis, n + axis * k);
                let mut direction = vec![0.0; total];
                direction[v] = 1.0;
                for p in 0..k {
                    direction[first + p] = -b[p];
                }
                let mean = dot_row(&direction, &x);
                let spread: Vec<f64> = covariance.iter().map(|row| dot_row(row, &direction)).collect();
                mean * mean + dot_row(&direction, &spread)
            };
            *tau2 = (features.iter().enumerate().map(square).sum::<f64>() / actions as f64).max(1e-10);
        }
        let settled = before.iter().zip(&tau2).all(|(a, b)| (a - b).abs() < 1e-3 * b);
        solution = Some((x, covariance));
        if settled {
            break;
        }
    }
    let (mut x, mut covariance) = solution?;
    x.truncate(n);
    covariance.truncate(n);
    for row in &mut covariance {
        row.truncate(n);
    }
    Some(Shared { parameters: x, covariance, tau: tau2.iter().map(|tau2| tau2.sqrt()).collect() })
}

fn dot_row(a: &[f64], b: &[f64]) -> f64 {
    asami_math::decomposition::dot(a, b)
}
