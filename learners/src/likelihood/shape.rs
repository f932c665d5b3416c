//! Shapes of the curve from place to observation.

use asami_math::polynomial::Polynomial;

/// `f(u) = f_0 + g u / (1 + d u) + f_m u^m + ... + f_n u^n`, where `m` is 2, or 3 beside a pole: the pole itself
/// does what a square would.
///
/// `f_0` and `g` are not learned: that the observation is `f_0` at `u = 0` and has slope `g` there is what
/// `u` means, for S and A are learned up to shift and scale only. With `d = 0` this is any polynomial;
/// with `d` alone, the image of an object by a pinhole, or a range, at the price of one coefficient.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) f_0: f64,
    pub(super) g: f64,
    /// `d`, of a shape that has it.
    pub(super) pole: Option<f64>,
    /// `f_m, f_(m+1), ...`
    pub(super) bends: Vec<f64>,
}

impl Shape {
    /// `m`, the power of the first bend.
    fn first_power(&self) -> usize {
        2 + usize::from(self.pole.is_some())
    }

    /// The degree that the shape would have as a polynomial.
    pub(super) fn degree(&self) -> usize {
        self.first_power() - 1 + self.bends.len()
    }

    /// How many coefficients are learned.
    pub(super) fn unknowns(&self) -> usize {
        usize::from(self.pole.is_some()) + self.bends.len()
    }

    /// The shape with other coefficients: `d` first, if it has one.
    pub(super) fn with(&self, step: &[f64]) -> Self {
        let (pole, bends) = step.split_at(usize::from(self.pole.is_some()));
        Self {
            pole: self.pole.map(|d| d + pole[0]),
            bends: self.bends.iter().zip(bends).map(|(f, step)| f + step).collect(),
            ..*self
        }
    }

    /// The shape with or without a pole and with some number of bends, as near as these allow.
    pub(super) fn reshaped(&self, pole: bool, bends: usize) -> Self {
        let mut other = self.clone();
        match (self.pole, pole) {
            (Some(d), false) => {
                // g u / (1 + d u) = g u - g d u^2 + g d^2 u^3 - ...
                let term = |k: usize| self.g * power(-d, k - 1);
                other.pole = None;
                other.bends =
                    (2..2 + bends).map(|k| term(k) + k.checked_sub(3).map_or(0.0, |i| self.bend(i))).collect();
            }
            (None, true) => {
                other.pole = Some((-self.bend(0) / self.g).clamp(-0.5, 0.5));
                other.bends = self.bends.iter().skip(1).copied().collect();
            }
            _ => {}
        }
        other.bends.resize(bends, 0.0);
        other
    }

    fn bend(&self, i: usize) -> f64 {
        self.bends.get(i).copied().unwrap_or(0.0)
    }

    /// Value at `u`.
    pub(super) fn at(&self, u: f64) -> f64 {
        let m = self.first_power();
        let bend = self.bends.iter().rev().fold(0.0, |sum, f| sum * u + f) * power(u, m);
        self.f_0 + self.g * u / self.denominator(u) + bend
    }

    /// Derivative at `u`.
    pub(super) fn slope_at(&self, u: f64) -> f64 {
        let terms = self.bends.iter().enumerate().rev();
        let m = self.first_power();
        let bend = terms.fold(0.0, |sum, (i, f)| sum * u + (i + m) as f64 * f) * power(u, m - 1);
        let below = self.denominator(u);
        self.g / (below * below) + bend
    }

    /// Derivatives with respect to the learned coefficients at `u`, into `gradient`.
    pub(super) fn gradient_at(&self, u: f64, gradient: &mut [f64]) {
        let mut raised = u * u;
        let poles = usize::from(self.pole.is_some());
        if let (Some(_), Some(by_pole)) = (self.pole, gradient.first_mut()) {
            let below = self.denominator(u);
            *by_pole = -self.g * raised / (below * below);
            raised *= u;
        }
        for by_bend in gradient.iter_mut().skip(poles) {
            *by_bend = raised;
            raised *= u;
        }
    }

    /// Second derivative at `u`.
    pub(super) fn curvature_at(&self, u: f64) -> f64 {
        let m = self.first_power();
        let terms = self.bends.iter().enumerate().rev();
        let bend = terms.fold(0.0, |sum, (i, f)| sum * u + ((i + m) * (i + m - 1)) as f64 * f) * power(u, m - 2);
        let (d, below) = (self.pole.unwrap_or(0.0), self.denominator(u));
        -2.0 * self.g * d / (below * below * below) + bend
    }

    /// Derivatives of the slope at `u` with respect to the learned coefficients, into `gradient`.
    pub(super) fn slope_gradient_at(&self, u: f64, gradient: &mut [f64]) {
        let m = self.first_power();
        let poles = usize::from(self.pole.is_some());
        if let (Some(_), Some(by_pole)) = (self.pole, gradient.first_mut()) {
            let below = self.denominator(u);
            *by_pole = -2.0 * self.g * u / (below * below * below);
        }
        let mut raised = power(u, m - 1);
        for (i, by_bend) in gradient.iter_mut().skip(poles).enumerate() {
            *by_bend = (i + m) as f64 * raised;
            raised *= u;
        }
    }

    /// `1 + d u`; the shape means something only where this is positive.
    pub(super) fn denominator(&self, u: f64) -> f64 {
        1.0 + self.pole.unwrap_or(0.0) * u
    }

    /// The inverse over places from `least` to `greatest`: a polynomial of the observation.
    pub(super) fn inverse(&self, least: f64, greatest: f64, max_degree: usize) -> Option<Inverse> {
        const POINTS: usize = 60;
        let step = (greatest - least) / (POINTS - 1) as f64;
        let sign = self.g.signum();
        // From the middle outwards, as far as the shape can be inverted.
        let place = |i: usize| least + step * i as f64;
        let rises = |i: usize| self.denominator(place(i)) > 0.02 && self.slope_at(place(i)) * sign > 0.0;
        let first = (0..POINTS / 2).rev().take_while(|i| rises(*i)).last()?;
        let last = (POINTS / 2..POINTS).take_while(|i| rises(*i)).last()?;
        let points: Vec<(f64, f64)> = (first..=last).map(|i| (self.at(place(i)), place(i))).collect();
        let ends = (points.first()?.0, points.last()?.0);
        let (centre, scale) = (0.5 * (ends.0 + ends.1), 0.5 * (ends.1 - ends.0).abs());
        (1..=max_degree).find_map(|degree| {
            let (polynomial, _) = Polynomial::fit(points.iter().copied(), degree, centre, scale)?;
            let miss = points.iter().fold(0.0, |most: f64, (o, u)| most.max((polynomial.at(*o) - u).abs()));
            (degree == max_degree || miss < 2e-4 * (greatest - least))
                .then(|| Inverse { polynomial, points: points.clone() })
        })
    }
}

fn power(u: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |power, _| power * u)
}

/// A polynomial from observation to place.
pub(super) struct Inverse {
    pub(super) polynomial: Polynomial,
    /// The `(o, u)` that it goes through.
    points: Vec<(f64, f64)>,
}

impl Inverse {
    /// How its coefficients change with the learned coefficients of `shape`: one row for each of the
    /// latter.
    pub(super) fn sensitivity(&self, shape: &Shape) -> Option<Vec<Vec<f64>>> {
        let (n, p) = (shape.unknowns(), &self.polynomial);
        let mut gradient = vec![0.0; n];
        let gradients: Vec<Vec<f64>> = self
            .points
            .iter()
            .map(|(_, u)| {
                shape.gradient_at(*u, &mut gradient);
                gradient.iter().map(|by| -by / shape.slope_at(*u)).collect()
            })
            .collect();
        let column = |k: usize| gradients.iter().map(move |by| by[k]);
        (0..n)
            .map(|k| {
                let points = self.points.iter().zip(column(k)).map(|((o, _), by)| (*o, by));
                Some(Polynomial::fit(points, p.degree(), p.centre, p.scale)?.0.coefficients)
            })
            .collect()
    }
}

/// A polynomial through `(u, o)` points, moved so that `u = 0` is where it takes the value `f_0`.
pub(super) fn first_shape(points: &[(f64, f64)]) -> Option<Shape> {
    let (fitted, _) = Polynomial::fit(points.iter().copied(), 1, 0.0, 1.0)?;
    let g = fitted.coefficients[1];
    (g != 0.0 && g.is_finite()).then(|| Shape { f_0: fitted.coefficients[0], g, pole: None, bends: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape() -> Shape {
        Shape { f_0: 20.0, g: -9.0, pole: Some(0.4), bends: vec![0.3, -0.2] }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let (shape, u, h) = (shape(), 0.6, 1e-5);
        let slope = (shape.at(u + h) - shape.at(u - h)) / (2.0 * h);
        assert!((slope - shape.slope_at(u)).abs() < 1e-7);
        let curvature = (shape.slope_at(u + h) - shape.slope_at(u - h)) / (2.0 * h);
        assert!((curvature - shape.curvature_at(u)).abs() < 1e-7);
        let (mut gradient, mut slope_gradient) = ([0.0; 3], [0.0; 3]);
        shape.gradient_at(u, &mut gradient);
        shape.slope_gradient_at(u, &mut slope_gradient);
        for (k, (by, slope_by)) in gradient.iter().zip(slope_gradient).enumerate() {
            let moved = |by: f64| shape.with(&[0, 1, 2].map(|i| if i == k { by } else { 0.0 }));
            assert!(((moved(h).at(u) - moved(-h).at(u)) / (2.0 * h) - by).abs() < 1e-7, "{k}");
            let limit = (moved(h).slope_at(u) - moved(-h).slope_at(u)) / (2.0 * h);
            assert!((limit - slope_by).abs() < 1e-7, "{k}");
        }
    }

    #[test]
    fn reshaping_keeps_the_curve_near_the_middle() {
        let shape = shape();
        let polynomial = shape.reshaped(false, 6);
        assert_eq!(polynomial.degree(), 7);
        let back = Shape { pole: None, bends: vec![-0.8], ..shape.clone() };
        for u in [-0.1, 0.0, 0.1] {
            assert!((polynomial.at(u) - shape.at(u)).abs() < 1e-6);
            assert!((back.reshaped(true, 0).at(u) - back.at(u)).abs() < 2e-3);
        }
    }

    #[test]
    fn inverse_undoes_the_shape_and_follows_its_coefficients() {
        let shape = shape();
        let inverse = shape.inverse(-1.0, 1.0, 8).unwrap();
        for i in -10..=10 {
            let u = 0.1 * f64::from(i);
            assert!((inverse.polynomial.at(shape.at(u)) - u).abs() < 1e-3);
        }
        let h = 1e-5;
        let moved = shape.with(&[h, 0.0, 0.0]).inverse(-1.0, 1.0, inverse.polynomial.degree()).unwrap();
        let o = 17.0;
        let by_pole =
            Polynomial { coefficients: inverse.sensitivity(&shape).unwrap()[0].clone(), ..inverse.polynomial };
        assert!(((moved.polynomial.at(o) - inverse.polynomial.at(o)) / h - by_pole.at(o)).abs() < 1e-2);
    }
}
