//! What is planted in which case: everything follows from the salt.

use asami_dataset::{Dataset, Rng, Seed};
use asami_gap::Planted;
use asami_sim::effect::About;
use asami_sim::effects::{Effects, catalogue};
use rand::{RngExt, SeedableRng};

use crate::scenario::Simulation;
use crate::simulate::CannotSimulate;

asami_dataset::parameters! {
    /// How many effects are planted in a case: two in the share that is left.
    pub struct Mix {
        /// Share of the cases with no effect.
        none_share: f64 = 0.34, "1", 0.0..=1.0;
        /// Share of the cases with one.
        one_share: f64 = 0.5, "1", 0.0..=1.0;
    }
}

/// How cases are planted.
#[derive(Clone, Debug, PartialEq)]
pub struct Planting {
    /// The nominal world, with the length of its logs.
    pub nominal: Simulation,
    /// What every draw follows from.
    pub salt: String,
    /// How many effects.
    pub mix: Mix,
    /// Only effects that act at one of these places; of none: at any.
    pub places: Vec<String>,
}

/// One case: what is in it, and the seed of its commands, its start and every noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// From 1.
    pub number: usize,
    /// In the catalogue's order; no effect stands here twice.
    pub planted: Vec<Planted>,
    /// The seed of the simulation.
    pub seed: Seed,
}

impl Planting {
    /// The case of a number. Cases are drawn independently of each other, so that neither their order
    /// nor their count says anything.
    #[must_use]
    pub fn case(&self, number: usize) -> Case {
        let mut rng = stream("asami 2026 withheld case", &self.salt, number);
        let count = match rng.random::<f64>() {
            u if u < self.mix.none_share => 0,
            u if u < self.mix.none_share + self.mix.one_share => 1,
            _ => 2,
        };
        let mut rest = self.candidates();
        let mut planted: Vec<(usize, Planted)> = Vec::new();
        while planted.len() < count && !rest.is_empty() {
            let (place, about) = rest.swap_remove(rng.random_range(0..rest.len()));
            planted
                .extend(Planted::draw(about, self.nominal.field.beacons.len(), &mut rng).map(|drawn| (place, drawn)));
        }
        planted.sort_by_key(|(place, _)| *place);
        let planted = planted.into_iter().map(|(_, drawn)| drawn).collect();
        // One bit less than there are: TOML's integers have a sign.
        Case { number, planted, seed: Seed(rng.random::<u64>() >> 1) }
    }

    /// The seed of another log of the same world.
    #[must_use]
    pub fn seed_of_next(&self, number: usize) -> Seed {
        Seed(stream("asami 2026 next log", &self.salt, number).random::<u64>() >> 1)
    }

    /// Effects that may be planted, with their places in the catalogue: those that fit the robot, have a law and
    /// are not nominally on.
    fn candidates(&self) -> Vec<(usize, &'static About)> {
        let is_on = |about: &About| self.nominal.effects.iter().any(|effect| effect.about().name == about.name);
        let fits = |(_, about): &(usize, &'static About)| {
            let placed = self.places.is_empty() || self.places.iter().any(|place| place == about.place.name());
            placed && about.fits.contains(&self.nominal.robot.name()) && !about.law.is_empty() && !is_on(about)
        };
        catalogue().into_iter().enumerate().filter(fits).collect()
    }

    /// Simulates a case: its log names no effect, and carries no provenance.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn simulate(&self, case: &Case, scenario: &str) -> Result<Dataset, CannotSimulate> {
        let mut simulation = self.nominal.clone();
        case.planted.iter().for_each(|planted| planted.variant.plant(planted.size, &mut simulation.effects));
        let mut dataset = simulation.dataset(case.seed)?;
        let mut known = (*dataset.log.known).clone();
        known.nominal = Some(scenario.to_owned());
        dataset.log.known = known.into();
        dataset.provenance = None;
        Ok(dataset)
    }
}

impl Case {
    /// The planted effects alone, as a scenario's `[effects]`.
    #[must_use]
    pub fn effects(&self) -> Effects {
        let mut effects = Effects::default();
        self.planted.iter().for_each(|planted| planted.variant.plant(planted.size, &mut effects));
        effects
    }
}

/// A number from 0 to 1 for each case and question, independent of all that is in it.
pub(super) fn chance(of: &str, salt: &str, number: usize) -> f64 {
    stream(of, salt, number).random()
}

/// A hash that cannot be turned round, so that no case tells of the salt or of another case.
fn stream(of: &str, salt: &str, number: usize) -> Rng {
    let mut hasher = blake3::Hasher::new_derive_key(of);
    hasher.update(&(number as u64).to_le_bytes()).update(salt.as_bytes());
    Rng::from_seed(*hasher.finalize().as_bytes())
}
