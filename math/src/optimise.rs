//! Minimisation.

/// The least value of a function of one variable found between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Where.
    pub x: f64,
    /// The value there.
    pub value: f64,
}

/// Golden-section search (Kiefer 1953): finds the minimum of a function with only one between `a` and
/// `b` to within `tolerance`; with several, one of them.
///
/// ```
/// use asami_math::optimise::golden_section;
/// let found = golden_section(|x| (x - 0.3) * (x - 0.3), -1.0, 2.0, 1e-6);
/// assert!((found.x - 0.3).abs() < 1e-6);
/// ```
#[must_use]
pub fn golden_section(mut f: impl FnMut(f64) -> f64, a: f64, b: f64, tolerance: f64) -> Minimum {
    // 1 / golden ratio.
    const SHRINK: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = if a < b { (a, b) } else { (b, a) };
    let (mut x, mut y) = (b - SHRINK * (b - a), a + SHRINK * (b - a));
    let (mut f_x, mut f_y) = (f(x), f(y));
    // Shrinking from the greatest f64 to the least takes under 3000 steps.
    for _ in 0..3000 {
        if b - a <= tolerance {
            break;
        }
        if f_x < f_y {
            (b, y, f_y) = (y, x, f_x);
            x = b - SHRINK * (b - a);
            f_x = f(x);
        } else {
            (a, x, f_x) = (x, y, f_y);
            y = a + SHRINK * (b - a);
            f_y = f(y);
        }
    }
    if f_x < f_y { Minimum { x, value: f_x } } else { Minimum { x: y, value: f_y } }
}

/// Looks for a minimum near 0 in few evaluations: steps downhill, each twice as long as the one before, until it goes uphill again,
/// then to the vertex of the parabola through the last three points (Brent 1973, chapter 5); `f_0` is the value at 0. Goes no
/// farther than `farthest`. Never worse than where it began, and as exact as a function is a parabola over `step`.
///
/// ```
/// use asami_math::optimise::downhill;
/// let found = downhill(|x| (x - 0.3) * (x - 0.3), 0.09, 0.5, 3.0);
/// assert!((found.x - 0.3).abs() < 1e-12);
/// ```
#[must_use]
pub fn downhill(mut f: impl FnMut(f64) -> f64, f_0: f64, step: f64, farthest: f64) -> Minimum {
    let mut at = |x: f64| Minimum { x, value: f(x) };
    let (mut middle, mut behind, mut ahead) = (Minimum { x: 0.0, value: f_0 }, at(-step), at(step));
    if behind.value < ahead.value {
        std::mem::swap(&mut behind, &mut ahead);
    }
    let mut step = ahead.x;
    while ahead.value < middle.value {
        (behind, middle) = (middle, ahead);
        if middle.x.abs() >= farthest {
            return middle;
        }
        step *= 2.0;
        ahead = at((middle.x + step).clamp(-farthest, farthest));
    }
    let [of_behind, of_ahead] = [behind, ahead].map(|it| (it.x - middle.x, it.value - middle.value));
    // Through the middle: both values there are no less than 0, and their places on either side of it.
    let curvature = of_behind.1 / of_behind.0 - of_ahead.1 / of_ahead.0;
    let slope = of_behind.1 / of_behind.0 * of_ahead.0 - of_ahead.1 / of_ahead.0 * of_behind.0;
    let vertex = middle.x + 0.5 * slope / curvature;
    if !vertex.is_finite() {
        return middle;
    }
    let found = at(vertex);
    if found.value < middle.value { found } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn finds_the_bottom_of_a_valley(bottom in -5.0..5.0f64, steep in 0.1..10.0f64) {
            let found = golden_section(|x| steep * (x - bottom).abs(), -6.0, 7.0, 1e-9);
            prop_assert!((found.x - bottom).abs() < 1e-8);
        }

        /// A parabola's at once; of a valley that is none, a place no worse than the middle, and no farther than it may.
        #[test]
        fn goes_downhill(bottom in -4.0..4.0f64, steep in 0.1..10.0f64, skew in -0.05..0.05f64) {
            let mut evaluations = 0;
            let parabola = |x: f64| steep * (x - bottom) * (x - bottom);
            let counted = |x: f64| {
                evaluations += 1;
                parabola(x)
            };
            let found = downhill(counted, parabola(0.0), 0.5, 3.0);
            let there = if bottom.abs() < 2.0 { (found.x - bottom).abs() < 1e-9 } else { found.x * bottom > 0.0 };
            prop_assert!(there, "{} {bottom}", found.x);
            prop_assert!(found.x.abs() <= 3.0 && evaluations <= 6, "{evaluations}");
            let valley = |x: f64| parabola(x) * (1.0 + skew * x);
            let found = downhill(valley, valley(0.0), 0.5, 3.0);
            prop_assert!(found.value <= valley(0.0) && found.value == valley(found.x));
        }
    }

    #[test]
    fn ends_on_functions_that_are_no_numbers() {
        let _ = golden_section(|_| f64::NAN, 0.0, 1.0, 1e-9);
        let _ = golden_section(|x| x, f64::NEG_INFINITY, f64::INFINITY, 1e-9);
        assert_eq!(downhill(|_| f64::NAN, 1.0, 0.5, 3.0).x, 0.0);
        assert_eq!(downhill(|_| f64::INFINITY, 1.0, 0.5, 3.0).x, 0.0);
        assert_eq!(downhill(|x| x, 0.0, 0.5, 3.0).x, -3.0);
        // A minimum at an end is approached.
        assert!(golden_section(|x| x, 2.0, 3.0, 1e-9).x < 2.0 + 1e-8);
    }
}
