//! How the nominal world answers: learned from its runs with their truth, and polished without.

use asami_dataset::{Dataset, Seed};
use asami_math::elementary::{logistic, logit};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::swaying::swaying;
use super::{Budget, CannotLearn, FIRST_SEED, Library, play};
use crate::blocks::polished;
use crate::columns::Group;
use crate::fit::{self, remembered};
use crate::judge::Judge;
use crate::memory::Memory;
use crate::nominal::{CannotPlay, Nominal};
use crate::rhythm::Rhythm;
use crate::shape::{Numbers, STANDING, Shape};
use crate::sighted::Sighted;
use crate::tails::Tails;
use crate::touch::Touch;

/// In these blocks, one after another.
const POLISHED_BLOCKS: [&str; 6] = ["noise", "sensor", "timing", "noise", "sensor", "timing"];
/// What an effect changes, in these.
const PLAYED_BLOCKS: [&str; 5] = ["noise", "sensor", "static_motion", "timing", "noise"];
/// Of so many nominal logs the likelihood is made greatest.
const POLISHED: usize = 16;
/// On so many of them sways are learned.
const SWAYING: usize = 8;

/// The nominal response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// What the numbers mean.
    pub shape: Shape,
    /// The numbers.
    pub numbers: Vec<f64>,
    /// What the runs with their truth show of them.
    pub(super) fitted: Vec<f64>,
    /// What those of them show whose seeds runs with effects have, from which effects' changes are counted.
    pub(super) alike: Vec<f64>,
    /// What of every log is taken away first.
    pub rhythm: Rhythm,
    /// How innovations hang on those before them.
    pub memory: Memory,
}

impl Base {
    /// Plays and learns the nominal response.
    ///
    /// # Errors
    /// If the world cannot be played, or nothing is seen in it.
    pub fn learn(nominal: &dyn Nominal, budget: &Budget) -> Result<Self, CannotLearn> {
        let seeds: Vec<u64> = (0..budget.nominal_runs).collect();
        let runs: Result<Vec<Dataset>, CannotPlay> =
            seeds.into_par_iter().map(|i| play(nominal, &[], Seed(FIRST_SEED + i), budget.run_s)).collect();
        let runs = runs?;
        let base = Self::of(&runs).ok_or(CannotLearn::Blind)?;
        Ok(Self { alike: base.alike(&runs[..runs.len().min(budget.runs as usize)]), ..base })
    }

    /// What these runs show by themselves, if wheels take the same noise from a seed whatever effect there is: counted from what all show,
    /// every effect would change what the noise of its own few runs happens to be, and the more of them are named, the more of that would be
    /// there. Gaits soon part ways.
    fn alike(&self, runs: &[Dataset]) -> Vec<f64> {
        let rolls = self.shape.columns.rolls();
        if rolls { fit::nominal(&self.shape, &self.rhythm, runs) } else { self.fitted.clone() }
    }

    /// The response that runs of the nominal world show; `None` where no landmark is seen in them.
    #[must_use]
    pub fn of(runs: &[Dataset]) -> Option<Self> {
        let shape = fit::as_fine_as_shown(fit::shape(runs)?, runs);
        let shape = Shape { columns: shape.columns.knowing(&fit::motion_alone(&shape, runs)), ..shape };
        let rhythm = fit::rhythm(&shape, runs);
        let numbers = fit::nominal(&shape, &rhythm, runs);
        let memory = remembered(&shape, &rhythm, &numbers, runs);
        let mut base = Self { shape, fitted: numbers.clone(), alike: numbers.clone(), numbers, rhythm, memory };
        if base.memory.sways() {
            (base.numbers, base.memory) = base.swaying(runs);
        }
        (base.memory.spread, base.memory.tails) = base.scatter(runs);
        let held = base.of_standing_wheels();
        base.numbers = base.polished(&base.numbers, runs, &POLISHED_BLOCKS, &|i| !held.contains(&i));
        if !base.memory.sways() {
            // None seen in nominal runs is no proof that there are none: the least share that was counted stays.
            let of_false = base.shape.range(Numbers::False);
            base.numbers[of_false.clone()].copy_from_slice(&base.fitted[of_false]);
        }
        base.memory.spread = [1.0; 2];
        (base.memory.spread, base.memory.tails) = base.scatter(runs);
        if base.memory.sways() {
            // What effects change is made most likely under these: where the nominal response is not, each of them gains what that lacks.
            base.numbers = base.polished(&base.numbers, runs, &POLISHED_BLOCKS, &|_| true);
        }
        Some(base)
    }

    /// How noisy wheels are that stand: in Rapier not at all, so that likelihoods would have what still rolls be lost.
    fn of_standing_wheels(&self) -> std::ops::Range<usize> {
        let start = self.shape.range(Numbers::MotionNoise).start + 3 * STANDING;
        start..start + if self.shape.columns.rolls() { 3 } else { 0 }
    }

    /// How sightings sway at each pace, and how noisy motion is beside it.
    fn swaying(&self, runs: &[Dataset]) -> (Vec<f64>, Memory) {
        let alone = Library::new(self.clone(), Vec::new());
        let logs: Vec<Sighted<'_>> =
            runs.iter().take(SWAYING).filter_map(|run| Sighted::new(&run.log, &alone).ok()).collect();
        swaying(self, &logs)
    }

    /// The numbers near these that make logs most likely, block by block: how a head that follows a landmark answers to a
    /// sway, and what is left of a rhythm, shows in what a filter expects, and not in runs with their truth.
    fn polished(
        &self,
        numbers: &[f64],
        runs: &[Dataset],
        of: &[&'static str],
        free: &dyn Fn(usize) -> bool,
    ) -> Vec<f64> {
        let alone = Library::new(self.clone(), Vec::new());
        let judges: Vec<Sighted<'_>> =
            runs.iter().take(POLISHED).filter_map(|run| Sighted::new(&run.log, &alone).ok()).collect();
        let judges: Vec<&dyn Judge> = judges.iter().map(|judge| judge as &dyn Judge).collect();
        of.iter().fold(numbers.to_vec(), |numbers, block| polished(&judges, &numbers, block, free))
    }

    /// What an effect changes, of which runs with their truth gave `change`: made most likely on the same logs where sightings
    /// sway. A fit to the truth then takes for the effect's what the filter, which must tell a sway from a turn and from noise,
    /// does not make of it, and costs true causes tens of nats: it is only trusted with curves of motion, wear and shares; and,
    /// of what acts on sensing, with the curve of the size, which a few logs without truth leave tied to much else. Shares of false
    /// sightings add up as such: the nominal one, as it was polished, is far below what is counted where there are none.
    pub(super) fn played(&self, mut change: Vec<f64>, runs: &[Dataset], touch: Touch) -> Vec<f64> {
        if !self.memory.sways() {
            return change;
        }
        for i in self.shape.range(Numbers::False) {
            change[i] = grown(self.numbers[i], self.fitted[i], change[i]);
        }
        let trusted = self.trusted(touch);
        self.distrusted().filter(|i| !trusted.contains(i)).for_each(|i| change[i] = 0.0);
        let plus: Vec<f64> = self.numbers.iter().zip(&change).map(|(number, change)| number + change).collect();
        let mut blocks = PLAYED_BLOCKS.to_vec();
        // What scatters bends no curve: a few logs of it would, tied as the size is to where the robot went.
        blocks.retain(|block| *block != "sensor" || touch != Touch::Scatter);
        let polished = self.polished(&plus, runs, &blocks, &|i| !trusted.contains(&i));
        polished.iter().zip(&self.numbers).map(|(with, without)| with - without).collect()
    }

    /// The size's numbers that a fit to the truth settles: all but that of the angle off the axis, of which a head that follows
    /// landmarks sees next to nothing.
    fn trusted(&self, touch: Touch) -> Vec<usize> {
        let off_axis = self.shape.range(Numbers::Size).start + self.shape.curve_width();
        match touch {
            Touch::Sight => self.shape.range(Numbers::Size).filter(|i| *i != off_axis).collect(),
            Touch::Motion | Touch::Scatter => Vec::new(),
        }
    }

    /// What is rather found by how likely logs are than by their truth.
    fn distrusted(&self) -> impl Iterator<Item = usize> {
        let columns = &self.shape.columns;
        let n = columns.len();
        let of_sway =
            [Group::Lingering, Group::Held, Group::Turning, Group::Starting].map(|group| columns.range(group));
        let moved =
            of_sway.into_iter().flat_map(move |of| (0..3).flat_map(move |axis| axis * n + of.start..axis * n + of.end));
        let sensed = [Numbers::MotionNoise, Numbers::Size, Numbers::Bearing, Numbers::SizeNoise, Numbers::BearingNoise];
        let sensed: Vec<usize> = sensed.into_iter().flat_map(|group| self.shape.range(group)).collect();
        moved.chain(sensed)
    }

    /// How far the nominal logs' innovations scatter, once sways are taken into account, and, where there are any, how often they
    /// are far off.
    fn scatter(&self, runs: &[Dataset]) -> ([f64; 2], Tails) {
        let alone = Library::new(self.clone(), Vec::new());
        let judges = runs.iter().filter_map(|run| Sighted::new(&run.log, &alone).ok());
        let genuine = judges.flat_map(|judge| judge.filtered(&self.numbers).innovations);
        let white: Vec<[f64; 2]> = genuine.filter(|it| it.genuine > 0.5).map(|it| it.white).collect();
        let squares = |k: usize| white.iter().fold(0.0, |sum, white| sum + white[k] * white[k]);
        let n = white.len() as f64;
        let spread = [0, 1].map(|k| if n > 0.0 { (squares(k) / n).sqrt().max(0.1) } else { 1.0 });
        if !self.memory.sways() {
            return (spread, Tails::default());
        }
        let square =
            |white: &[f64; 2]| (0..2).fold(0.0, |sum, k| sum + (white[k] / spread[k]) * (white[k] / spread[k]));
        (spread, Tails::learn(&white.iter().map(square).collect::<Vec<f64>>()))
    }
}

/// The change of a share's log-odds by which it grows as much as from one that was fitted to that with a change.
fn grown(log_odds: f64, fitted: f64, change: f64) -> f64 {
    let more = logistic(fitted + change) - logistic(fitted);
    logit(logistic(log_odds) + more.max(0.0)) - log_odds
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A nominal share of one in ten thousand, where four in a thousand were fitted.
    #[test]
    fn a_share_grows_by_what_was_counted_however_small_the_nominal_one_is() {
        let (nominal, fitted) = (logit(1e-4), logit(4e-3));
        for share in [0.005, 0.02, 0.1] {
            let with = logistic(nominal + grown(nominal, fitted, logit(share) - fitted));
            assert!((with - (share - 4e-3 + 1e-4)).abs() < 1e-12, "{share}: {with}");
        }
        assert!(grown(nominal, fitted, 0.0).abs() < 1e-9);
        assert!(grown(nominal, fitted, -1.0).abs() < 1e-9, "what is counted less often than nominally adds nothing");
    }
}
