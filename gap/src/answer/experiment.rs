//! What to record next: of several ways to drive the robot, the one that best splits what a log leaves tied.
//!
//! Two causes part by `J` nats in a log. Of all courses the one is chosen with the least sum over the tied causes' pairs of
//! `sqrt(p_i p_j) exp(-J_ij / 4)`, the bound on the chance of taking one for the other (Bhattacharyya 1943) where their
//! predictions differ in the mean.

use asami_dataset::Log;
use asami_math::elementary::exp;

use crate::judge::Judge;
use crate::library::Responds;
use crate::weigh::evidence::Weighed;
use crate::weigh::groups::{SPLIT_NATS, apart, signatures};

/// A way to drive the robot.
#[derive(Clone, Debug)]
pub struct Course {
    /// What is done, in words.
    pub words: String,
    /// The keys of the scenario that make it do so, as `table.key = value`.
    pub keys: String,
    /// A log of the nominal world, so driven.
    pub log: Log,
}

/// Courses that may be driven next; they are only asked for where something is tied.
pub trait Courses: Sync {
    /// All of them, with logs as long as the one that is diagnosed.
    fn courses(&self) -> &[Course];
}

/// None are known.
impl Courses for () {
    fn courses(&self) -> &[Course] {
        &[]
    }
}

/// What a course would split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promise {
    /// Sum over pairs of `sqrt(p_i p_j) exp(-J_ij / 4)`.
    pub confusion: f64,
    /// `J` of the two most probable causes.
    pub leading_nats: f64,
    /// Length of its log, in seconds.
    pub length_s: f64,
}

/// What a log so driven would split of these causes, each with its probability, the most probable first.
#[must_use]
pub fn promise(judge: &dyn Judge, tied: &[(&Weighed, f64)]) -> Promise {
    let signatures = signatures(judge, tied.iter().map(|(weighed, _)| *weighed));
    let (mut confusion, mut leading_nats) = (0.0, f64::INFINITY);
    for (i, (a, p)) in tied.iter().enumerate() {
        for (j, (b, q)) in tied.iter().enumerate().skip(i + 1) {
            let nats = apart([a, b], [&signatures[i], &signatures[j]]);
            confusion += (p * q).sqrt() * exp(-0.25 * nats);
            if (i, j) == (0, 1) {
                leading_nats = nats;
            }
        }
    }
    Promise { confusion, leading_nats, length_s: judge.length_s() }
}

/// The course that promises most, and what it promises; `None` where none promises more than the log's own commands.
#[must_use]
pub fn best<'a>(
    library: &dyn Responds,
    courses: &'a [Course],
    own: Promise,
    tied: &[(&Weighed, f64)],
) -> Option<(&'a Course, Promise)> {
    let judged = courses.iter().filter_map(|course| Some((course, library.judge(&course.log).ok()?)));
    let promised = judged.map(|(course, judge)| (course, promise(&*judge, tied)));
    let better = promised.filter(|(_, promise)| promise.confusion < own.confusion);
    better.reduce(|a, b| if b.1.confusion < a.1.confusion { b } else { a })
}

/// What to record next to split causes, in words, and the keys that make the robot drive so.
#[must_use]
pub fn advice(
    judge: &dyn Judge,
    library: &dyn Responds,
    courses: &[Course],
    tied: &[(&Weighed, f64)],
) -> Option<(String, Option<String>)> {
    let [(a, _), (b, _), ..] = tied else { return None };
    let (a, b) = (a.effect, b.effect);
    let own = promise(judge, tied);
    let apart = format!("{a} and {b} part by {:.1} nats in this log", own.leading_nats);
    Some(match best(library, courses, own, tied) {
        Some((course, promise)) if promise.leading_nats > SPLIT_NATS => {
            let Promise { leading_nats, length_s, .. } = promise;
            let Course { words, keys, .. } = course;
            (format!("{apart}; {words}, they would part by {leading_nats:.1} in {length_s:.0} s"), Some(keys.clone()))
        }
        _ => (again(&apart, own, courses.len()), None),
    })
}

/// Nothing is better than what was done.
fn again(apart: &str, own: Promise, courses: usize) -> String {
    // A set of one needs odds of about 20 to 1 on average: 6 nats leave room for chance.
    let needed_s = own.length_s * 6.0 / own.leading_nats.max(1e-6);
    if needed_s < 20.0 * own.length_s {
        format!("{apart}: about {needed_s:.0} s of such commands would split them")
    } else if courses == 0 {
        format!("{apart}: commands of this kind will not split them")
    } else {
        format!("{apart}: neither commands of this kind nor any of {courses} other courses will split them")
    }
}
