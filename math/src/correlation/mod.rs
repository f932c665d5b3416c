//! Normalised cross-correlation of signals with holes, over all lags.
//!
//! Padfield, "Masked object registration in the Fourier domain", IEEE Transactions on Image Processing 2012: at each
//! lag the coefficient is taken over the places where both signals have a value. Fourier transforms find where it is
//! greatest; exact sums decide, so that the result has the same bits whichever transform the processor runs.

mod spectra;
#[cfg(test)]
mod tests;

use std::ops::RangeInclusive;

pub use spectra::correlograms;

/// Stands in a signal where it has no value.
pub const ABSENT: i16 = i16::MIN;

/// Coefficients within this of the greatest are decided by exact sums.
const UNDECIDED: f64 = 1e-6;

/// Sums over the places where two signals both have a value, one of them shifted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlap {
    /// How many places.
    pub count: i64,
    /// Sum of the first signal, and of its squares.
    pub x: [i64; 2],
    /// Sum of the second signal, and of its squares.
    pub y: [i64; 2],
    /// Sum of products.
    pub xy: i64,
}

impl Overlap {
    /// The sums over `(a[i], b[i + lag])`, exact.
    #[must_use]
    pub fn at(a: &[i16], b: &[i16], lag: isize) -> Self {
        let shift = lag.unsigned_abs();
        let (a, b) = if lag >= 0 { (a, b.get(shift..)) } else { (a.get(shift..).unwrap_or(&[]), Some(b)) };
        let b = b.unwrap_or(&[]);
        let n = a.len().min(b.len());
        let mut sums = Self::default();
        // Chunks are short enough for all sums to fit 32 bits, products in two halves of 15 bits.
        for (a, b) in a[..n].chunks(4096).zip(b[..n].chunks(4096)) {
            let (mut count, mut x, mut y) = (0i32, 0i32, 0i32);
            let (mut xx, mut yy, mut xy) = ([0i32; 2], [0i32; 2], [0i32; 2]);
            for (&a, &b) in a.iter().zip(b) {
                let both = -i16::from(a != ABSENT && b != ABSENT);
                let (a, b) = (a & both, b & both);
                count -= i32::from(both);
                x += i32::from(a);
                y += i32::from(b);
                let products = [(&mut xx, (a, a)), (&mut yy, (b, b)), (&mut xy, (a, b))];
                for (sum, (a, b)) in products {
                    let product = i32::from(a) * i32::from(b);
                    sum[0] += product & 0x7fff;
                    sum[1] += product >> 15;
                }
            }
            let whole = |[low, high]: [i32; 2]| i64::from(low) + (i64::from(high) << 15);
            sums.count += i64::from(count);
            sums.x = [sums.x[0] + i64::from(x), sums.x[1] + whole(xx)];
            sums.y = [sums.y[0] + i64::from(y), sums.y[1] + whole(yy)];
            sums.xy += whole(xy);
        }
        sums
    }

    /// Pearson's coefficient; `None` where fewer than two places overlap or a signal does not vary there.
    #[must_use]
    pub fn coefficient(&self) -> Option<f64> {
        let wide = |a: i64, b: i64| i128::from(a) * i128::from(b);
        let (xx, yy) = (
            wide(self.count, self.x[1]) - wide(self.x[0], self.x[0]),
            wide(self.count, self.y[1]) - wide(self.y[0], self.y[0]),
        );
        let xy = wide(self.count, self.xy) - wide(self.x[0], self.y[0]);
        (xx > 0 && yy > 0).then(|| xy as f64 / ((xx as f64).sqrt() * (yy as f64).sqrt()))
    }
}

/// Coefficients of one pair of signals over consecutive lags, by Fourier transform.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlogram {
    /// The first lag.
    pub first_lag: isize,
    /// Places of overlap, one per lag; exact.
    pub counts: Vec<i64>,
    /// Coefficients, one per lag; to about 1e-12. NaN where a signal hardly varies.
    pub coefficients: Vec<f64>,
}

/// The lag at which two signals correlate most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The second signal lies this many places behind the first.
    pub lag: isize,
    /// The coefficient there.
    pub coefficient: f64,
    /// Where a parabola through the coefficients at the peak and on both sides of it is greatest, in places from
    /// `lag`, within -0.5 to 0.5; 0 at the end of the lags, and until [`Peak::refined`].
    pub sub_step: f64,
    /// Twice the coefficient's drop from the peak to one place beside it: the parabola's curvature, per place squared. 0
    /// likewise.
    pub curvature: f64,
    /// The greatest coefficient among other peaks, `apart` places away or more; -1 if there is none.
    pub second: f64,
}

impl Peak {
    /// The peak of a correlogram of `a` and `b`, out of lags with at least `least_share` of the most places that overlap at any
    /// lag; ties go to the smaller lag. `None` where no lag has a coefficient.
    #[must_use]
    pub fn of(correlogram: &Correlogram, a: &[i16], b: &[i16], least_share: f64, apart: usize) -> Option<Self> {
        let most = correlogram.counts.iter().copied().max().unwrap_or(0);
        let enough = |i: usize| correlogram.counts[i] as f64 >= least_share * most as f64 && correlogram.counts[i] > 1;
        let found: Vec<usize> = (0..correlogram.coefficients.len()).filter(|&i| enough(i)).collect();
        let height = |i: usize| correlogram.coefficients[i];
        let greatest = found.iter().map(|&i| height(i)).filter(|c| !c.is_nan()).fold(f64::NEG_INFINITY, f64::max);
        let lag_of = |i: usize| correlogram.first_lag + i as isize;
        let exact = |i: usize| Overlap::at(a, b, lag_of(i)).coefficient();
        let (mut best, mut best_coefficient) = (None, f64::NEG_INFINITY);
        for &i in found.iter().filter(|&&i| height(i).is_nan() || height(i) >= greatest - UNDECIDED) {
            if let Some(coefficient) = exact(i).filter(|c| *c > best_coefficient) {
                (best, best_coefficient) = (Some(i), coefficient);
            }
        }
        let i = best?;
        let others = found.iter().filter(|&&j| j.abs_diff(i) >= apart).map(|&j| height(j));
        let second = others.filter(|c| !c.is_nan()).fold(-1.0, f64::max);
        Some(Self { lag: lag_of(i), coefficient: best_coefficient, sub_step: 0.0, curvature: 0.0, second })
    }

    /// The peak found between the places, by exact sums on both sides of it.
    #[must_use]
    pub fn refined(self, correlogram: &Correlogram, a: &[i16], b: &[i16]) -> Self {
        let within = |lag: isize| {
            (lag - correlogram.first_lag) < correlogram.counts.len() as isize && lag >= correlogram.first_lag
        };
        let beside = |lag: isize| within(lag).then(|| Overlap::at(a, b, lag).coefficient()).flatten();
        let (sub_step, curvature) = match (beside(self.lag - 1), beside(self.lag + 1)) {
            (Some(before), Some(after)) => vertex(before, self.coefficient, after),
            _ => (0.0, 0.0),
        };
        Self { sub_step, curvature, ..self }
    }

    /// The lag with its fraction, in places.
    #[must_use]
    pub fn fine_lag(&self) -> f64 {
        self.lag as f64 + self.sub_step
    }
}

/// Place, from the middle one, and curvature of the vertex of the parabola through three heights, the middle one greatest.
fn vertex(before: f64, middle: f64, after: f64) -> (f64, f64) {
    let curvature = 2.0 * middle - before - after;
    if curvature > 0.0 { ((0.5 * (after - before) / curvature).clamp(-0.5, 0.5), curvature) } else { (0.0, 0.0) }
}

/// Lags of both signs up to `most`.
#[must_use]
pub fn lags_to(most: usize) -> RangeInclusive<isize> {
    let most = most.min(isize::MAX as usize) as isize;
    -most..=most
}
