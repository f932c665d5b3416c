//! The size of a landmark as a polynomial of its distance, without allocation.

use asami_math::polynomial::Polynomial;

/// Most coefficients that `f` may have.
pub const MOST: usize = 6;

/// `f`: the first `n` coefficients in powers of `(d - centre) / scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeCurve {
    /// Coefficients; those from `n` on are zero.
    pub c: [f64; MOST],
    /// How many there are.
    pub n: usize,
    /// Subtracted from the distance.
    pub centre_m: f64,
    /// Divides it then.
    pub scale_m: f64,
}

impl SizeCurve {
    /// A polynomial in another basis, with `n` coefficients; those beyond are cut.
    #[must_use]
    pub fn new(polynomial: &Polynomial, n: usize, centre_m: f64, scale_m: f64) -> Self {
        let n = n.min(MOST);
        let mut c = [0.0; MOST];
        for (to, from) in c[..n].iter_mut().zip(polynomial.rebased(centre_m, scale_m).coefficients) {
            *to = from;
        }
        Self { c, n, centre_m, scale_m }
    }

    /// As a polynomial.
    #[must_use]
    pub fn polynomial(&self) -> Polynomial {
        Polynomial { coefficients: self.c[..self.n].to_vec(), centre: self.centre_m, scale: self.scale_m }
    }

    /// The scaled distance.
    #[must_use]
    pub fn scaled(&self, distance_m: f64) -> f64 {
        (distance_m - self.centre_m) / self.scale_m
    }

    /// `f(d)` and its derivative, by Horner's rule.
    #[must_use]
    pub fn at(&self, distance_m: f64) -> (f64, f64) {
        let u = self.scaled(distance_m);
        let (mut value, mut slope) = (0.0, 0.0);
        for c in self.c[..self.n].iter().rev() {
            slope = slope * u + value;
            value = value * u + c;
        }
        (value, slope / self.scale_m)
    }

    /// Second derivative of `f`.
    #[must_use]
    pub fn curvature_at(&self, distance_m: f64) -> f64 {
        let u = self.scaled(distance_m);
        let terms = self.c[..self.n].iter().enumerate().skip(2).rev();
        terms.fold(0.0, |sum, (i, c)| sum * u + (i * (i - 1)) as f64 * c) / (self.scale_m * self.scale_m)
    }
}
