//! A log of landmarks under many responses: its likelihood under each, by the filter over the robot's pose.

use asami_dataset::Log;
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, exp, ln, sin_cos};
use nalgebra::{Matrix3, Vector3};

use crate::directions::{Direction, directions};
use crate::filter::{Counted, UNCOUNTED, Walk, counted};
use crate::hears::{Filtered, Hears, Scored, Terms};
use crate::judge::{Channel, Innovation, Judge, Moment, Reading, Regime, Share};
use crate::library::{Base, Library};
use crate::memory::Memory;
use crate::plant::{Planted, Variant};
use crate::race::{Pace, Runner};
use crate::regimes::{channels, regimes};
use crate::rhythm::Heard;
use crate::shape::{Numbers, Shape, Sight};
use crate::state::Belief;
use crate::view::{CannotSee, Step, View};

/// The effect that shows in what is missed alone.
const MISSES: &str = "missed_sightings";
/// Nothing is scored before the filter has settled.
const SETTLING_S: f64 = 5.0;
/// Starts tried around the first landmark seen.
const STARTS: usize = 36;
/// Each start is tried on so many sightings.
const TRIED: usize = 60;

/// A log, and where its robot started.
pub struct Sighted<'a> {
    /// The nominal response and the effects'.
    pub library: &'a Library,
    /// How noise hangs together: the library's, to begin with.
    pub memory: Memory,
    /// The log.
    pub view: View,
    start: Belief,
    /// The first step with a sighting.
    begin: usize,
    /// Whether each step from `begin` on is scored.
    scored: Vec<bool>,
    /// Whose being seen or missed counts; the same under every response, so that they can be compared.
    counted: Counted,
    moments: Vec<Moment>,
}

impl<'a> Sighted<'a> {
    /// Looks at a log.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn new(log: &Log, library: &'a Library) -> Result<Self, CannotSee> {
        let aside = library.aside;
        Self::scoring(log, library, |t_s| aside.is_none_or(|aside| !aside.holds(t_s)))
    }

    /// Looks at a log, of which the times for which `of` says so are scored.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn scoring(log: &Log, library: &'a Library, of: impl Fn(f64) -> bool) -> Result<Self, CannotSee> {
        let mut view = View::new(log, &library.base.shape.columns)?;
        if !library.base.rhythm.is_silent() {
            let heard = heard(&library.base, &view);
            view.steady(&library.base.rhythm.of(&heard));
        }
        for step in &mut view.steps {
            step.astray = library.astray.iter().any(|[from_s, to_s]| (*from_s..*to_s).contains(&step.t_s));
        }
        let begin = view.steps.iter().position(|step| !step.seen.is_empty()).unwrap_or(0);
        let settled_s = view.steps[begin].t_s + SETTLING_S;
        let counts = |step: &Step| step.t_s >= settled_s && !step.astray && of(step.t_s);
        let scored: Vec<bool> = view.steps[begin..].iter().map(counts).collect();
        let start = start(&library.base.shape, &library.base.numbers, &view, begin);
        let counted = counted(&library.base.shape, &library.base.numbers, &view, begin, &mut start.clone());
        let steps = view.steps[begin..].iter().zip(&scored).filter(|(_, scored)| **scored);
        let moments = steps.map(|(step, _)| Moment { t_s: step.t_s, seen: step.seen.len() }).collect();
        Ok(Self { library, memory: library.base.memory, view, start, begin, scored, counted, moments })
    }

    /// The log filtered under a response, as far as it is scored.
    #[must_use]
    pub fn filtered(&self, numbers: &[f64]) -> Filtered {
        let (mut filtered, visits) = self.told(numbers, Filtered::default());
        filtered.visits = visits;
        filtered
    }

    /// Filters the log under a response for somebody. Gives how often each bin of detection was visited, too.
    fn told<H: Hears>(&self, numbers: &[f64], heard: H) -> (H, Vec<f64>) {
        let mut scored = Scored { scored: &self.scored, heard };
        let shape = &self.library.base.shape;
        let walk = Walk { shape, numbers, memory: self.memory, view: &self.view, counted: &self.counted };
        let visits = walk.tell(&mut scored, self.begin..self.view.steps.len(), &mut self.start.clone());
        (scored.heard, visits)
    }
}

impl Judge for Sighted<'_> {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        self.library.numbers(planted)
    }

    /// Where nobody knows what was missed, an effect by which more is missed does not show.
    fn knows(&self, variant: &Variant) -> bool {
        let shows = self.view.misses || variant.about.name != MISSES;
        shows && self.library.entry(variant).is_some()
    }

    fn read(&self, numbers: &[f64]) -> Reading {
        let filtered = self.filtered(numbers);
        let shape = &self.library.base.shape;
        let observations = filtered.innovations.len();
        let innovations = filtered.innovations.iter().flat_map(|it| {
            let of = |channel: usize| Innovation {
                channel,
                plain: it.plain[channel],
                white: it.white[channel],
                ln_scale: ln(it.scale[channel]),
                genuine: it.genuine > 0.5,
            };
            [of(0), of(1)]
        });
        let of_false = Share { log_odds: numbers[shape.range(Numbers::False).start], trials: observations as f64 };
        let bins = shape.range(Numbers::Detection).zip(&filtered.visits);
        let of_seen = bins.map(|(bin, visits)| Share { log_odds: numbers[bin], trials: *visits });
        Reading {
            innovations: innovations.collect(),
            shares: std::iter::once(of_false).chain(of_seen).collect(),
            observations,
            log_likelihoods: filtered.log_likelihoods,
            expected: filtered.expected,
        }
    }

    fn terms(&self, numbers: &[f64]) -> Vec<f64> {
        self.told(numbers, Terms(Vec::with_capacity(self.moments.len()))).0.0
    }

    fn beside(&self, numbers: &[f64], pace: &Pace) -> f64 {
        self.told(numbers, Runner::new(pace)).0.log_likelihood()
    }

    fn steps(&self) -> &[Moment] {
        &self.moments
    }

    fn length_s(&self) -> f64 {
        let steps = &self.view.steps;
        steps.last().zip(steps.first()).map_or(0.0, |(last, first)| last.t_s - first.t_s)
    }

    fn measured(&self) -> Vec<&'static str> {
        vec![if self.library.base.shape.ranges { "range_m" } else { "height_px" }, "bearing_rad"]
    }

    fn directions(&self, numbers: &[f64], block: &str) -> Vec<Direction> {
        directions(&self.library.base.shape, numbers, block)
    }

    fn channels(&self) -> Vec<Channel> {
        channels(&self.library.base.shape)
    }

    fn regimes(&self) -> Vec<Regime> {
        let all = regimes(&self.view.steps[self.begin..]);
        let scored =
            |of: &[bool]| of.iter().zip(&self.scored).filter(|(_, scored)| **scored).map(|(it, _)| *it).collect();
        all.into_iter().map(|(name, of)| (name, scored(&of))).collect()
    }
}

/// What every sighting of a log is off what a filter expects, in the order of the view.
fn heard(base: &Base, view: &View) -> Vec<Heard> {
    let Base { shape, rhythm, .. } = base;
    let begin = view.steps.iter().position(|step| !step.seen.is_empty()).unwrap_or(0);
    let mut belief = start(shape, &rhythm.numbers, view, begin);
    let steps = begin..view.steps.len();
    let numbers = &rhythm.numbers;
    let filtered =
        Walk { shape, numbers, memory: Memory::default(), view, counted: UNCOUNTED }.filter(steps, &mut belief);
    let size = &rhythm.numbers[shape.range(Numbers::Size)];
    let noise = [shape.range(Numbers::SizeNoise).start, shape.range(Numbers::BearingNoise).start];
    let sd = |i: usize| {
        let band = shape.band(distance(shape, size, view.seen[i].size));
        noise.map(|at| exp(rhythm.numbers[at + band]))
    };
    let steps = view.steps.iter().flat_map(|step| step.seen.clone().map(|i| (i, step.t_s)));
    let mut heard: Vec<Heard> = steps.map(|(i, t_s)| Heard { t_s, off: None, sd: sd(i) }).collect();
    for it in filtered.innovations.iter().filter(|it| it.genuine > 0.5) {
        heard[it.seen].off = Some([0, 1].map(|k| it.plain[k] / heard[it.seen].sd[k]));
    }
    heard
}

/// The best of several places around the first landmark seen; before a single landmark they are all the same.
fn start(shape: &Shape, numbers: &[f64], view: &View, begin: usize) -> Belief {
    let step = &view.steps[begin];
    let Some(seen) = step.seen.clone().next().map(|i| view.seen[i]) else { return ring(0.0, [0.0; 2], 1.0, 0.0, true) };
    let distance_m = distance(shape, &numbers[shape.range(Numbers::Size)], seen.size);
    let at = view.landmarks[seen.landmark];
    if view.landmarks.len() == 1 {
        return seen_from(view, ring(0.0, at, distance_m, seen.bearing_rad, true));
    }
    let mut last = begin;
    while last < view.steps.len() && view.steps[last].seen.end < step.seen.start + TRIED {
        last += 1;
    }
    let turn = |i: usize| std::f64::consts::TAU * i as f64 / STARTS as f64;
    let starts = (0..STARTS).map(|i| seen_from(view, ring(turn(i), at, distance_m, seen.bearing_rad, false)));
    let walk = Walk { shape, numbers, memory: Memory::default(), view, counted: UNCOUNTED };
    let likely = |start: &Belief| walk.filter(begin..last, &mut start.clone()).total(0);
    let scored = starts.map(|start| (likely(&start), start));
    let best = scored.reduce(|a, b| if b.0 > a.0 { b } else { a });
    best.map_or_else(|| ring(0.0, at, distance_m, seen.bearing_rad, false), |(_, start)| start)
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
fn distance(shape: &Shape, numbers: &[f64], size: f64) -> f64 {
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
