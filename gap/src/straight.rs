//! A judge for tests, in whose logs nothing bends: measurements of unit noise, which effects move in proportion to their sizes.

use asami_dataset::Seed;
use asami_sim::effects::catalogue;
use rand::RngExt;
use rand_distr::StandardNormal;

use crate::directions::Direction;
use crate::judge::{Channel, Judge, Moment, Reading, Regime};
use crate::plant::{Planted, Variant};

/// Measurements in a log.
const MEASURED: usize = 400;

/// A log, and by how much each kind of effect, of size 1, moves each measurement.
pub(crate) struct Straight {
    kinds: Vec<Variant>,
    by: Vec<Vec<f64>>,
    pub measured: Vec<f64>,
    /// One a second.
    moments: Vec<Moment>,
}

impl Straight {
    /// A log of these effects' kinds, each at a size, with what the greatest size of each does at a time.
    pub fn new(planted: &[Planted], waves: &[&dyn Fn(usize) -> f64], seed: Seed) -> Self {
        let kinds: Vec<Variant> = planted.iter().map(|it| it.variant.clone()).collect();
        let of = |(kind, wave): (&Variant, &&dyn Fn(usize) -> f64)| {
            (0..MEASURED).map(|t| wave(t) / kind.sizes().1).collect::<Vec<f64>>()
        };
        let by = kinds.iter().zip(waves).map(of).collect();
        let moments = (0..MEASURED).map(|t| Moment { t_s: t as f64, seen: 1 }).collect();
        let mut log = Self { kinds, by, measured: vec![0.0; MEASURED], moments };
        let sizes = log.numbers(planted);
        let mut rng = seed.stream("noise");
        log.measured = (0..MEASURED).map(|t| log.made(&sizes, t) + rng.sample::<f64, _>(StandardNormal)).collect();
        log
    }

    /// The first kind of an effect, by its name.
    pub fn kind(name: &str) -> Variant {
        Variant::of(catalogue().into_iter().find(|it| it.name == name).unwrap(), 4).remove(0)
    }

    /// How a kind of effect moves the measurements.
    pub fn by(&self, kind: &Variant) -> &[f64] {
        &self.by[self.kinds.iter().position(|it| it == kind).unwrap()]
    }

    /// What sizes make of a measurement, but for the noise.
    pub fn made(&self, sizes: &[f64], t: usize) -> f64 {
        sizes.iter().zip(&self.by).fold(0.0, |sum, (size, by)| sum + size * by[t])
    }
}

impl Judge for Straight {
    fn numbers(&self, planted: &[Planted]) -> Vec<f64> {
        let of = |kind: &Variant| planted.iter().filter(|it| it.variant == *kind).map(|it| it.size).sum();
        self.kinds.iter().map(of).collect()
    }

    fn knows(&self, variant: &Variant) -> bool {
        self.kinds.contains(variant)
    }

    fn read(&self, numbers: &[f64]) -> Reading {
        let off = |t: usize| self.measured[t] - self.made(numbers, t);
        let log_likelihoods = (0..self.measured.len()).map(|t| -0.5 * off(t) * off(t)).collect();
        Reading { log_likelihoods, ..Reading::default() }
    }

    fn steps(&self) -> &[Moment] {
        &self.moments
    }

    fn length_s(&self) -> f64 {
        0.0
    }

    fn measured(&self) -> Vec<&'static str> {
        Vec::new()
    }

    fn directions(&self, _: &[f64], _: &str) -> Vec<Direction> {
        Vec::new()
    }

    fn channels(&self) -> Vec<Channel> {
        Vec::new()
    }

    fn regimes(&self) -> Vec<Regime> {
        Vec::new()
    }
}
