//! How noisy a real robot and its sensor are, out of the parts of a log that are not diagnosed with it.
//!
//! A nominal world's noise is of its simulator. Held against a real log, whose noise is another, every cause that scatters
//! would be evident, and none that moves something would be weighed as it should. Other parts than what is diagnosed say how
//! large the noise is, and how long it lasts: everything else is left free there, so that no gap is taken for noise.

use asami_dataset::Log;
use asami_math::elementary::{exp, ln, logistic};
use asami_math::optimise::downhill;
use asami_math::statistics::median;

use crate::answer::diagnosis::Noise;
use crate::blocks::likeliest;
use crate::directions::Direction;
use crate::judge::Judge;
use crate::library::Library;
use crate::memory::{Lasting, Memory, Sway};
use crate::plant::Planted;
use crate::shape::{Numbers, SPEEDS, Shape};
use crate::sighted::Sighted;
use crate::tails::Tails;
use crate::view::CannotSee;

/// Blocks in which the response is made most likely there, one after another, each time once noise is; again and again.
pub(super) const FREE: [&str; 3] = ["sensor", "static_motion", "timing"];
/// How far a size of noise goes at once, and in what steps it is looked for, in the noise block's standard deviations.
const FARTHEST: f64 = 3.0;
const STEP: f64 = 0.5;
/// At most so often.
const MOST_ROUNDS: usize = 8;
/// A round that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 1.0;
/// Noise is large at first: where it is too small, single sightings of hundreds of nats say which way to go, and no step is
/// small enough.
const START: [(Numbers, f64); 4] =
    [(Numbers::MotionNoise, 4.0), (Numbers::SizeNoise, 1.2), (Numbers::BearingNoise, 1.2), (Numbers::False, 3.0)];
/// Logarithm of the least standard deviation of a sensor, 1 mm and 1 mrad: readings that never change have none.
const LEAST_LN_SD: f64 = -6.9;
/// Shares of noise that may last, and frames in which it fades to 1/e.
const SHARES: [f64; 5] = [0.3, 0.6, 0.8, 0.9, 0.95];
const FRAMES: [f64; 6] = [2.0, 4.0, 8.0, 16.0, 32.0, 60.0];
/// The same of what each landmark's sizes are off by themselves, in seconds.
const FADES_S: [f64; 7] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// What a landmark's sizes are off lasts at first: as long as it is taken to be new each time, it seems to be motion.
const AT_FIRST: Lasting = Lasting { share: 0.6, fades_s: 8.0 };
/// Noise lasts only if that is so much more likely, in nats.
const LASTS_NATS: f64 = 10.0;
/// Of these each number is found by itself, in such steps: what is far is read less exactly than what is near.
const ALONE: [(Numbers, f64); 2] = [(Numbers::SizeNoise, 0.3), (Numbers::BearingNoise, 0.3)];
/// Of several landmarks, of which motion has less in common with any one's errors, these as well: robots scatter most where their
/// commands change.
const ALONE_AMONG_SEVERAL: [(Numbers, f64); 1] = [(Numbers::MotionNoise, 0.6)];
/// Prior standard deviation of logarithms of standard deviations, of variances and of odds, about the nominal ones: where a log
/// says next to nothing of a noise, the likeliest is often none at all.
const UNSURE: f64 = 2.0;
/// Axes of motion.
const AXES: usize = 3;
const SIDEWAYS: usize = 0;
const FORWARD: usize = 1;
const TURN: usize = 2;
/// What is kept of it.
pub(super) const NOISE: [Numbers; 5] =
    [Numbers::MotionNoise, Numbers::SizeNoise, Numbers::BearingNoise, Numbers::False, Numbers::Detection];

/// The noise made most likely, one size of it after another, as far as that goes: the likelihood is nowhere near quadratic
/// in it. After all bands of distance together, if asked for, each by itself.
fn scattered(judge: &Sighted<'_>, mut numbers: Vec<f64>, each: bool) -> Vec<f64> {
    let (shape, nominal) = (&judge.library.base.shape, &judge.library.base.numbers);
    let several = several(judge);
    let alone = ALONE.into_iter().chain(ALONE_AMONG_SEVERAL.into_iter().filter(|_| several));
    let alone = alone.flat_map(|(group, change)| shape.range(group).map(move |i| (i, change)));
    let alone = alone.filter(|_| each).map(|(i, change)| {
        let mut direction = vec![0.0; numbers.len()];
        direction[i] = change;
        direction
    });
    // Motion first: as long as it is as large as at the start, a sensor's noise passes for it. Of a single landmark the sensor
    // first: what its sizes are off for a while would pass for the robot's.
    let of_motion = shape.range(Numbers::MotionNoise);
    let moves = |direction: &Direction| several && direction[of_motion.clone()].iter().any(|it| *it != 0.0);
    let (first, then): (Vec<Direction>, Vec<Direction>) =
        judge.directions(&numbers, "noise").into_iter().partition(moves);
    let mut directions: Vec<Direction> = first.into_iter().chain(then).chain(alone).collect();
    let kept: Vec<usize> = kept(shape).collect();
    directions.iter_mut().for_each(|direction| kept.iter().for_each(|i| direction[*i] = 0.0));
    let mut here = likely(judge, &numbers);
    for direction in directions.into_iter().filter(|direction| direction.iter().any(|it| *it != 0.0)) {
        let at =
            |by: f64| numbers.iter().zip(&direction).map(|(number, change)| number + by * change).collect::<Vec<_>>();
        let moved: Vec<usize> = (0..direction.len()).filter(|i| direction[*i] != 0.0).collect();
        let strange = |by: f64| {
            let off = |i: &usize| (numbers[*i] + by * direction[*i] - nominal[*i]) / UNSURE;
            moved.iter().map(|i| 0.5 * off(i) * off(i)).sum::<f64>() / moved.len().max(1) as f64
        };
        let unlikely = |by: f64| strange(by) - likely(judge, &at(by));
        let found = downhill(unlikely, strange(0.0) - here, STEP, FARTHEST);
        if found.x != 0.0 {
            here = strange(found.x) - found.value;
            numbers = at(found.x);
        }
    }
    numbers
}

/// Numbers of noise that stay the nominal world's: a base on wheels does not slide sideways. Were it let, what a camera looks past
/// would pass for that.
fn kept(shape: &Shape) -> impl Iterator<Item = usize> {
    let on_wheels = shape.columns.in_turns().is_some();
    shape.range(Numbers::MotionNoise).skip(SIDEWAYS).step_by(AXES).filter(move |_| on_wheels)
}

fn likely(judge: &dyn Judge, numbers: &[f64]) -> f64 {
    judge.terms(numbers).iter().fold(0.0, |sum, it| sum + it)
}

/// How often innovations are far off: a camera's readings of marks are not Gaussian, and a single one that is far off would speak
/// by hundreds of nats for whatever brings it nearer.
fn tails(judge: &Sighted<'_>, numbers: &[f64]) -> Tails {
    let genuine = judge.filtered(numbers).innovations.into_iter().filter(|it| it.genuine > 0.5);
    Tails::learn(&genuine.map(|it| it.white[0] * it.white[0] + it.white[1] * it.white[1]).collect::<Vec<f64>>())
}

/// Has noise last as long as is most likely: that of sizes, then that of bearings.
fn last(judge: &mut Sighted<'_>, numbers: &[f64]) {
    let frames = judge.view.steps.windows(2).map(|pair| pair[1].t_s - pair[0].t_s).filter(|it| *it > 0.0);
    judge.memory.frame_s = median(&frames.collect::<Vec<f64>>()).unwrap_or(judge.memory.frame_s);
    for k in 0..2 {
        let mut best = (likely(judge, numbers), judge.memory);
        judge.memory.sways.iter_mut().for_each(|sways| sways[k] = Sway::default());
        let without = likely(judge, numbers);
        if without + LASTS_NATS > best.0 {
            best = (without + LASTS_NATS, judge.memory);
        }
        for (share, frames) in SHARES.into_iter().flat_map(|share| FRAMES.map(|frames| (share, frames))) {
            let sway = Sway { share, on: [exp(-1.0 / frames), 0.0], ..Sway::default() };
            judge.memory.sways.iter_mut().for_each(|sways| sways[k] = sway);
            let found = likely(judge, numbers);
            if found > best.0 {
                best = (found, judge.memory);
            }
        }
        judge.memory = best.1;
    }
}

/// Whether there are landmarks of which each has errors of its own.
fn several(judge: &Sighted<'_>) -> bool {
    judge.view.landmarks.len() > 1
}

/// What a log is to be likelier by if what landmarks' sizes are off lasts.
fn price(lasting: Lasting) -> f64 {
    if lasting.share > 0.0 { LASTS_NATS } else { 0.0 }
}

/// Has what each landmark's sizes are off last as long as is most likely.
fn last_each(judge: &mut Sighted<'_>, numbers: &[f64]) {
    let some = SHARES.into_iter().flat_map(|share| FADES_S.map(|fades_s| Lasting { share, fades_s }));
    let likely = |lasting: Lasting| {
        judge.memory.lasting = lasting;
        (likely(judge, numbers) - price(lasting), lasting)
    };
    let best = std::iter::once(Lasting::default()).chain(some).map(likely).reduce(|a, b| if b.0 > a.0 { b } else { a });
    judge.memory.lasting = best.map_or_else(Lasting::default, |it| it.1);
}

/// The noise of libraries that have it from a log over a nominal one's, in the mean over them; `None` without any.
pub(super) fn compared(nominal: &Library, noisy: &[Library]) -> Option<Noise> {
    let each: Vec<Noise> = noisy.iter().map(|noisy| ratios(nominal, noisy)).collect();
    let mean = |of: &dyn Fn(&Noise) -> f64| each.iter().map(of).sum::<f64>() / each.len() as f64;
    let typical = |of: &dyn Fn(&Noise) -> f64| exp(mean(&|it| ln(of(it))));
    let lasting_share = mean(&|it| it.lasting_share);
    // Where nothing lasts, there is nothing to fade.
    let fades_s = if lasting_share > 0.0 { mean(&|it| it.lasting_share * it.fades_s) / lasting_share } else { 0.0 };
    (!each.is_empty()).then(|| Noise {
        size_ratio: typical(&|it| it.size_ratio),
        bearing_ratio: typical(&|it| it.bearing_ratio),
        motion_ratio: typical(&|it| it.motion_ratio),
        false_share: mean(&|it| it.false_share),
        lasting_share,
        fades_s,
    })
}

fn ratios(nominal: &Library, noisy: &Library) -> Noise {
    let shape = &nominal.base.shape;
    let more = |i: usize| noisy.base.numbers[i] - nominal.base.numbers[i];
    let mean = |of: &[usize]| of.iter().fold(0.0, |sum, i| sum + more(*i)) / of.len().max(1) as f64;
    let all = |group: Numbers| exp(mean(&shape.range(group).collect::<Vec<usize>>()));
    // Variances, slow and fast together: of either alone a log may hold next to nothing.
    let motion = shape.range(Numbers::MotionNoise).start;
    let variance = |of: &Library, axis: usize| -> f64 {
        (1..SPEEDS).map(|class| exp(of.base.numbers[motion + AXES * class + axis])).sum()
    };
    let Lasting { share: lasting_share, fades_s } = noisy.base.memory.fading();
    let of_axes = [FORWARD, TURN].map(|axis| variance(noisy, axis) / variance(nominal, axis));
    Noise {
        size_ratio: all(Numbers::SizeNoise),
        bearing_ratio: all(Numbers::BearingNoise),
        motion_ratio: (of_axes[0] * of_axes[1]).powf(0.25),
        false_share: logistic(noisy.base.numbers[shape.range(Numbers::False).start]),
        lasting_share,
        fades_s,
    }
}

impl Library {
    /// The same library with the noise of some parts of a log in the place of the nominal world's own. What is
    /// `planted` is known to be in the world; whatever else may be is left free. What was known of it `before` is gone on
    /// from.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn noisy_as(
        &self,
        log: &Log,
        of: impl Fn(f64) -> bool,
        planted: &[Planted],
        before: Option<&Self>,
    ) -> Result<Self, CannotSee> {
        let mut judge = Sighted::scoring(log, self, planted, of)?;
        let mut numbers = self.numbers(planted);
        for of in NOISE.map(|group| self.base.shape.range(group)) {
            numbers[of.clone()].copy_from_slice(&before.unwrap_or(self).base.numbers[of]);
        }
        match before {
            Some(before) => judge.memory = before.base.memory,
            None => {
                START.into_iter().for_each(|(group, more)| {
                    self.base.shape.range(group).for_each(|i| numbers[i] += more);
                });
                kept(&self.base.shape).for_each(|i| numbers[i] = self.base.numbers[i]);
                judge.memory.lasting = if several(&judge) { AT_FIRST } else { Lasting::default() };
            }
        }
        let (numbers, memory) = self.likeliest_noise(&mut judge, &numbers);
        let mut noisy = self.clone();
        noisy.base.memory = memory;
        for of in NOISE.map(|group| self.base.shape.range(group)) {
            noisy.base.numbers[of.clone()].copy_from_slice(&numbers[of.clone()]);
            noisy.entries.iter_mut().filter(|entry| !entry.is_of_noise()).for_each(|entry| entry.leaves(of.clone()));
        }
        Ok(noisy)
    }

    /// The noise that makes a log most likely, from these numbers on: whichever is likelier, beginning with what landmarks' errors
    /// last, or with none that do. From either start the other is not found: what is off for good passes for what lasts, and what
    /// lasts for motion.
    fn likeliest_noise(&self, judge: &mut Sighted<'_>, numbers: &[f64]) -> (Vec<f64>, Memory) {
        let begun = judge.memory;
        let mut starts = vec![Memory { lasting: Lasting::default(), ..begun }];
        starts.extend(begun.lasts().then_some(begun));
        let settled = starts.into_iter().map(|start| {
            judge.memory = start;
            let (likely, numbers) = self.settled_noise(judge, numbers.to_vec());
            (likely - price(judge.memory.lasting), numbers, judge.memory)
        });
        let best = settled.reduce(|a, b| if b.0 > a.0 { b } else { a });
        best.map_or_else(|| (numbers.to_vec(), begun), |(_, numbers, memory)| (numbers, memory))
    }

    /// The noise learned until nothing is gained any more, everything else left free, and how likely the log is with it.
    fn settled_noise(&self, judge: &mut Sighted<'_>, mut numbers: Vec<f64>) -> (f64, Vec<f64>) {
        let several = several(judge);
        let mut gone_before = f64::NEG_INFINITY;
        for _ in 0..MOST_ROUNDS {
            for (i, block) in FREE.iter().enumerate() {
                let scattered = self.floored(scattered(judge, numbers, i == 0 || !several));
                numbers = likeliest(&[judge as &dyn Judge], &scattered, block);
            }
            let after = likely(judge, &numbers);
            if after - gone_before < GAINS_NOTHING_NATS {
                return (after, numbers);
            }
            gone_before = after;
            judge.memory.tails = tails(judge, &numbers);
            // Of several landmarks each has a noise of its own.
            if several {
                last_each(judge, &numbers);
            } else {
                last(judge, &numbers);
            }
        }
        (likely(judge, &numbers), numbers)
    }

    /// With no sensor more exact than any is.
    fn floored(&self, mut numbers: Vec<f64>) -> Vec<f64> {
        for of in [Numbers::SizeNoise, Numbers::BearingNoise].map(|group| self.base.shape.range(group)) {
            numbers[of].iter_mut().for_each(|it| *it = it.max(LEAST_LN_SD));
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Command};

    use super::*;
    use crate::columns::Columns;

    fn of(action: Action) -> Shape {
        let columns = Columns::new([Command { t_s: 0.0, action }].iter(), 2);
        let (near_far_m, sizes) = ([0.3, 5.0], [0.3, 5.0]);
        Shape { columns, landmarks: 2, ranges: true, near_far_m, off_rad: 0.5, sizes, reported: 0.5 }
    }

    #[test]
    fn wheels_roll_and_feet_slip() {
        let wheels = of(Action::Wheels { id: None, v_m_per_s: 0.2, omega_rad_per_s: 0.5 });
        let noise = wheels.range(Numbers::MotionNoise);
        let kept: Vec<usize> = kept(&wheels).collect();
        assert_eq!(kept.len(), noise.len() / AXES);
        assert!(
            kept.iter().all(|i| noise.contains(i) && (i - noise.start) % AXES == SIDEWAYS),
            "{kept:?} of {noise:?}"
        );
        let legs = of(Action::Legs { id: None, ax_m_per_s: 0.1, ay_m_per_s: 0.3, atheta_rad_per_s: 0.5 });
        assert_eq!(super::kept(&legs).count(), 0);
    }
}
