//! What to record next: of several ways to drive the robot, the one that best splits what a log leaves tied.
//!
//! Two causes part by `J` nats in a log. Of all courses the one is chosen with the least sum over the tied causes' pairs of
//! `sqrt(p_i p_j) exp(-J_ij / 4)`, the bound on the chance of taking one for the other (Bhattacharyya 1943) where their
//! predictions differ in the mean.

use asami_dataset::Log;
use asami_math::elementary::{exp, ln};
use rayon::prelude::*;

use crate::judge::Judge;
use crate::library::Responds;
use crate::weigh::evidence::Weighed;
use crate::weigh::groups::{apart, signatures};

/// Two causes that are expected to part by so many nats part by 3, odds of 20 to 1, in four logs of five: a log-likelihood
/// ratio of mean `J` has variance `2 J` where predictions differ in the mean.
const SURE_NATS: f64 = 6.0;
/// Other commands are advised where the log's own need so many times as long.
const WORTH_CHANGING: f64 = 1.25;
/// Nobody records a log so many times as long.
const LONGEST: f64 = 20.0;
/// Logs are recorded for whole multiples of this.
const ROUND_S: f64 = 10.0;
/// Of what may be a size's logarithm the lowest fifth lies beyond this share of the way to the end of its 90 % interval: an effect
/// that hardly shows is as likely as not smaller than it seems.
const CAUTIOUS: f64 = 0.512;

/// A way to drive the robot.
#[derive(Clone, Debug)]
pub struct Course {
    /// What is done, in words.
    pub words: String,
    /// The keys of the scenario that make it do so, as `table.key = value`.
    pub keys: String,
    /// Logs of the nominal world, so driven: a promise is their mean.
    pub logs: Vec<Log>,
}

/// Courses that may be driven next; they are only asked for where something is tied.
pub trait Courses: Sync {
    /// All of them, each with logs as long as the one that is diagnosed.
    fn courses(&self) -> &[Course];

    /// Logs of the robot's own commands once more: one that leaves causes tied may have been an unlucky one of its kind.
    fn again(&self) -> &[Log] {
        &[]
    }
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

impl Promise {
    /// Of several logs that are driven alike; `None` without one.
    #[must_use]
    pub fn mean(of: &[Self]) -> Option<Self> {
        let mean = |of_one: fn(&Self) -> f64| of.iter().map(of_one).sum::<f64>() / of.len() as f64;
        (!of.is_empty()).then(|| Self {
            confusion: mean(|it| it.confusion),
            leading_nats: mean(|it| it.leading_nats),
            length_s: mean(|it| it.length_s),
        })
    }

    /// For how long it must be driven so, in seconds, for the two most probable causes to part surely.
    #[must_use]
    pub fn needed_s(&self) -> f64 {
        self.length_s * SURE_NATS / self.leading_nats.max(1e-6)
    }

    /// Whether that is too long.
    fn is_endless(&self) -> bool {
        self.needed_s() >= LONGEST * self.length_s
    }

    /// Whether it is worth driving as another course promises.
    #[must_use]
    pub fn yields_to(&self, other: &Self) -> bool {
        !other.is_endless() && WORTH_CHANGING * other.needed_s() <= self.needed_s()
    }
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

/// What logs that are driven alike promise, as their mean; `None` where none of them can be read.
fn promise_of(library: &dyn Responds, logs: &[Log], tied: &[(&Weighed, f64)]) -> Option<Promise> {
    let of_log = |log: &Log| library.judge(log).ok().map(|judge| promise(&*judge, tied));
    Promise::mean(&logs.iter().filter_map(of_log).collect::<Vec<_>>())
}

/// The course that promises most, and what it promises; `None` where none promises more than the log's own commands.
#[must_use]
pub fn best<'a>(
    library: &dyn Responds,
    courses: &'a [Course],
    own: Promise,
    tied: &[(&Weighed, f64)],
) -> Option<(&'a Course, Promise)> {
    let of_course = |course: &'a Course| Some((course, promise_of(library, &course.logs, tied)?));
    let promised: Vec<(&Course, Promise)> = courses.par_iter().filter_map(of_course).collect();
    let better = promised.into_iter().filter(|(_, promise)| promise.confusion < own.confusion);
    better.reduce(|a, b| if b.1.confusion < a.1.confusion { b } else { a })
}

/// The effect at a size that it surpasses four times in five.
fn cautious(weighed: &Weighed) -> Weighed {
    let mut smaller = weighed.clone();
    let low = weighed.interval[0].min(weighed.best.size);
    smaller.best.size *= exp(CAUTIOUS * ln(low / weighed.best.size).max(-700.0));
    smaller
}

/// What to record next, in words, and how far it would part the two most probable causes.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// What to record.
    pub words: String,
    /// By how much they part in the log.
    pub parted_nats: f64,
    /// The log that should part them; `None` where the log's own commands are as good as any.
    pub next: Option<NextLog>,
}

/// A log that is driven otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct NextLog {
    /// The keys that make the robot drive so.
    pub keys: String,
    /// By how much the two most probable causes are expected to part in it.
    pub promised_nats: f64,
    /// How long it should be, in seconds: it parts them surely, and is no shorter than the log.
    pub length_s: f64,
}

/// What to record next to split causes; `None` of fewer than two.
#[must_use]
pub fn advice(
    judge: &dyn Judge,
    library: &dyn Responds,
    courses: &dyn Courses,
    tied: &[(&Weighed, f64)],
) -> Option<Advice> {
    let [(a, _), (b, _), ..] = tied else { return None };
    let (a, b) = (a.effect, b.effect);
    let parted_nats = promise(judge, tied).leading_nats;
    let smaller: Vec<(Weighed, f64)> = tied.iter().map(|(weighed, p)| (cautious(weighed), *p)).collect();
    let smaller: Vec<(&Weighed, f64)> = smaller.iter().map(|(weighed, p)| (weighed, *p)).collect();
    let here = promise(judge, &smaller);
    // Nothing needs be played to be held beside no course.
    let again = if courses.courses().is_empty() { None } else { promise_of(library, courses.again(), &smaller) };
    let own = again.filter(|again| again.leading_nats > here.leading_nats).unwrap_or(here);
    let courses = courses.courses();
    let apart = format!("{a} and {b} part by {parted_nats:.1} nats in this log");
    Some(match best(library, courses, own, &smaller).filter(|(_, promise)| own.yields_to(promise)) {
        Some((course, promise)) => {
            let length_s = (promise.needed_s().max(promise.length_s) / ROUND_S).ceil() * ROUND_S;
            let promised_nats = promise.leading_nats * length_s / promise.length_s;
            Advice {
                words: format!("{apart}; {}, they would part by {promised_nats:.1} in {length_s:.0} s", course.words),
                parted_nats,
                next: Some(NextLog { keys: course.keys.clone(), promised_nats, length_s }),
            }
        }
        None => Advice { words: once_more(&apart, own, courses.len()), parted_nats, next: None },
    })
}

/// Nothing is better than what was done.
fn once_more(apart: &str, own: Promise, courses: usize) -> String {
    if !own.is_endless() {
        format!("{apart}: about {:.0} s of such commands would split them", own.needed_s())
    } else if courses == 0 {
        format!("{apart}: commands of this kind will not split them")
    } else {
        format!("{apart}: neither commands of this kind nor any of {courses} other courses will split them")
    }
}

#[cfg(test)]
mod tests {
    use asami_math::elementary::erfc;

    use super::*;
    use crate::plant::Planted;

    fn promise(leading_nats: f64) -> Promise {
        Promise { confusion: exp(-0.25 * leading_nats), leading_nats, length_s: 60.0 }
    }

    #[test]
    fn other_commands_are_worth_driving_where_they_split_surely_and_better() {
        let yields = |own: f64, other: f64| promise(own).yields_to(&promise(other));
        assert!(yields(0.1, 0.31) && !yields(0.01, 0.29), "in less than twenty times as long");
        assert!(yields(8.0, 10.0) && !yields(8.0, 9.9));
        // Half of what is sure in a log that is twice as long.
        assert!((promise(3.0).needed_s() - 120.0).abs() < 1e-9);
        // Of mean J and variance 2 J: a normal number is 0.84 standard deviations and more below its mean one time in five.
        let z = (SURE_NATS - 3.0) / (2.0 * SURE_NATS).sqrt();
        assert!((0.84..0.9).contains(&z), "{z}");
    }

    #[test]
    fn an_effect_is_trusted_to_be_as_large_as_it_is_four_times_in_five() {
        let variant = crate::straight::Straight::kind("command_scale");
        // Of a logarithm that is normally distributed about ln 0.1 with a standard deviation of a half.
        let low = exp(ln(0.1) - 1.6449 * 0.5);
        let best = Planted { variant, size: 0.1 };
        let weighed =
            Weighed { effect: "command_scale", evidence_nats: 1.0, best, gain_nats: 1.0, interval: [low, 0.2] };
        let z = (ln(cautious(&weighed).best.size) - ln(0.1)) / 0.5;
        assert!((0.5 * erfc(z / std::f64::consts::SQRT_2) - 0.8).abs() < 1e-3, "{z}");
    }

    #[test]
    fn a_course_s_promise_is_the_mean_of_its_logs_confusion_too() {
        assert_eq!(Promise::mean(&[]), None);
        let mean = Promise::mean(&[promise(0.0), promise(8.0)]).unwrap();
        assert_eq!((mean.leading_nats, mean.length_s), (4.0, 60.0));
        // One log in two that splits nothing is worse than two that split half.
        assert!(mean.confusion > promise(4.0).confusion);
    }
}
