//! Least squares of what is of one thing, among much that is of something else.

use asami_math::regression::least_squares;
use asami_math::statistics::median;

use super::{OUTLIER, ROUNDS};

/// What is usual is no less than this, in metres or radians.
const LEAST_OFF: f64 = 1e-9;

/// What is to be explained, and by what.
pub(super) type Row<const N: usize> = ([f64; N], f64);

/// Least squares of those rows that are not of something else, and which these are; `None` where they leave something open.
pub(super) fn fitted<const N: usize>(rows: &[Row<N>]) -> Option<([f64; N], Vec<bool>)> {
    fitted_by(rows, &vec![0; rows.len()])
}

/// The same where those of each class scatter by themselves, and count the less the more they do.
pub(super) fn fitted_by<const N: usize>(rows: &[Row<N>], class: &[usize]) -> Option<([f64; N], Vec<bool>)> {
    let mut usual = vec![1.0; class.iter().max().map_or(0, |last| last + 1)];
    let mut kept = vec![true; rows.len()];
    let mut found = [0.0; N];
    for _ in 0..ROUNDS {
        let weighed = |(i, (x, y)): (usize, &Row<N>)| (x.map(|x| x / usual[class[i]]).to_vec(), y / usual[class[i]]);
        let fit = least_squares(N, rows.iter().enumerate().filter(|(i, _)| kept[*i]).map(weighed)).solve();
        found = fit.filter(|fit| fit.rank == N)?.coefficients.try_into().ok()?;
        let off = |row: &Row<N>| (row.1 - row.0.iter().zip(found).fold(0.0, |sum, (x, k)| sum + k * x)).abs();
        let off: Vec<f64> = rows.iter().map(off).collect();
        for (k, usual) in usual.iter_mut().enumerate() {
            let of_class: Vec<f64> = off.iter().zip(class).filter(|(_, of)| **of == k).map(|it| *it.0).collect();
            *usual = median(&of_class).unwrap_or(0.0).max(LEAST_OFF);
        }
        kept = off.iter().zip(class).map(|(off, class)| *off <= OUTLIER * usual[*class]).collect();
    }
    Some((found, kept))
}
