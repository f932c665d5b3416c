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
