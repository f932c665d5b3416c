//! In which ways the response of a robot among landmarks may change, by flexible block.

use asami_math::elementary::exp;

use crate::columns::Group;
use crate::shape::{CHANGING, Numbers, Shape};

/// A way in which a response may change: what is added to its numbers for one prior standard deviation.
pub type Direction = Vec<f64>;

/// A landmark that does not stand where it is said to is off by about so much.
const MOVED_M: f64 = 0.15;

/// The directions of a block about a response.
#[must_use]
pub fn directions(shape: &Shape, numbers: &[f64], block: &str) -> Vec<Direction> {
    let mut made = Making { shape, numbers, made: Vec::new() };
    match block {
        "static_motion" => made.static_motion(),
        "timing" => made.timing(),
        "drift" => made.drift(),
        "sensor" => made.sensor(),
        "noise" => made.noise(),
        _ => {}
    }
    made.made
}

struct Making<'a> {
    shape: &'a Shape,
    numbers: &'a [f64],
    made: Vec<Direction>,
}

impl Making<'_> {
    fn push(&mut self, changes: impl IntoIterator<Item = (usize, f64)>) {
        let mut direction = vec![0.0; self.numbers.len()];
        for (i, change) in changes {
            direction[i] += change;
        }
        if direction.iter().any(|it| *it != 0.0) {
            self.made.push(direction);
        }
    }

    /// Indices of an axis's motion numbers of a group.
    fn motion(&self, axis: usize, group: Group) -> std::ops::Range<usize> {
        let range = self.shape.columns.range(group);
        let at = axis * self.shape.columns.len();
        at + range.start..at + range.end
    }

    /// Greatest velocity of an axis.
    fn greatest(&self, axis: usize) -> f64 {
        self.numbers[self.motion(axis, Group::Curve)].iter().fold(0.0, |most, it| f64::max(most, it.abs()))
    }

    /// Shares of each axis's own velocity and of the others', a velocity while moving, a bend, a slope.
    fn static_motion(&mut self) {
        for axis in 0..3 {
            let greatest = self.greatest(axis);
            for from in 0..3 {
                let unit = 0.15 * if self.greatest(from) > 0.0 { greatest / self.greatest(from) } else { 0.0 };
                let pairs = self.motion(axis, Group::Curve).zip(self.motion(from, Group::Curve));
                let changes: Vec<_> = pairs.map(|(i, j)| (i, unit * self.numbers[j])).collect();
                self.push(changes);
            }
            let of = self.motion(axis, Group::Curve);
            let moving: Vec<_> = of.clone().map(|i| (i, 0.05 * greatest)).collect();
            self.push(moving);
            let bend = |i: usize| 0.2 * self.numbers[i] * (self.numbers[i].abs() / greatest.max(1e-9));
            let bends: Vec<_> = of.map(|i| (i, bend(i))).collect();
            self.push(bends);
            for column in self.shape.columns.in_turns().into_iter().flatten() {
                self.push([(axis * self.shape.columns.len() + column, 0.3 * greatest)]);
            }
            if self.shape.columns.heading {
                for i in self.motion(axis, Group::Heading).skip(2) {
                    self.push([(i, 0.05 * greatest)]);
                }
            }
        }
    }

    /// What lingers of each axis's own command, by age; how strongly a heading is held; and sensing that is late.
    fn timing(&mut self) {
        let ages = self.shape.columns.width(Group::Lingering) / 3;
        for age in 0..ages {
            let changes: Vec<_> = (0..3)
                .map(|axis| (self.motion(axis, Group::Lingering).start + 3 * age + axis, 0.3 * self.greatest(axis)))
                .collect();
            self.push(changes);
            let starts = self.starts(age);
            self.push(starts);
        }
        for axis in 0..3 {
            let held: Vec<_> = self.motion(axis, Group::Held).map(|i| (i, 0.3 * self.numbers[i])).collect();
            self.push(held);
        }
        let bearing = self.shape.range(Numbers::Bearing).start;
        self.push([(bearing + 3, 0.05)]);
        self.push([(bearing + 4, 0.05 * self.greatest(2))]);
    }

    /// Of a base on wheels, how much slower it is than it is told where it stood so long ago.
    fn starts(&self, age: usize) -> Option<(usize, f64)> {
        let (axis, column) = self.shape.columns.started(age)?;
        Some((axis * self.shape.columns.len() + column, -0.3 * self.greatest(axis)))
    }

    /// Each axis's velocity, growing with time.
    fn drift(&mut self) {
        for axis in 0..3 {
            let start = self.motion(axis, Group::Wear).start;
            self.push([(start + axis, 0.15 * self.greatest(axis))]);
            self.push([(start + 3 + axis, 0.15 * self.greatest(axis))]);
            self.push([(start + 6, 0.05 * self.greatest(axis))]);
        }
    }

    /// Both curves, in units of twice their own noise.
    fn sensor(&mut self) {
        let size = self.shape.range(Numbers::Size);
        let bearing = self.shape.range(Numbers::Bearing);
        let sd = |group: Numbers| 2.0 * exp(self.numbers[self.shape.range(group).start]);
        let (of_size, of_bearing) = (sd(Numbers::SizeNoise), sd(Numbers::BearingNoise));
        let curve = self.shape.curve_width();
        let scaled: Vec<_> = (0..curve).map(|i| (size.start + i, 0.1 * self.numbers[size.start + i])).collect();
        self.push(scaled);
        for i in 0..2 {
            self.push([(size.start + i, of_size)]);
        }
        let off_axis = self.shape.off_rad * self.shape.off_rad * self.shape.off_scale(self.shape.middle_m());
        self.push([(size.start + curve, of_size / off_axis.max(1e-6))]);
        self.push([(size.start + curve + 1, of_size)]);
        if self.shape.ranges {
            self.push([(size.start + curve + 3, of_size / self.shape.middle_m())]);
        }
        let off = self.shape.off_rad.max(1e-3);
        self.push([(bearing.start, of_bearing)]);
        self.push([(bearing.start + 1, of_bearing / off)]);
        self.push([(bearing.start + 2, of_bearing / (off * off * off))]);
        self.push([(bearing.start + 5, of_bearing)]);
        for i in self.shape.range(Numbers::Moved) {
            self.push([(i, MOVED_M)]);
        }
    }

    /// Sizes of all noise, false sightings, misses.
    fn noise(&mut self) {
        let all = |group: Numbers, change: f64| {
            let range = self.shape.range(group);
            range.map(move |i| (i, change)).collect::<Vec<_>>()
        };
        let motion = self.shape.range(Numbers::MotionNoise).start;
        let made = [
            all(Numbers::SizeNoise, 0.3),
            all(Numbers::BearingNoise, 0.3),
            all(Numbers::False, 4.0),
            all(Numbers::Detection, 1.0),
        ];
        for changes in made {
            self.push(changes);
        }
        for axis in 0..3 {
            self.push((0..=CHANGING).map(|class| (motion + 3 * class + axis, 0.6)));
        }
    }
}
