//! Where a robot is when a log begins: of several places around one of the first landmarks that are reported, the likeliest.

use std::f64::consts::TAU;
use std::ops::Range;

use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, ln, logistic, sin_cos};
use nalgebra::{Matrix3, Vector3};

use crate::filter::{Kalman, UNCOUNTED, Walk};
use crate::memory::Memory;
use crate::shape::{Numbers, Shape, Sight};
use crate::state::Belief;
use crate::view::{Seen, View};

/// Starts tried around a landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ring {
    /// How many.
    starts: usize,
    /// How unsure each of them is, in metres to each side and in radians.
    unsure: f64,
}

/// Where little is known of a sensor.
const WIDE: Ring = Ring { starts: 36, unsure: 0.3 };
/// Where its bearings are known to a hundredth of a radian, a step on the other ring is many standard deviations: no filter takes it as it
/// is.
const CLOSE: Ring = Ring { starts: 180, unsure: 0.1 };
/// So many of the likeliest are tried on so many times as many steps: a filter that took its first sightings in too boldly is lost later.
const FINALISTS: usize = 12;
const LONG: usize = 5;
/// Any of so many sightings may be the first that is not of something else.
const ANCHORS: usize = 8;
/// Each start is tried on so many sightings,
const TRIED: usize = 60;
/// of which so many are not of the landmark that is seen most: from it alone nobody knows where around it a robot is;
const OF_OTHERS: usize = 20;
/// but on no more than so many.
const TRIED_AT_MOST: usize = 1000;

/// Where a robot is, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The step of the view.
    pub begin: usize,
    /// The pose.
    pub belief: Belief,
}

/// A start that was tried.
struct Tried {
    start: Start,
    /// How likely what is seen before it is, as it was of something else.
    passed: f64,
    /// The same with what is seen from it on, in so many sightings as are tried.
    likely: f64,
}

impl Start {
    /// The likeliest under a response.
    #[must_use]
    pub fn find(shape: &Shape, numbers: &[f64], view: &View) -> Self {
        let (memory, kalman) = (Memory::default(), Kalman::Extended);
        let walk = Walk { shape, numbers, memory, view, counted: UNCOUNTED, kalman };
        let (tried, _) = tried(&walk, &[WIDE]);
        tried.into_iter().reduce(likelier).map_or_else(Self::anywhere, |it| it.start)
    }

    /// The likeliest under a response that is known so well that a step on the usual ring is many standard deviations, and whose noise
    /// hangs together like this: also of starts closer to one another, and of the likeliest of all that which is so in the long run.
    #[must_use]
    pub fn closely(shape: &Shape, numbers: &[f64], memory: Memory, view: &View) -> Self {
        let walk = Walk { shape, numbers, memory, view, counted: UNCOUNTED, kalman: Kalman::Invariant };
        let (mut tried, steps) = tried(&walk, &[WIDE, CLOSE]);
        tried.sort_by(|a, b| b.likely.total_cmp(&a.likely));
        let last = (steps.start + LONG * steps.len()).min(view.steps.len());
        let in_the_long_run = tried.into_iter().take(FINALISTS).map(|it| {
            let likely = it.passed + walk.filter(it.start.begin..last, &mut it.start.belief.clone()).total(0);
            Tried { likely, ..it }
        });
        in_the_long_run.reduce(likelier).map_or_else(Self::anywhere, |it| it.start)
    }

    /// Of a log in which nothing is seen.
    fn anywhere() -> Self {
        Self { begin: 0, belief: seen_towards(0.0, ([0.0; 2], 1.0), 0.0, true, WIDE.unsure) }
    }
}

/// The first of the likelier ones.
fn likelier(a: Tried, b: Tried) -> Tried {
    if b.likely > a.likely { b } else { a }
}

/// Starts around the first landmarks that are reported, and the steps that they were tried on.
fn tried(walk: &Walk<'_>, rings: &[Ring]) -> (Vec<Tried>, Range<usize>) {
    let Walk { shape, numbers, view, .. } = *walk;
    let Some(first) = view.steps.iter().position(|step| !step.seen.is_empty()) else { return (Vec::new(), 0..0) };
    let seen = view.steps[first].seen.start;
    let mut of_each = vec![0; view.landmarks.len()];
    let before = view.steps[first..].iter().take_while(|step| {
        view.seen[step.seen.clone()].iter().for_each(|seen| of_each[seen.landmark] += 1);
        !tell(&of_each)
    });
    let last = first + before.count();
    let (mut tried, mut passed) = (Vec::new(), 0.0);
    for begin in (first..last.max(first + 1)).take_while(|i| view.steps[*i].seen.start < seen + ANCHORS) {
        let step = &view.steps[begin];
        for anchor in step.seen.clone() {
            let all = rings.iter().flat_map(|ring| around(shape, numbers, view, &view.seen[anchor], *ring));
            tried.extend(all.map(|belief| {
                let likely = passed + walk.filter(begin..last, &mut belief.clone()).total(0);
                Tried { start: Start { begin, belief }, passed, likely }
            }));
        }
        passed += step.seen.clone().fold(0.0, |sum, i| sum + ln_of_another(shape, numbers, view, begin, i));
    }
    (tried, first..last)
}

/// Whether so many sightings of each landmark tell starts apart, or are enough to try.
fn tell(of_each: &[usize]) -> bool {
    let all: usize = of_each.iter().sum();
    let most = of_each.iter().copied().max().unwrap_or(0);
    all >= TRIED && (of_each.len() == 1 || all - most >= OF_OTHERS || all >= TRIED_AT_MOST)
}

/// How likely a sighting of something else is.
fn ln_of_another(shape: &Shape, numbers: &[f64], view: &View, step: usize, seen: usize) -> f64 {
    let share = logistic(numbers[shape.range(Numbers::False).start]);
    let Seen { size, bearing_rad, .. } = view.seen[seen];
    ln(share * shape.elsewhere(size, view.off_rad(view.steps[step].pan_rad, bearing_rad)))
}

/// The poses from which a landmark is where it is reported; before a single landmark they are all the same.
fn around(shape: &Shape, numbers: &[f64], view: &View, seen: &Seen, ring: Ring) -> Vec<Belief> {
    let distance_m = distance(shape, &numbers[shape.range(Numbers::Size)], seen.size);
    let at = view.landmarks[seen.landmark];
    let only = view.landmarks.len() == 1;
    let turns = if only { 1 } else { ring.starts };
    let turn = |i: usize| TAU * i as f64 / ring.starts as f64;
    let sensor = |i: usize| seen_towards(turn(i), (at, distance_m), seen.bearing_rad, only, ring.unsure);
    (0..turns).map(|i| seen_from(view, sensor(i))).collect()
}

/// The pose from which a landmark in direction `towards_rad` of the world stands at a distance and a bearing.
fn seen_towards(
    towards_rad: f64,
    ([x_m, y_m], distance_m): ([f64; 2], f64),
    bearing_rad: f64,
    only: bool,
    unsure: f64,
) -> Belief {
    let (sin, cos) = sin_cos(towards_rad);
    let mean = Vector3::new(x_m + distance_m * sin, y_m - distance_m * cos, wrap_rad(towards_rad - bearing_rad));
    // Across the line of sight a pose before a single landmark is a matter of naming.
    let (along, across) = (unsure * unsure, if only { 1e-8 } else { unsure * unsure });
    let ray = Vector3::new(-sin, cos, 0.0);
    let side = Vector3::new(cos, sin, 0.0);
    let heading = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, unsure * unsure));
    Belief { mean, covariance: along * ray * ray.transpose() + across * side * side.transpose() + heading }
}

/// The body's pose, given the sensor's.
fn seen_from(view: &View, sensor: Belief) -> Belief {
    let ([x_m, y_m], _) = view.out(sensor.mean.z);
    Belief { mean: sensor.mean - Vector3::new(x_m, y_m, 0.0), ..sensor }
}

/// The distance at which the size's curve comes nearest to a size.
#[must_use]
pub fn distance(shape: &Shape, numbers: &[f64], size: f64) -> f64 {
    let [near_m, far_m] = shape.near_far_m;
    let (mut columns, mut slopes) = (vec![0.0; numbers.len()], [0.0; 4]);
    let mut off = |distance_m: f64| {
        let sight = Sight {
            distance_m,
            bearing_rad: 0.0,
            off_rad: 0.0,
            pan_rad_per_s: 0.0,
            theta_rad: atan2(0.0, 1.0),
            landmark: 0,
            attempt: [0.0; 3],
        };
        shape.size_columns(&sight, &mut columns, &mut slopes);
        let curve = shape.curve_width();
        let expected = columns[..curve].iter().zip(numbers).fold(0.0, |sum, (a, b)| sum + a * b);
        (expected - size).abs()
    };
    let places = (0..=200).map(|i| near_m * 0.7 + (far_m * 1.3 - near_m * 0.7) * f64::from(i) / 200.0);
    let scored = places.map(|distance_m| (off(distance_m), distance_m));
    scored.reduce(|a, b| if b.0 < a.0 { b } else { a }).map_or(near_m, |(_, distance_m)| distance_m)
}
