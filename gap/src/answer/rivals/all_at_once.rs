//! Every effect's size fitted together; the largest wins.

use asami_dataset::{Log, Seed};
use asami_math::cma_es::{Until, minimise};

use crate::answer::contest::{CannotDiagnose, Diagnoses, Judges};
use crate::answer::diagnosis::Diagnosis;
use crate::plant::{Planted, Variant};

/// What calibrating a simulator against a log does to find causes: all parameters at once, by the
/// [CMA-ES](asami_math::cma_es), and the one that ends farthest from its null value is blamed.
pub struct AllAtOnce<'a> {
    /// The likelihood of logs.
    pub judges: &'a dyn Judges,
    /// The effects that may be blamed.
    pub variants: Vec<Variant>,
    /// Likelihoods that it may ask for of one log.
    pub evaluations: usize,
}

/// One number of the search: an effect with its choices made; its sign says which side of the null value.
struct Axis {
    up: Option<Variant>,
    down: Option<Variant>,
}

impl Axis {
    /// Variants that differ in their side alone share an axis.
    fn all(variants: &[Variant]) -> Vec<Self> {
        let mut axes: Vec<Self> = Vec::new();
        for variant in variants {
            let is_twin = |axis: &&mut Axis| {
                let other = axis.up.as_ref().or(axis.down.as_ref());
                other.is_some_and(|other| other.about == variant.about && other.choices == variant.choices)
            };
            let mut fresh = Self { up: None, down: None };
            let known = axes.iter_mut().find(is_twin);
            let is_known = known.is_some();
            let axis = known.unwrap_or(&mut fresh);
            if variant.sign < 0.0 {
                axis.down = Some(variant.clone())
            } else {
                axis.up = Some(variant.clone())
            }
            if !is_known {
                axes.push(fresh);
            }
        }
        axes
    }

    /// At a signed multiple of the law's middle size; what lies beyond its greatest is that. `None`: nothing.
    fn at(&self, x: f64) -> Option<Planted> {
        let chosen =
            if x < 0.0 { self.down.as_ref().or(self.up.as_ref()) } else { self.up.as_ref().or(self.down.as_ref()) };
        let variant = chosen?.clone();
        let (least, greatest) = variant.sizes();
        let size = (x.abs() * (least * greatest).sqrt()).min(greatest);
        (size > 0.0).then_some(Planted { variant, size })
    }
}

impl Diagnoses for AllAtOnce<'_> {
    fn name(&self) -> &str {
        "all_at_once"
    }

    fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotDiagnose> {
        let likelihood = self.judges.of(log)?;
        let axes = Axis::all(&self.variants);
        let planted = |x: &[f64]| axes.iter().zip(x).filter_map(|(axis, x)| axis.at(*x)).collect::<Vec<_>>();
        let misfit = |x: &[f64]| -likelihood.log_likelihood(&planted(x));
        let until = Until { evaluations: self.evaluations, tolerance: 0.1 };
        let mut rng = Seed(0).stream("all_at_once");
        let found = minimise(misfit, &vec![0.0; axes.len()], 0.3, until, &mut rng);
        // Relative to the law: 1 is its middle on a logarithmic scale.
        let relative = |planted: &Planted| {
            let (least, greatest) = planted.variant.sizes();
            planted.size / (least * greatest).sqrt()
        };
        let fitted = planted(&found.at);
        let largest = fitted.into_iter().max_by(|a, b| relative(a).total_cmp(&relative(b)));
        let named = largest.filter(|planted| planted.size >= planted.variant.sizes().0);
        Ok(Diagnosis::flat(named.as_slice()))
    }
}
