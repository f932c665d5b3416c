//! How likely landmarks are to be seen, to be missed, and to be reported where they are not.

use asami_math::elementary::ln;
use nalgebra::RowVector3;

use super::{Ready, Walk, by_pose};
use crate::hears::Hears;
use crate::state::{Belief, STEADY, State};
use crate::view::View;

/// Whether a landmark's being seen or missed says something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counts {
    /// It lies at an edge of what is seen: misses follow from one another, and would be counted many times.
    Not,
    /// It lies two standard deviations of the pose away from any edge.
    Clear,
    /// It lies that far and 0.4 rad outside of the image.
    Beyond,
}

/// The same by step and landmark.
pub type Counted = Vec<Counts>;

/// Where nobody counts what is missed.
pub const UNCOUNTED: &[Counts] = &[];
/// Under an effect a robot may be elsewhere than it is nominally taken to be, by more than that belief says.
const WELL_OUTSIDE_RAD: f64 = 0.4;
/// So often, the belief being wrong, a landmark is seen that should lie outside of the image.
const BEYOND: f64 = 0.002;
/// How likely sightings are of the landmark that they say is followed as a mean over about so many.
const LATELY: f64 = 30.0;
/// Where that mean falls below this a robot is lost: the log is not nominal, and its nominal belief says nothing of where
/// landmarks should be.
const LOST: f64 = 0.75;
/// Where it rises above this, it is found again.
const FOUND: f64 = 0.9;

/// How likely a landmark is to be seen.
#[derive(Clone, Copy)]
pub(super) struct Seeing {
    share: f64,
    /// Whether that it was, or was not, says something.
    counts: Counts,
}

/// Which landmarks' being seen or missed says something: none while the nominal filter has lost the robot.
#[must_use]
pub fn counted(walk: &Walk<'_>, begin: usize, belief: &mut Belief) -> Counted {
    let view = walk.view;
    let landmarks = view.landmarks.len();
    let mut counted = vec![Counts::Not; view.steps.len() * landmarks];
    let mut ready = Ready::new(walk);
    let mut state = State::<STEADY>::new(belief);
    let mut genuine = 1.0;
    for i in begin..view.steps.len() {
        if view.steps[i].dt_s > 0.0 {
            ready.predict(view, i, &mut state);
        }
        for landmark in 0..landmarks {
            if view.misses && view.steps[i].looked && !ready.lost {
                counted[i * landmarks + landmark] = ready.counts(view, i, landmark, &state.belief());
            }
        }
        for seen in view.steps[i].seen.clone() {
            genuine += (ready.update(view, i, seen, &mut state).1.genuine - genuine) / LATELY;
        }
        ready.lost = genuine < if ready.lost { FOUND } else { LOST };
    }
    *belief = state.belief();
    counted
}

impl Ready<'_> {
    /// Notes how likely each landmark is to be seen, and gives the logarithm of the probability of those that count and were
    /// not, and what is expected of minus that of all that count.
    pub(super) fn detection<H: Hears>(
        &mut self,
        view: &View,
        i: usize,
        belief: &Belief,
        counted: &[Counts],
    ) -> (f64, f64) {
        let n = view.landmarks.len();
        let counted = counted.get(i * n..(i + 1) * n).unwrap_or(UNCOUNTED);
        let (mut log_likelihood, mut expected) = (0.0, 0.0);
        let of_another = self.share_of_another();
        self.shares.clear();
        self.shares.resize(n, None);
        if !view.misses {
            return (log_likelihood, expected);
        }
        for (landmark, counts) in counted.iter().copied().enumerate() {
            let seen = view.seen[view.steps[i].seen.clone()].iter().any(|it| it.landmark == landmark);
            if counts == Counts::Not && !seen {
                continue;
            }
            let share = match counts {
                Counts::Beyond => BEYOND,
                _ => self.share_seen(view, i, landmark, belief, counts).clamp(1e-6, 1.0 - 1e-6),
            };
            self.shares[landmark] = Some(Seeing { share, counts });
            let [itself, missed] = [share, 1.0 - share].map(|it| (1.0 - of_another) * it);
            if counts != Counts::Not && !seen {
                log_likelihood += ln(missed);
            }
            if H::EXPECTS {
                expected -= match counts {
                    Counts::Clear => missed * ln(missed) + itself * ln(itself),
                    // Nominally nothing is ever seen there.
                    Counts::Beyond => ln(missed),
                    Counts::Not => 0.0,
                };
            }
        }
        (log_likelihood, expected)
    }

    /// How likely something else is taken for a given landmark in a given frame: as often as to its odds among sightings.
    fn share_of_another(&self) -> f64 {
        (self.shape.reported * self.share_false / (1.0 - self.share_false)).min(0.5)
    }

    /// How likely a landmark is to be seen, wherever in the belief the robot is (three points of Gauss and Hermite over
    /// the angle).
    fn share_seen(&mut self, view: &View, i: usize, landmark: usize, belief: &Belief, counts: Counts) -> f64 {
        let sight = self.sight(view, i, landmark, belief);
        let of_bearing = &self.numbers[self.bearing.clone()];
        let aimed = view.aims.then(|| self.shape.off_read(&sight, of_bearing, &mut self.bearing_columns));
        let off_rad = aimed.unwrap_or(sight.off_rad);
        let [_, off_sd] = self.uncertain(view, landmark, sight.distance_m, belief);
        let mut share = 0.0;
        for (step, weight) in [(0.0, 2.0 / 3.0), (3.0_f64.sqrt(), 1.0 / 6.0), (-(3.0_f64.sqrt()), 1.0 / 6.0)] {
            for (bin, part) in self.shape.bins(sight.distance_m, off_rad + step * off_sd) {
                share += weight * part * self.seen[bin];
                self.visits[bin] += if counts == Counts::Clear { weight * part } else { 0.0 };
            }
        }
        share
    }

    /// Whether a landmark's being seen, or missed, is in what [`Self::detection`] expects.
    pub(super) fn is_counted(&self, landmark: usize) -> bool {
        self.shares.get(landmark).copied().flatten().is_some_and(|it| it.counts != Counts::Not)
    }

    /// How likely a landmark is reported since it is seen itself, and since something else is taken for it, which hides it.
    pub(super) fn of_itself_or_mistaken(&self, landmark: usize) -> [f64; 2] {
        let of_another = self.share_of_another();
        match self.shares.get(landmark).copied().flatten() {
            Some(Seeing { share, counts: Counts::Clear | Counts::Beyond }) => [(1.0 - of_another) * share, of_another],
            // That there is a sighting is then given.
            Some(Seeing { share, counts: Counts::Not }) => {
                let reported = (1.0 - of_another) * share + of_another;
                [1.0 - of_another / reported, of_another / reported]
            }
            None => [1.0 - self.share_false, self.share_false],
        }
    }

    /// Standard deviations of a landmark's distance and bearing.
    fn uncertain(&self, view: &View, landmark: usize, distance_m: f64, belief: &Belief) -> [f64; 2] {
        let d = distance_m.max(0.05);
        let [ux, uy] = self.towards(view, landmark, belief).map(|it| it / d);
        let sd = |h: RowVector3<f64>| (h * belief.covariance * h.transpose()).x.max(0.0).sqrt();
        by_pose([ux, uy], d, view.out(belief.mean.z).1).map(sd)
    }

    /// Whether a landmark is as likely to be seen two standard deviations of the pose to either side.
    fn counts(&self, view: &View, i: usize, landmark: usize, belief: &Belief) -> Counts {
        let sight = self.sight(view, i, landmark, belief);
        let [far, off] = self.uncertain(view, landmark, sight.distance_m, belief).map(|sd| 2.0 * sd);
        if self.shape.is_beyond(sight.off_rad.abs() - off - WELL_OUTSIDE_RAD) {
            return Counts::Beyond;
        }
        let share = |far_m: f64, off_rad: f64| {
            let bin = self.shape.bin(sight.distance_m + far_m, sight.off_rad + off_rad);
            bin.map(|bin| self.seen[bin])
        };
        let here = share(0.0, 0.0);
        let is_like =
            |(far_m, off_rad)| share(far_m, off_rad).zip(here).is_some_and(|(it, here)| (it - here).abs() < 0.15);
        let clear = [(far, 0.0), (-far, 0.0), (0.0, off), (0.0, -off)].into_iter().all(is_like);
        if clear { Counts::Clear } else { Counts::Not }
    }
}
