//! A log of landmarks under many responses: its likelihood under each, by the filter over the robot's pose.

use asami_dataset::Log;
use asami_math::elementary::{exp, ln};

use crate::directions::{Direction, directions};
use crate::filter::{Counted, Kalman, UNCOUNTED, Walk, counted};
use crate::hears::{Filtered, Hears, Scored, Terms};
use crate::judge::{Channel, Innovation, Judge, Moment, Reading, Regime, Share};
use crate::library::{Base, Library};
use crate::memory::Memory;
use crate::plant::{Planted, Variant};
use crate::race::{Pace, Runner};
use crate::regimes::{channels, regimes};
use crate::rhythm::Heard;
use crate::shape::Numbers;
use crate::start::{Start, distance};
use crate::state::Belief;
use crate::view::{CannotSee, Step, View};

/// The effect that shows in what is missed alone.
const MISSES: &str = "missed_sightings";
/// Nothing is scored before the filter has settled.
const SETTLING_S: f64 = 5.0;

/// A log, and where its robot started.
pub struct Sighted<'a> {
    /// The nominal response and the effects'.
    pub library: &'a Library,
    /// How noise hangs together: the library's, to begin with.
    pub memory: Memory,
    /// The log.
    pub view: View,
    start: Belief,
    /// The step where it is known to be there.
    begin: usize,
    /// Whether each step from `begin` on is scored.
    scored: Vec<bool>,
    /// Whose being seen or missed counts; the same under every response, so that they can be compared.
    counted: Counted,
    kalman: Kalman,
    moments: Vec<Moment>,
}

impl<'a> Sighted<'a> {
    /// Looks at a log.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn new(log: &Log, library: &'a Library) -> Result<Self, CannotSee> {
        let Base { shape, numbers, .. } = &library.base;
        Self::begun(log, library, (numbers, Kalman::Extended), |view| Start::find(shape, numbers, view), |_| true)
    }

    /// Looks at a log, of which the times for which `of` says so are scored, and whose robot starts where it is likeliest to with these
    /// effects in the world: without them it may seem to stand metres away, from where no filter finds back for a while.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn scoring(
        log: &Log,
        library: &'a Library,
        with: &[Planted],
        of: impl Fn(f64) -> bool,
    ) -> Result<Self, CannotSee> {
        let (Base { shape, memory, .. }, numbers) = (&library.base, library.numbers(with));
        let start = |view: &View| Start::closely(shape, &numbers, *memory, view);
        Self::begun(log, library, (&numbers, Kalman::Invariant), start, of)
    }

    /// Looks at a log whose robot starts there; what is missed counts where something is expected under these numbers.
    fn begun(
        log: &Log,
        library: &'a Library,
        (numbers, kalman): (&[f64], Kalman),
        start: impl Fn(&View) -> Start,
        of: impl Fn(f64) -> bool,
    ) -> Result<Self, CannotSee> {
        let mut view = View::new(log, &library.base.shape.columns)?;
        if !library.base.rhythm.is_silent() {
            let heard = heard(&library.base, &view);
            view.steady(&library.base.rhythm.of(&heard));
        }
        for step in &mut view.steps {
            step.astray = library.astray.iter().any(|[from_s, to_s]| (*from_s..*to_s).contains(&step.t_s));
        }
        let Start { begin, belief: start } = start(&view);
        let settled_s = view.steps[begin].t_s + SETTLING_S;
        let counts = |step: &Step| step.t_s >= settled_s && !step.astray && of(step.t_s);
        let scored: Vec<bool> = view.steps[begin..].iter().map(counts).collect();
        let (shape, memory) = (&library.base.shape, Memory::default());
        let walk = Walk { shape, numbers, memory, view: &view, counted: UNCOUNTED, kalman };
        let counted = counted(&walk, begin, &mut start.clone());
        let steps = view.steps[begin..].iter().zip(&scored).filter(|(_, scored)| **scored);
        let moments = steps.map(|(step, _)| Moment { t_s: step.t_s, seen: step.seen.len() }).collect();
        Ok(Self { library, memory: library.base.memory, view, start, begin, scored, counted, kalman, moments })
    }

    /// The log filtered under a response, as far as it is scored.
    #[must_use]
    pub fn filtered(&self, numbers: &[f64]) -> Filtered {
        let (mut filtered, visits) = self.told(numbers, Filtered::default());
        filtered.visits = visits;
        filtered
    }

    /// `log p(o)` by scored step under a response whose noise hangs together like this.
    pub(crate) fn swayed(&self, numbers: &[f64], memory: Memory) -> Vec<f64> {
        let swayed = Terms(Vec::with_capacity(self.moments.len()));
        self.told_as(memory, numbers, swayed).0.0
    }

    /// Filters the log under a response for somebody. Gives how often each bin of detection was visited, too.
    fn told<H: Hears>(&self, numbers: &[f64], heard: H) -> (H, Vec<f64>) {
        self.told_as(self.memory, numbers, heard)
    }

    fn told_as<H: Hears>(&self, memory: Memory, numbers: &[f64], heard: H) -> (H, Vec<f64>) {
        let mut scored = Scored { scored: &self.scored, heard };
        let shape = &self.library.base.shape;
        let Self { view, counted, kalman, .. } = self;
        let walk = Walk { shape, numbers, memory, view, counted, kalman: *kalman };
        let visits = walk.tell(&mut scored, self.begin..self.view.steps.len(), &mut self.start.clone());
        (scored.heard, visits)
    }
}

impl Judge for Sighted<'_> {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        self.library.numbers(planted)
    }

    fn knows_together(&self, motion: bool) -> bool {
        self.library.knows_together(motion)
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
    let Start { begin, mut belief } = Start::find(shape, &rhythm.numbers, view);
    let steps = begin..view.steps.len();
    let numbers = &rhythm.numbers;
    let (memory, kalman) = (Memory::default(), Kalman::Extended);
    let walk = Walk { shape, numbers, memory, view, counted: UNCOUNTED, kalman };
    let filtered = walk.filter(steps, &mut belief);
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
