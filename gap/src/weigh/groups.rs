//! What a log can split: how far apart two hypotheses' predictions lie, in nats.
//!
//! A hypothesis's signature is the change of the whitened innovations that it brings, with the changes of
//! their scales and of the shares of false and missed sightings, each in units in which half the squared
//! length of a difference is the expected log-likelihood ratio (Kullback and Leibler 1951, to second order).

use std::collections::BTreeMap;

use asami_math::elementary::{asin, exp, ln, logistic};

use crate::judge::{Judge, Reading, Share};
use crate::plant::{Planted, Variant};
use crate::weigh::evidence::Weighed;

/// Hypotheses that part by less than this cannot be told apart.
pub const SPLIT_NATS: f64 = 3.0;
/// Evidence at which an effect would have shown.
const VISIBLE_NATS: f64 = 12.0;
/// A signature shorter than this is no signature.
const FAINT_NATS: f64 = 1.5;

/// The change that a hypothesis brings.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature(Vec<f64>);

impl Signature {
    /// Of one hypothesis against another: the same log read under both.
    #[must_use]
    pub fn new(base: &Reading, with: &Reading) -> Self {
        let sqrt_2 = std::f64::consts::SQRT_2;
        let mut signature = Vec::with_capacity(2 * base.innovations.len() + base.shares.len());
        for (before, after) in base.innovations.iter().zip(&with.innovations) {
            // What is taken to be of something else says nothing.
            let counts = before.genuine && after.genuine;
            signature.push(if counts { after.white - before.white } else { 0.0 });
            signature.push(if counts { sqrt_2 * (after.ln_scale - before.ln_scale) } else { 0.0 });
        }
        // The length of an arc: the angle arcsin(sqrt p) stabilises a share's variance to 1/4n.
        let arc = |share: &Share| asin(logistic(share.log_odds).sqrt());
        for (before, after) in base.shares.iter().zip(&with.shares) {
            signature.push(2.0 * before.trials.sqrt() * (arc(after) - arc(before)));
        }
        Self(signature.into_iter().map(|it| if it.is_finite() { it } else { 0.0 }).collect())
    }

    /// Expected log-likelihood ratio over the base, in nats.
    #[must_use]
    pub fn nats(&self) -> f64 {
        0.5 * self.0.iter().fold(0.0, |sum, it| sum + it * it)
    }

    /// What is left of it, in nats, once the best multiple of another between 0 and `most` is taken away.
    #[must_use]
    pub fn beyond(&self, other: &Self, most: f64) -> f64 {
        let squares = other.0.iter().fold(0.0, |sum, it| sum + it * it);
        let product = self.0.iter().zip(&other.0).fold(0.0, |sum, (a, b)| sum + a * b);
        let b = if squares > 0.0 { (product / squares).clamp(0.0, most) } else { 0.0 };
        0.5 * self.0.iter().zip(&other.0).fold(0.0, |sum, (a, o)| sum + (a - b * o) * (a - b * o))
    }
}

/// Signatures of single effects at their most likely sizes.
#[must_use]
pub fn signatures<'a>(judge: &dyn Judge, weighed: impl Iterator<Item = &'a Weighed>) -> Vec<Signature> {
    let base = judge.read(&judge.numbers(&[]));
    let of = |weighed: &Weighed| {
        let numbers = judge.numbers(std::slice::from_ref(&weighed.best));
        Signature::new(&base, &judge.read(&numbers))
    };
    weighed.map(of).collect()
}

/// By how much two effects part in nats, each at its most likely size and the other at whatever size is nearest.
#[must_use]
pub fn apart([a, b]: [&Weighed; 2], [of_a, of_b]: [&Signature; 2]) -> f64 {
    let most = |weighed: &Weighed| weighed.best.variant.sizes().1 / weighed.best.size;
    of_a.beyond(of_b, most(b)).min(of_b.beyond(of_a, most(a)))
}

/// Groups, of two and more, of effects that this log cannot split at the sizes found.
#[must_use]
pub fn groups(judge: &dyn Judge, weighed: &[&Weighed]) -> Vec<Vec<String>> {
    let signatures = signatures(judge, weighed.iter().copied());
    let mut group: Vec<usize> = (0..weighed.len()).collect();
    for i in 0..weighed.len() {
        for j in 0..i {
            let seen = signatures[i].nats() > FAINT_NATS && signatures[j].nats() > FAINT_NATS;
            let nats = apart([weighed[i], weighed[j]], [&signatures[i], &signatures[j]]);
            if seen && nats < SPLIT_NATS {
                let (from, to) = (group[i], group[j]);
                group.iter_mut().filter(|it| **it == from).for_each(|it| *it = to);
            }
        }
    }
    let members = |g: usize| -> Vec<String> {
        (0..weighed.len()).filter(|i| group[*i] == g).map(|i| weighed[i].effect.to_owned()).collect()
    };
    (0..weighed.len()).map(members).filter(|members| members.len() > 1).collect()
}

/// By `NAME.PARAM`, over the kinds of each effect the easiest to see, the smallest size that a log would have shown.
#[must_use]
pub fn smallest_visible(judge: &dyn Judge, variants: &[Variant]) -> BTreeMap<String, f64> {
    let nominal = judge.read(&judge.numbers(&[]));
    let mut smallest: BTreeMap<String, f64> = BTreeMap::new();
    for variant in variants.iter().filter(|variant| judge.knows(variant)) {
        let key = format!("{}.{}", variant.about.name, variant.sized().0);
        let planted = Planted { variant: variant.clone(), size: variant.sizes().1 };
        let size = visible(judge, &nominal, &planted, VISIBLE_NATS);
        smallest.entry(key).and_modify(|known| *known = known.min(size)).or_insert(size);
    }
    smallest
}

/// Distance from the null value at which a kind of effect would be expected to gain `nats`; it grows as the size's
/// square, from a first look at the middle of its law.
#[must_use]
fn visible(judge: &dyn Judge, nominal: &Reading, planted: &Planted, nats: f64) -> f64 {
    let gain = |size: f64| {
        let numbers = judge.numbers(&[Planted { size, ..planted.clone() }]);
        Signature::new(nominal, &judge.read(&numbers)).nats()
    };
    let (least, greatest) = planted.variant.sizes();
    let scaled = |size: f64| size * (nats / gain(size).max(1e-6)).sqrt();
    let first = scaled(exp(0.5 * (ln(least) + ln(greatest)))).clamp(least, greatest);
    scaled(first)
}
