//! Elementary functions that give the same bits on every processor.
//!
//! The standard library's transcendental functions dispatch to the platform's, which may or may not
//! use fused operations. Code whose bits matter calls these instead.

pub use libm::{acos, asin, atan, atan2, cos, erfc, exp, hypot, lgamma, log as ln, log1p as ln_1p, pow, sin, tan};

/// `(sin, cos)` of an angle in radians.
#[must_use]
pub fn sin_cos(angle_rad: f64) -> (f64, f64) {
    libm::sincos(angle_rad)
}

/// The share that has odds of this logarithm.
#[must_use]
pub fn logistic(log_odds: f64) -> f64 {
    1.0 / (1.0 + exp(-log_odds))
}

/// The logarithm of a share's odds; [`logistic`]'s inverse.
#[must_use]
pub fn logit(share: f64) -> f64 {
    ln(share / (1.0 - share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_their_log_odds_are_each_other_s_inverse() {
        for share in [1e-9, 0.02, 0.5, 0.75, 1.0 - 1e-9] {
            assert!((logistic(logit(share)) / share - 1.0).abs() < 1e-12, "{share}");
        }
        assert!((logit(0.75) - 3.0_f64.ln()).abs() < 1e-15);
        assert_eq!([logistic(-1e3), logistic(1e3)], [0.0, 1.0]);
    }
}
