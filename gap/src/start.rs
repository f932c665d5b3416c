//! Where a robot is when a log begins: of several places around one of the first landmarks that are reported, the likeliest.

use std::f64::consts::TAU;

use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, ln, logistic, sin_cos};
use nalgebra::{Matrix3, Vector3};

use crate::filter::{UNCOUNTED, Walk};
use crate::memory::Memory;
use crate::shape::{Numbers, Shape, Sight};
use crate::state::Belief;
use crate::view::{Seen, View};

/// Starts tried around a landmark.
const STARTS: usize = 36;
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

impl Start {
    /// The likeliest under a response.
    #[must_use]
    pub fn find(shape: &Shape, numbers: &[f64], view: &View) -> Self {
        let anywhere = Self { begin: 0, belief: ring(0.0, [0.0; 2], 1.0, 0.0, true) };
        let Some(first) = view.steps.iter().position(|step| !step.seen.is_empty()) else { return anywhere };
        let seen = view.steps[first].seen.start;
        let mut of_each = vec![0; view.landmarks.len()];
        let before = view.steps[first..].iter().take_while(|step| {
            view.seen[step.seen.clone()].iter().for_each(|seen| of_each[seen.landmark] += 1);
            !tell(&of_each)
        });
        let last = first + before.count();
        let walk = Walk { shape, numbers, memory: Memory::default(), view, counted: UNCOUNTED };
        let mut best: Option<(f64, Self)> = None;
        // What is seen before a start was of something else.
        let mut passed = 0.0;
        for begin in (first..last.max(first + 1)).take_while(|i| view.steps[*i].seen.start < seen + ANCHORS) {
            let step = &view.steps[begin];
            for anchor in step.seen.clone() {
                for belief in around(shape, numbers, view, &view.seen[anchor]) {
                    let likely = passed + walk.filter(begin..last, &mut belief.clone()).total(0);
                    if best.as_ref().is_none_or(|(most, _)| likely > *most) {
                        best = Some((likely, Self { begin, belief }));
                    }
                }
            }
            passed += step.seen.clone().fold(0.0, |sum, i| sum + ln_of_another(shape, numbers, view, begin, i));
        }
        best.map_or(anywhere, |(_, start)| start)
    }
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
fn around(shape: &Shape, numbers: &[f64], view: &View, seen: &Seen) -> Vec<Belief> {
    let distance_m = distance(shape, &numbers[shape.range(Numbers::Size)], seen.size);
    let at = view.landmarks[seen.landmark];
    let only = view.landmarks.len() == 1;
    let turns = if only { 1 } else { STARTS };
    let turn = |i: usize| TAU * i as f64 / STARTS as f64;
    (0..turns).map(|i| seen_from(view, ring(turn(i), at, distance_m, seen.bearing_rad, only))).collect()
}

/// The pose from which a landmark in direction `towards_rad` of the world stands at a distance and a bearing.
fn ring(towards_rad: f64, [x_m, y_m]: [f64; 2], distance_m: f64, bearing_rad: f64, only: bool) -> Belief {
    let (sin, cos) = sin_cos(towards_rad);
    let mean = Vector3::new(x_m + distance_m * sin, y_m - distance_m * cos, wrap_rad(towards_rad - bearing_rad));
    // Across the line of sight a pose before a single landmark is a matter of naming.
    let (along, across) = (0.09, if only { 1e-8 } else { 0.09 });
    let ray = Vector3::new(-sin, cos, 0.0);
    let side = Vector3::new(cos, sin, 0.0);
    let heading = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, 0.09));
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
