//! The points of a scan, seen from above.

use asami_math::rigid::Rigid;

use crate::drive::{Drive, Scan};
use crate::upright::Upright;

/// No return of a 16-bit range in units of 2 mm comes from farther.
const REACH_M: f64 = 140.0;

/// Which returns of a scan become points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Points lower than this over the sensor are left out: the ground moves with the car.
    pub lowest_m: f64,
    /// Points of surfaces less steep than this, as a tangent, are left out: the ground again, where the car pitches; 0: none are.
    pub least_slope: f64,
    /// Of the points of a square with this side one is kept, the lowest laser's first; 0: all are.
    pub square_m: f64,
}

/// How a sensor moves while a scan is taken, evenly and along a chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Going {
    /// The motion, in the sensor's frame at the moment that points are set back to.
    pub motion: Rigid,
    /// While so many firings pass.
    pub firings: f64,
    /// So many of them before that moment.
    pub before: f64,
}

/// The points of a scan in the sensor's frame, at encoder angle 0 laser l looking along `angles_rad[l]`: each where it was measured or, of a
/// sensor that is `going`, set back to where it would have been seen at one moment.
#[must_use]
pub fn cloud(drive: &Drive<'_>, scan: &Scan, angles_rad: &[f64], cut: &Cut, going: Option<Going>) -> Vec<[f64; 2]> {
    let poses: Vec<[f64; 4]> = going.map_or(Vec::new(), |Going { motion, firings, before }| {
        let pose = |i: usize| {
            let share = (i as f64 - before) / firings.max(1.0);
            let (s, c) = asami_math::elementary::sin_cos(share * motion.turn_rad);
            [s, c, share * motion.x, share * motion.y]
        };
        (0..scan.end - scan.first).map(pose).collect()
    });
    let mut squares = Squares::new(cut.square_m);
    let upright = Upright::new(drive, angles_rad, cut.least_slope);
    let mut points = Vec::new();
    drive.returns(scan, angles_rad, cut.lowest_m, |laser, firing, [x, y, z]| {
        if upright.as_ref().is_some_and(|it| !it.stands(laser, firing, (x * x + y * y).sqrt(), z)) {
            return;
        }
        let point =
            poses.get(firing - scan.first).map_or([x, y], |[s, c, px, py]| [c * x - s * y + px, s * x + c * y + py]);
        if squares.first(point) {
            points.push(point);
        }
    });
    points
}

/// Squares of the plane about the origin, each taken or not.
struct Squares {
    side_m: f64,
    across: usize,
    taken: Vec<u64>,
}

impl Squares {
    fn new(side_m: f64) -> Self {
        if side_m <= 0.0 {
            return Self { side_m: 0.0, across: 0, taken: Vec::new() };
        }
        let side_m = side_m.max(0.02);
        let across = (2.0 * REACH_M / side_m) as usize + 1;
        Self { side_m, across, taken: vec![0; (across * across).div_ceil(64)] }
    }

    /// Takes the square of `point`; whether it was free. Beyond the reach, and without squares, everything is.
    fn first(&mut self, [x, y]: [f64; 2]) -> bool {
        if self.taken.is_empty() {
            return true;
        }
        let place = |v: f64| ((v + REACH_M) / self.side_m).floor();
        let (column, row) = (place(x), place(y));
        let inside = |v: f64| v >= 0.0 && v < self.across as f64;
        if !inside(column) || !inside(row) {
            return true;
        }
        let i = row as usize * self.across + column as usize;
        let free = self.taken[i / 64] & (1 << (i % 64)) == 0;
        self.taken[i / 64] |= 1 << (i % 64);
        free
    }
}
