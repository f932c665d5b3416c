//! What the numbers of a response mean: which of them is what, and what each is multiplied with.

use std::f64::consts::{FRAC_PI_2, TAU};

use asami_math::elementary::{cos, sin, sin_cos};
use serde::{Deserialize, Serialize};

use crate::columns::{Attempt, Columns};

/// Classes of attempted speed, each with motion noise of its own: standing, slow, fast.
pub const SPEEDS: usize = 3;
/// The first of them.
pub const STANDING: usize = 0;
/// After those classes comes what is added while commands change, for as much as they do.
pub const CHANGING: usize = SPEEDS;
/// Attempts from this share of the greatest on are fast.
const FAST: f64 = 0.5;
/// Bands of distance, each with sensor noise of its own.
pub const BANDS: usize = 3;
/// Bins of distance in which the share of landmarks seen is counted.
const FAR_BINS: usize = 4;
/// Bins of the angle off the image's centre, the same.
const OFF_BINS: usize = 8;

/// Columns of the bearing that every sensor has; a scanner has one more.
const OF_ANY_BEARING: usize = 6;

/// Share of sightings of something else that are not even in view, or of a size that nothing has.
const ANYTHING: f64 = 0.05;

/// The bins reach so much further than where nearly all are seen, so that what lies just outside is counted too.
const OFF_REACH: f64 = 1.3;

/// The layout of a response's numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Of motion.
    pub columns: Columns,
    /// How many landmarks there are.
    pub landmarks: usize,
    /// Whether sizes are ranges in metres; heights in pixels else.
    pub ranges: bool,
    /// Between these distances landmarks are seen, in metres.
    pub near_far_m: [f64; 2],
    /// Nearly all are seen within this angle of the image's centre.
    pub off_rad: f64,
    /// Least and greatest size.
    pub sizes: [f64; 2],
    /// How likely a given landmark is reported in a given frame.
    pub reported: f64,
}

/// A landmark from where the robot stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Distance from the body's centre.
    pub distance_m: f64,
    /// Counter-clockwise from straight ahead.
    pub bearing_rad: f64,
    /// Counter-clockwise from where the head looks.
    pub off_rad: f64,
    /// How fast the head turns.
    pub pan_rad_per_s: f64,
    /// The robot's heading.
    pub theta_rad: f64,
    /// Index of the landmark.
    pub landmark: usize,
    /// Velocities attempted, in shares of the greatest.
    pub attempt: Attempt,
}

/// Groups of numbers, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Displacements in m/s and rad/s for each column: all rightward ones, all forward ones, all turns.
    Motion,
    /// Logarithms of the displacements' variances in one second: by class of speed, then while commands change, then axis.
    MotionNoise,
    /// The size for each of its columns.
    Size,
    /// What is added to the true bearing, for each of its columns.
    Bearing,
    /// By how much each landmark stands elsewhere than it is said to: world x and y.
    Moved,
    /// Logarithms of the sizes' standard deviations, by band of distance.
    SizeNoise,
    /// Logarithms of the bearings' standard deviations, by band of distance.
    BearingNoise,
    /// Log-odds of a sighting that is of something else.
    False,
    /// Log-odds of being seen, by bin of distance and angle.
    Detection,
}

/// All groups.
pub const ORDER: [Numbers; 9] = [
    Numbers::Motion,
    Numbers::MotionNoise,
    Numbers::Size,
    Numbers::Bearing,
    Numbers::Moved,
    Numbers::SizeNoise,
    Numbers::BearingNoise,
    Numbers::False,
    Numbers::Detection,
];

impl Shape {
    /// How many numbers a group has.
    #[must_use]
    pub fn width(&self, group: Numbers) -> usize {
        match group {
            Numbers::Motion => 3 * self.columns.len(),
            Numbers::MotionNoise => 3 * (CHANGING + 1),
            Numbers::Size => self.curve_width() + 3 + usize::from(self.ranges),
            Numbers::Bearing => OF_ANY_BEARING + usize::from(self.scans()),
            // Of a single landmark the place cannot be told from the robot's own.
            Numbers::Moved if self.landmarks > 1 => 2 * self.landmarks,
            Numbers::Moved => 0,
            Numbers::SizeNoise | Numbers::BearingNoise => BANDS,
            Numbers::False => 1,
            Numbers::Detection => FAR_BINS * OFF_BINS,
        }
    }

    /// Where a group's numbers are.
    #[must_use]
    pub fn range(&self, group: Numbers) -> std::ops::Range<usize> {
        let start = ORDER.iter().take_while(|it| **it != group).map(|it| self.width(*it)).sum::<usize>();
        start..start + self.width(group)
    }

    /// How many numbers there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.range(Numbers::Detection).end
    }

    /// Never: there is always a sensor.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// How many of the size's columns are its curve in the distance.
    #[must_use]
    pub fn curve_width(&self) -> usize {
        if self.ranges { 3 } else { 4 }
    }

    /// By how much a landmark stands elsewhere, by these numbers.
    #[must_use]
    pub fn moved(&self, numbers: &[f64], landmark: usize) -> [f64; 2] {
        let at = self.range(Numbers::Moved).start + 2 * landmark;
        // A log may have more of them than the nominal world.
        let known = self.landmarks > 1 && landmark < self.landmarks;
        if known { [numbers[at], numbers[at + 1]] } else { [0.0; 2] }
    }

    /// Of ranges, the size's column that is the distance, and those of what is off by a share of it; `None` of heights.
    #[must_use]
    pub fn proportional(&self) -> Option<(usize, impl Iterator<Item = usize> + use<>)> {
        let extra = self.curve_width();
        self.ranges.then_some((1, [2, extra, extra + 3].into_iter()))
    }

    /// Fills the size's columns, and their derivatives with respect to the distance for those of its curve.
    pub fn size_columns(&self, sight: &Sight, columns: &mut [f64], slopes: &mut [f64; 4]) {
        columns.fill(0.0);
        let d = sight.distance_m.max(0.05);
        // A height falls as 1/d, and so does what moves it.
        let fall = if self.ranges {
            columns[..3].copy_from_slice(&[1.0, d, d * d]);
            *slopes = [0.0, 1.0, 2.0 * d, 0.0];
            1.0
        } else {
            let x = 1.0 / d;
            columns[..4].copy_from_slice(&[1.0, x, x * x, d]);
            *slopes = [0.0, -x * x, -2.0 * x * x * x, 1.0];
            x * x
        };
        let (sin_b, cos_b) = sin_cos(sight.bearing_rad);
        let [right, forward, turn] = sight.attempt;
        let extra = self.curve_width();
        let off = self.inside(sight.off_rad);
        columns[extra] = self.off_square(off)[0] * self.off_scale(d);
        columns[extra + 1] = (right * right + forward * forward + turn * turn).sqrt();
        columns[extra + 2] = fall * (forward * cos_b - right * sin_b);
        if self.ranges {
            columns[extra + 3] = d * sin_b;
        }
    }

    /// Columns, the size's first and then the bearing's, that hang on the angle off the image's centre, with how large their
    /// numbers may be nominally: a head that follows a landmark sees next to nothing of them.
    #[must_use]
    pub fn off_columns(&self) -> [(usize, f64); 3] {
        let bearing = self.width(Numbers::Size);
        let of_size = if self.ranges { 1.0 } else { 10.0 / self.off_scale(self.middle_m()) };
        [(self.curve_width(), of_size), (bearing + 1, 0.05), (bearing + 2, 0.5)]
    }

    /// Halfway between the distances at which landmarks are seen.
    #[must_use]
    pub fn middle_m(&self) -> f64 {
        0.5 * (self.near_far_m[0] + self.near_far_m[1])
    }

    /// What goes with the square of the angle off the axis: a range, and a depth that is taken for one, part in proportion to
    /// the distance, and a lens bends a height by a share of it.
    #[must_use]
    pub fn off_scale(&self, distance_m: f64) -> f64 {
        if self.ranges { distance_m } else { 1.0 / distance_m }
    }

    /// Fills the bearing's columns.
    pub fn bearing_columns(&self, sight: &Sight, columns: &mut [f64]) {
        columns.fill(0.0);
        let d = sight.distance_m.max(0.05);
        let off = self.inside(sight.off_rad);
        let of_any: [f64; OF_ANY_BEARING] =
            [1.0, off, off * off * off, sight.pan_rad_per_s, sight.attempt[2], sin(sight.bearing_rad) / d];
        let (any, of_scanner) = columns.split_at_mut(OF_ANY_BEARING);
        any.copy_from_slice(&of_any);
        // What an angle encoder is off comes again with each turn.
        of_scanner.fill(1.0 - cos(off));
    }

    /// Whether the sensor sees beyond right angles, as no camera does.
    fn scans(&self) -> bool {
        self.off_rad > FRAC_PI_2
    }

    /// By how much the bearing that is read, and the size, change with the bearing, beyond the bearing itself.
    #[must_use]
    pub fn off_slopes(&self, sight: &Sight, size: &[f64], bearing: &[f64]) -> [f64; 2] {
        let off = self.inside(sight.off_rad);
        if off != sight.off_rad {
            return [0.0; 2];
        }
        let of_turn = bearing.get(OF_ANY_BEARING).map_or(0.0, |it| it * sin(off));
        let of_bearing = bearing[1] + 3.0 * off * off * bearing[2] + of_turn;
        let (d, extra) = (sight.distance_m.max(0.05), self.curve_width());
        let of_skew = if self.ranges { d * cos(sight.bearing_rad) * size[extra + 3] } else { 0.0 };
        [self.off_square(off)[1] * self.off_scale(d) * size[extra] + of_skew, of_bearing]
    }

    /// The square of an angle off the axis, as far as a lens or a depth makes it one, and its slope: a depth falls short of a range
    /// by twice what the cosine does of 1.
    fn off_square(&self, off_rad: f64) -> [f64; 2] {
        if !self.ranges {
            return [off_rad * off_rad, 2.0 * off_rad];
        }
        let (sin, cos) = sin_cos(off_rad);
        [2.0 * (1.0 - cos), 2.0 * sin]
    }

    /// The density of sightings of something else, which may be anywhere in view, as far away as anything;
    /// now and then it is anything at all.
    #[must_use]
    pub fn elsewhere(&self, size: f64, off_rad: f64) -> f64 {
        let [least, greatest] = [self.sizes[0] * 0.8, self.sizes[1] * 1.25];
        let anything = 0.5 / ((greatest - least).max(1e-9) * TAU);
        let within = (least..=greatest).contains(&size) && off_rad.abs() <= OFF_REACH * self.off_rad;
        // Places spread evenly over distances have heights that crowd at the small end.
        let by_size = if self.ranges {
            1.0 / (greatest - least).max(1e-9)
        } else {
            1.0 / ((1.0 / least - 1.0 / greatest).max(1e-9) * size * size)
        };
        let in_view = if within { by_size / (2.0 * OFF_REACH * self.off_rad).max(1e-9) } else { 0.0 };
        (1.0 - ANYTHING) * in_view + ANYTHING * anything
    }

    /// An angle off the image's centre as the curves take it: far outside of the image a cubic says nothing.
    fn inside(&self, off_rad: f64) -> f64 {
        let reach = OFF_REACH * self.off_rad;
        off_rad.clamp(-reach, reach)
    }

    /// The angle off the image's centre at which a landmark is read there, by these numbers of the bearing: whether it is
    /// in the image hangs on that.
    #[must_use]
    pub fn off_read(&self, sight: &Sight, bearing: &[f64], columns: &mut [f64]) -> f64 {
        self.bearing_columns(sight, columns);
        columns.iter().zip(bearing).fold(sight.off_rad, |sum, (column, number)| sum + column * number)
    }

    /// Which band of distance.
    #[must_use]
    pub fn band(&self, distance_m: f64) -> usize {
        let [near_m, far_m] = self.near_far_m;
        let share = (distance_m - near_m) / (far_m - near_m).max(1e-9);
        ((share * BANDS as f64).clamp(0.0, BANDS as f64 - 1.0)) as usize
    }

    /// The two bands between whose middles a distance lies, with weights that add up to 1; outside of all, the nearest.
    #[must_use]
    pub fn between_bands(&self, distance_m: f64) -> [(usize, f64); 2] {
        let [near_m, far_m] = self.near_far_m;
        let share = (distance_m - near_m) / (far_m - near_m).max(1e-9);
        let from_first = (share * BANDS as f64 - 0.5).clamp(0.0, BANDS as f64 - 1.0);
        let below = (from_first as usize).min(BANDS - 2);
        let above = from_first - below as f64;
        [(below, 1.0 - above), (below + 1, above)]
    }

    /// Which bin of the shares seen; `None` where a landmark is not expected to be seen at all.
    #[must_use]
    pub fn bin(&self, distance_m: f64, off_rad: f64) -> Option<usize> {
        let [far, off] = self.in_bins(distance_m, off_rad);
        let within = (0.0..FAR_BINS as f64).contains(&far) && off < OFF_BINS as f64;
        within.then(|| far as usize * OFF_BINS + off as usize)
    }

    /// Whether nothing at such an angle off the image's centre is ever seen.
    #[must_use]
    pub fn is_beyond(&self, off_rad: f64) -> bool {
        off_rad >= OFF_REACH * self.off_rad
    }

    /// The four bins between whose middles a place lies, with weights that add up to 1; outside of all, the nearest.
    #[must_use]
    pub fn bins(&self, distance_m: f64, off_rad: f64) -> [(usize, f64); 4] {
        let [far, off] = self.in_bins(distance_m, off_rad);
        let far = (far - 0.5).clamp(0.0, FAR_BINS as f64 - 1.0);
        let off = (off - 0.5).clamp(0.0, OFF_BINS as f64 - 1.0);
        let (i, j) = ((far as usize).min(FAR_BINS - 2), (off as usize).min(OFF_BINS - 2));
        let (a, b) = (far - i as f64, off - j as f64);
        let at = |i: usize, j: usize| i * OFF_BINS + j;
        [
            (at(i, j), (1.0 - a) * (1.0 - b)),
            (at(i, j + 1), (1.0 - a) * b),
            (at(i + 1, j), a * (1.0 - b)),
            (at(i + 1, j + 1), a * b),
        ]
    }

    /// Distance and angle in widths of bins.
    fn in_bins(&self, distance_m: f64, off_rad: f64) -> [f64; 2] {
        let [near_m, far_m] = self.near_far_m;
        let far = (distance_m - near_m) / (far_m - near_m).max(1e-9) * FAR_BINS as f64;
        [far, off_rad.abs() / (OFF_REACH * self.off_rad.max(1e-9)) * OFF_BINS as f64]
    }
}

/// Which class of speed.
#[must_use]
pub fn speed_class(attempt: Attempt) -> usize {
    let speed = attempt.iter().fold(0.0, |sum, u| sum + u * u).sqrt();
    usize::from(speed > 1e-6) + usize::from(speed >= FAST)
}
