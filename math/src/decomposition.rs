//! Decompositions of small dense matrices, in a fixed order of operations.

/// Thin singular value decomposition `M = U diag(s) V^T` of a matrix with at least as many rows as
/// columns.
#[derive(Clone, Debug)]
pub struct Svd {
    /// Columns of `U`, one per singular value; a column of a vanishing singular value is zero.
    pub left: Vec<Vec<f64>>,
    /// Singular values, greatest first.
    pub values: Vec<f64>,
    /// Columns of `V`.
    pub right: Vec<Vec<f64>>,
}

/// One-sided Jacobi rotations (Hestenes 1958): accurate to the last columns, and the same bits
/// everywhere. `columns` are the columns of the matrix.
#[must_use]
pub fn svd(columns: &[Vec<f64>]) -> Svd {
    let n = columns.len();
    let mut m: Vec<Vec<f64>> = columns.to_vec();
    let mut v: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for _sweep in 0..60 {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let (alpha, beta, gamma) = (dot(&m[p], &m[p]), dot(&m[q], &m[q]), dot(&m[p], &m[q]));
                let orthogonal = gamma.abs() <= 1e-16 * (alpha * beta).sqrt();
                if orthogonal || gamma == 0.0 || !gamma.is_finite() {
                    continue;
                }
                turned = true;
                let zeta = (beta - alpha) / (2.0 * gamma);
                let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                rotate(&mut m, p, q, c, c * t);
                rotate(&mut v, p, q, c, c * t);
            }
        }
        if !turned {
            break;
        }
    }
    let mut order: Vec<(f64, usize)> = m.iter().map(|column| dot(column, column).sqrt()).zip(0..).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let unit = |i: usize, s: f64| m[i].iter().map(|x| if s > 0.0 { x / s } else { 0.0 }).collect();
    Svd {
        left: order.iter().map(|&(s, i)| unit(i, s)).collect(),
        values: order.iter().map(|&(s, _)| s).collect(),
        right: order.iter().map(|&(_, i)| v[i].clone()).collect(),
    }
}

fn rotate(columns: &mut [Vec<f64>], p: usize, q: usize, c: f64, s: f64) {
    for i in 0..columns[p].len() {
        let (x, y) = (columns[p][i], columns[q][i]);
        columns[p][i] = c * x - s * y;
        columns[q][i] = s * x + c * y;
    }
}

/// Inner product, summed from the first element on.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (x, y)| sum + x * y)
}

/// Lower Cholesky factor of a symmetric positive definite matrix given by rows; `None` where it is
/// not positive definite.
#[must_use]
pub fn cholesky(a: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let rest = a[i][j] - dot(&l[i][..j], &l[j][..j]);
            if i == j {
                if rest <= 0.0 || !rest.is_finite() {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    Some(l)
}

/// Solves `L L^T x = b`.
#[must_use]
pub fn cholesky_solve(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    cholesky_transposed_solve(l, &cholesky_forward_solve(l, b))
}

/// Solves `L x = b`.
#[must_use]
pub fn cholesky_forward_solve(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    for i in 0..l.len() {
        x[i] = (x[i] - dot(&l[i][..i], &x[..i])) / l[i][i];
    }
    x
}

/// Solves `L^T x = b`: of standard Gaussian numbers it makes some whose inverse covariance is `L L^T`.
#[must_use]
pub fn cholesky_transposed_solve(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    for i in (0..l.len()).rev() {
        let known = (i + 1..l.len()).fold(0.0, |sum, k| sum + l[k][i] * x[k]);
        x[i] = (x[i] - known) / l[i][i];
    }
    x
}

/// The diagonal of the inverse of `L L^T`.
#[must_use]
pub fn cholesky_inverse_diagonal(l: &[Vec<f64>]) -> Vec<f64> {
    let n = l.len();
    let mut diagonal = vec![0.0; n];
    let mut column = vec![0.0; n];
    for j in 0..n {
        // Column j of the inverse of L begins at row j.
        for i in j..n {
            let known = dot(&l[i][j..i], &column[j..i]);
            column[i] = (if i == j { 1.0 } else { 0.0 } - known) / l[i][i];
        }
        diagonal[j] = dot(&column[j..], &column[j..]);
    }
    diagonal
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn svd_agrees_with_nalgebra(entries in proptest::collection::vec(-10.0..10.0f64, 24)) {
            let columns: Vec<Vec<f64>> = entries.chunks(6).map(<[f64]>::to_vec).collect();
            let ours = svd(&columns);
            let theirs = DMatrix::from_column_slice(6, 4, &entries).svd(false, false).singular_values;
            for (a, b) in ours.values.iter().zip(theirs.iter()) {
                prop_assert!((a - b).abs() < 1e-10, "{a} {b}");
            }
            for (j, column) in columns.iter().enumerate() {
                for (i, entry) in column.iter().enumerate() {
                    let sum: f64 = (0..4).map(|k| ours.left[k][i] * ours.values[k] * ours.right[k][j]).sum();
                    prop_assert!((sum - entry).abs() < 1e-10);
                }
            }
        }

        #[test]
        fn the_inverse_has_this_diagonal(entries in proptest::collection::vec(-1.0..1.0f64, 25)) {
            let m = DMatrix::from_row_slice(5, 5, &entries);
            let a = &m * m.transpose() + DMatrix::identity(5, 5);
            let rows: Vec<Vec<f64>> = a.row_iter().map(|row| row.iter().copied().collect()).collect();
            let theirs = a.try_inverse().unwrap();
            let ours = cholesky_inverse_diagonal(&cholesky(&rows).unwrap());
            for (i, it) in ours.iter().enumerate() {
                prop_assert!((it - theirs[(i, i)]).abs() < 1e-10, "{it} {}", theirs[(i, i)]);
            }
        }

        #[test]
        fn cholesky_solves(entries in proptest::collection::vec(-1.0..1.0f64, 25), b in proptest::collection::vec(-1.0..1.0f64, 5)) {
            let m: Vec<Vec<f64>> = entries.chunks(5).map(<[f64]>::to_vec).collect();
            let a: Vec<Vec<f64>> = (0..5)
                .map(|i| (0..5).map(|j| dot(&m[i], &m[j]) + f64::from(u8::from(i == j))).collect())
                .collect();
            let x = cholesky_solve(&cholesky(&a).unwrap(), &b);
            for (row, b) in a.iter().zip(&b) {
                prop_assert!((dot(row, &x) - b).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn cholesky_refuses_the_indefinite() {
        assert!(cholesky(&[vec![1.0, 2.0], vec![2.0, 1.0]]).is_none());
        assert!(cholesky(&[vec![f64::NAN]]).is_none());
    }
}
