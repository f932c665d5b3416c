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
    }

    #[test]
    fn ends_on_functions_that_are_no_numbers() {
        let _ = golden_section(|_| f64::NAN, 0.0, 1.0, 1e-9);
        let _ = golden_section(|x| x, f64::NEG_INFINITY, f64::INFINITY, 1e-9);
        // A minimum at an end is approached.
        assert!(golden_section(|x| x, 2.0, 3.0, 1e-9).x < 2.0 + 1e-8);
    }
}
