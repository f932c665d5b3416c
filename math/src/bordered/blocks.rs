//! Kernels over blocks of three rows.

use super::STATE;
use crate::elementary::ln;

pub(super) fn add(to: &mut [f64], from: &[f64]) {
    for (x, y) in to.iter_mut().zip(from) {
        *x += y;
    }
}

pub(super) fn subtract(to: &mut [f64], factor: f64, from: &[f64]) {
    for (x, y) in to.iter_mut().zip(from) {
        *x -= factor * y;
    }
}

/// Sum of a row's leading entries times known unknowns.
pub(super) fn known(row: &[f64], values: &[f64]) -> f64 {
    // Four sums at a time let the processor work on several at once; the order is fixed all the same.
    let mut sums = [0.0; 4];
    let whole = values.len() / 4 * 4;
    for (a, b) in row[..whole].chunks_exact(4).zip(values[..whole].chunks_exact(4)) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = row[whole..values.len()].iter().zip(&values[whole..]).fold(0.0, |sum, (x, y)| sum + x * y);
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// `to = factors[0] rows[0] + factors[1] rows[1] + factors[2] rows[2]`.
pub(super) fn combine(to: &mut [f64], factors: &[f64], rows: &[f64], width: usize) {
    let (r0, rest) = rows.split_at(width);
    let (r1, r2) = rest.split_at(width);
    for (((x, r0), r1), r2) in to.iter_mut().zip(r0).zip(r1).zip(r2) {
        *x = factors[0] * r0 + factors[1] * r1 + factors[2] * r2;
    }
}

/// `border -= rows^T gain`, in the upper triangle and the sides.
pub(super) fn reduce_border(border: &mut [f64], rows: &[f64], gain: &[f64], gain_width: usize, p: usize, width: usize) {
    for i in 0..p {
        let (a, b, c) = (rows[i], rows[width + i], rows[2 * width + i]);
        if (a, b, c) == (0.0, 0.0, 0.0) {
            continue;
        }
        let to = &mut border[i * width + i..(i + 1) * width];
        let (g0, g1, g2) = (&gain[i..], &gain[gain_width + i..], &gain[2 * gain_width + i..]);
        for (((x, g0), g1), g2) in to.iter_mut().zip(g0).zip(g1).zip(g2) {
            *x -= a * g0 + b * g1 + c * g2;
        }
    }
}

pub(super) fn add_gram(gram: &mut [f64], sides: &[f64], width: usize, gain: &[f64], gain_width: usize, columns: usize) {
    for c in 0..columns {
        for d in 0..columns {
            for k in 0..STATE {
                gram[c * columns + d] += sides[k * width + c] * gain[k * gain_width + d];
            }
        }
    }
}

/// Inverse and logarithm of the determinant of a positive definite block, by Cholesky's factor.
pub(super) fn inverse_of(a: &[f64; 9]) -> Option<([f64; 9], f64)> {
    let positive = |x: f64| (x > 0.0 && x.is_finite()).then(|| x.sqrt());
    let l00 = positive(a[0])?;
    let (l10, l20) = (a[3] / l00, a[6] / l00);
    let l11 = positive(a[4] - l10 * l10)?;
    let l21 = (a[7] - l20 * l10) / l11;
    let l22 = positive(a[8] - l20 * l20 - l21 * l21)?;
    // Inverse of the factor, then of the product.
    let (m00, m11, m22) = (1.0 / l00, 1.0 / l11, 1.0 / l22);
    let m10 = -l10 * m00 * m11;
    let m21 = -l21 * m11 * m22;
    let m20 = -(l20 * m00 + l21 * m10) * m22;
    let (i00, i11, i22) = (m00 * m00 + m10 * m10 + m20 * m20, m11 * m11 + m21 * m21, m22 * m22);
    let (i01, i02, i12) = (m10 * m11 + m20 * m21, m20 * m22, m21 * m22);
    Some(([i00, i01, i02, i01, i11, i12, i02, i12, i22], 2.0 * ln(l00 * l11 * l22)))
}
