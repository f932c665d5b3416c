//! Rigid motions of the plane.

use crate::elementary::sin_cos;

/// A turn followed by a shift: `p -> R(turn) p + (x, y)`. As a pose: where a frame sits in another, and how it is turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rigid {
    /// Counter-clockwise, radians.
    pub turn_rad: f64,
    /// Shift along x.
    pub x: f64,
    /// Shift along y.
    pub y: f64,
}

impl Rigid {
    /// Where `point` goes.
    #[must_use]
    pub fn apply(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = rotate(self.turn_rad, point);
        [x + self.x, y + self.y]
    }

    /// `first`, then this one.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let [x, y] = self.apply([first.x, first.y]);
        Self { turn_rad: self.turn_rad + first.turn_rad, x, y }
    }

    /// The motion that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let [x, y] = rotate(-self.turn_rad, [-self.x, -self.y]);
        Self { turn_rad: -self.turn_rad, x, y }
    }

    /// This motion or, if that is not finite, none at all.
    #[must_use]
    pub fn or_none(self) -> Self {
        if [self.turn_rad, self.x, self.y].iter().all(|v| v.is_finite()) { self } else { Self::default() }
    }
}

/// `vector` turned counter-clockwise.
#[must_use]
pub fn rotate(turn_rad: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (s, c) = sin_cos(turn_rad);
    [c * x - s * y, s * x + c * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn motions_compose_and_undo(a in proptest::array::uniform3(-3.0..3.0f64), b in proptest::array::uniform3(-3.0..3.0f64), p in proptest::array::uniform2(-9.0..9.0f64)) {
            let motion = |[turn_rad, x, y]: [f64; 3]| Rigid { turn_rad, x, y };
            let (a, b) = (motion(a), motion(b));
            let near = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() < 1e-12 && (p[1] - q[1]).abs() < 1e-12;
            prop_assert!(near(a.after(&b).apply(p), a.apply(b.apply(p))));
            prop_assert!(near(a.inverse().apply(a.apply(p)), p));
            prop_assert!(near(a.after(&a.inverse()).apply(p), p));
        }
    }

    #[test]
    fn a_quarter_turn_takes_x_to_y() {
        let [x, y] = rotate(std::f64::consts::FRAC_PI_2, [2.0, 0.0]);
        assert!(x.abs() < 1e-15 && (y - 2.0).abs() < 1e-15);
    }
}
