//! What the key says of a case: what was planted, and how far this log tells it from everything else, by one
//! likelihood that is the same for all diagnosers.

use asami_gap::{Likelihood, Planted, Variant};
use asami_math::elementary::{exp, ln};
use asami_math::optimise::golden_section;
use serde::{Deserialize, Serialize};

use super::scenario::Asked;
use super::withhold::Unlisted;

/// Sizes at which every kind of effect is tried.
const GRID: usize = 5;
/// Kinds that are looked at more finely: the best of the grid.
const REFINED: usize = 3;
/// Effects whose predictions part by less than this, at the sizes found, are one group.
const SPLIT_NATS: f64 = 3.0;
/// Half of all errors are smaller than so many standard deviations.
pub const HALF_SD: f64 = 0.67;
/// The information about a size is taken from sizes that are larger and smaller by so much of its logarithm.
const STEP: f64 = 0.1;

/// A planted effect in the key's words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Its name.
    pub name: String,
    /// Where it acts.
    pub place: String,
    /// Which flexible block it would show in.
    pub block: String,
    /// The sized parameter.
    pub parameter: String,
    /// Its value.
    pub value: f64,
    /// Its distance from the null value.
    pub size: f64,
    /// Least and greatest size of its law.
    pub sizes: (f64, f64),
    /// Effects that this log cannot tell from it, itself among them.
    pub group: Vec<String>,
}

/// What the key says of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// What was planted, in the catalogue's order.
    pub effects: Vec<Effect>,
    /// Log-likelihood of the log in the nominal world.
    pub none: f64,
    /// In the true world; `None` where something is in it that the catalogue has no name for.
    pub truth: Option<f64>,
    /// `l(truth) - l(none)`, each less its half `k log n`.
    pub d_det: Option<f64>,
    /// `l(truth)` less the best of the hypotheses outside the truth's group, each less its half `k log n`; without an
    /// effect, *none* is the truth.
    pub d_sep: Option<f64>,
    /// What the least evident effect shows beside the others: `l(truth)` less the best of the hypotheses that lack it and
    /// keep the others, at any sizes, each less its half `k log n`. Of one effect it is `d_det`.
    #[serde(default)]
    pub d_each: Option<f64>,
    /// Of a single effect: the error of its size, as a share of it, that the best there can be exceeds in half of all such logs.
    #[serde(default)]
    pub least_error: Option<f64>,
    /// Observations.
    pub observations: usize,
}

/// A hypothesis with its penalised log-likelihood.
struct Scored {
    planted: Vec<Planted>,
    score: f64,
}

/// Judges a case of `planted`; `variants` are all kinds of the catalogue that fit.
#[must_use]
pub fn judge(likelihood: &dyn Likelihood, planted: &[Planted], variants: &[Variant], asked: &Asked) -> Reference {
    let observations = likelihood.observations();
    // Half k log n (Schwarz 1978), one size for each effect.
    let cost = |effects: &[Planted]| 0.5 * effects.len() as f64 * ln(observations.max(1) as f64);
    let score = |effects: &[Planted]| likelihood.log_likelihood(effects) - cost(effects);
    let (none, truth) = (likelihood.log_likelihood(&[]), likelihood.log_likelihood(planted));
    let mut rivals = vec![Scored { planted: Vec::new(), score: none }];
    for kept in kept(planted) {
        let mut tried: Vec<Scored> = Vec::new();
        for variant in variants.iter().filter(|it| !kept.iter().any(|planted| planted.variant.about == it.about)) {
            tried.extend(coarse(variant, &kept, &score));
        }
        tried.sort_by(|a, b| b.score.total_cmp(&a.score));
        let finer = tried.iter().take(REFINED).map(|found| finer(found, &score));
        let finer: Vec<Scored> = finer.collect();
        rivals.extend(tried);
        rivals.extend(finer);
    }
    let effects: Vec<Effect> = (0..planted.len()).map(|i| effect(likelihood, planted, i, &rivals, asked)).collect();
    let of_truth: Vec<&Effect> = effects.iter().collect();
    let outside = rivals.iter().filter(|rival| !stands_for(&names(&rival.planted), &of_truth));
    let best = outside.map(|rival| rival.score).fold(f64::NEG_INFINITY, f64::max);
    let d_det = (!planted.is_empty()).then(|| score(planted) - none);
    let lacking = (0..planted.len()).map(|i| lacking(planted, i, &score)).reduce(f64::max);
    Reference {
        effects,
        none,
        truth: Some(truth),
        d_det,
        d_sep: Some(score(planted) - best),
        d_each: lacking.map(|lacking| score(planted) - lacking),
        least_error: least_error(likelihood, planted),
        observations,
    }
}

/// Judges a case whose truth the catalogue has no name for, and the referee no likelihood: only where it acts is known.
#[must_use]
pub fn judge_unlisted(likelihood: &dyn Likelihood, unlisted: &[Unlisted]) -> Reference {
    let effect = |it: &Unlisted| Effect {
        name: it.name.clone(),
        place: it.place.clone(),
        block: it.block.clone(),
        parameter: "size".to_owned(),
        value: it.size,
        size: it.size,
        sizes: (it.size, it.size),
        group: vec![it.name.clone()],
    };
    Reference {
        effects: unlisted.iter().map(effect).collect(),
        none: likelihood.log_likelihood(&[]),
        truth: None,
        d_det: None,
        d_sep: None,
        d_each: None,
        least_error: None,
        observations: likelihood.observations(),
    }
}

/// [`HALF_SD`] standard deviations of a size by the bound of Cramer (1946) and Rao (1945), over the size: its information is what
/// parts predictions under sizes to both sides. `None` where it is more than the size.
fn least_error(likelihood: &dyn Likelihood, planted: &[Planted]) -> Option<f64> {
    let [of] = planted else { return None };
    let (least, greatest) = of.variant.sizes();
    let beside = |step: f64| Planted { size: (of.size * exp(step)).clamp(least, greatest), ..of.clone() };
    let [below, above] = [-STEP, STEP].map(beside);
    let apart = (above.size - below.size) / of.size;
    let nats = likelihood.apart(&[below], &[above]);
    let error = HALF_SD * apart / (2.0 * nats).sqrt();
    (error < 1.0).then_some(error)
}

/// The best score without the `i`-th effect: of two, the other one is free to be of any size.
fn lacking(planted: &[Planted], i: usize, score: &dyn Fn(&[Planted]) -> f64) -> f64 {
    let rest: Vec<Planted> = planted.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, it)| it.clone()).collect();
    let free = match &rest[..] {
        [only] => coarse(&only.variant, &[], score).map(|found| finer(&found, score).score),
        _ => None,
    };
    free.unwrap_or(f64::NEG_INFINITY).max(score(&rest))
}

/// By how many nats a log speaks for one effect over another, each alone, of whatever kind and size its law has.
#[must_use]
pub fn speaks_for(likelihood: &dyn Likelihood, [one, other]: [&str; 2], variants: &[Variant]) -> f64 {
    let score = |effects: &[Planted]| likelihood.log_likelihood(effects);
    let best = |name: &str| {
        let kinds = variants.iter().filter(|variant| variant.about.name == name);
        let found = kinds.filter_map(|variant| coarse(variant, &[], &score)).map(|found| finer(&found, &score).score);
        found.fold(f64::NEG_INFINITY, f64::max)
    };
    best(one) - best(other)
}

/// What stays of the truth while another effect is tried: nothing, and of two effects each.
fn kept(planted: &[Planted]) -> Vec<Vec<Planted>> {
    let one_each = planted.iter().filter(|_| planted.len() > 1).map(|it| vec![it.clone()]);
    [Vec::new()].into_iter().chain(one_each).collect()
}

fn names(planted: &[Planted]) -> Vec<String> {
    planted.iter().map(|planted| planted.variant.about.name.to_owned()).collect()
}

/// Whether effects of these names are the truth, one for one, or what cannot be told from it.
#[must_use]
pub fn stands_for(names: &[String], truth: &[&Effect]) -> bool {
    let is_of = |name: &String, effect: &Effect| effect.group.contains(name);
    match (names, truth) {
        ([], []) => true,
        ([name], [effect]) => is_of(name, effect),
        ([a, b], [one, two]) => (is_of(a, one) && is_of(b, two)) || (is_of(a, two) && is_of(b, one)),
        _ => false,
    }
}

/// The best of a grid of sizes.
fn coarse(variant: &Variant, kept: &[Planted], score: &dyn Fn(&[Planted]) -> f64) -> Option<Scored> {
    let (least, greatest) = variant.sizes();
    let at = |i: usize| least * exp(ln(greatest / least) * i as f64 / (GRID - 1) as f64);
    let set = |size: f64| [kept, &[Planted { variant: variant.clone(), size }]].concat();
    let tried = (0..GRID).map(|i| set(at(i))).map(|planted| Scored { score: score(&planted), planted });
    tried.filter(|found| found.score.is_finite()).max_by(|a, b| a.score.total_cmp(&b.score))
}

/// The same kind at the best size between the grid's neighbours.
fn finer(found: &Scored, score: &dyn Fn(&[Planted]) -> f64) -> Scored {
    let mut planted = found.planted.clone();
    let Some(last) = planted.pop() else { return Scored { planted, score: found.score } };
    let (least, greatest) = last.variant.sizes();
    let set = |ln_size: f64| [&planted[..], &[Planted { size: exp(ln_size), ..last.clone() }]].concat();
    let step = ln(greatest / least) / (GRID - 1) as f64;
    let (from, to) = ((ln(last.size) - step).max(ln(least)), (ln(last.size) + step).min(ln(greatest)));
    let best = golden_section(|ln_size| -score(&set(ln_size)), from, to, 0.1 * step);
    let planted = set(best.x);
    Scored { planted, score: (-best.value).max(found.score) }
}

/// The `i`-th planted effect with its group: what the scenario says acts alike, and what acts alike here.
fn effect(likelihood: &dyn Likelihood, planted: &[Planted], i: usize, rivals: &[Scored], asked: &Asked) -> Effect {
    let Planted { variant, size } = &planted[i];
    let name = variant.about.name;
    let mut group: Vec<String> = asked.group(name).into_iter().map(str::to_owned).collect();
    // Its place in the truth taken by another.
    let rest: Vec<Planted> = planted.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, it)| it.clone()).collect();
    let mut best: std::collections::BTreeMap<&str, &Scored> = std::collections::BTreeMap::new();
    for rival in rivals {
        let Some((last, _)) = rival.planted.split_last().filter(|(_, kept)| **kept == rest[..]) else { continue };
        let known = best.entry(last.variant.about.name).or_insert(rival);
        if rival.score > known.score {
            *known = rival;
        }
    }
    for (other, rival) in best {
        if other != name && likelihood.apart(planted, &rival.planted) < SPLIT_NATS {
            group.push(other.to_owned());
        }
    }
    group.sort();
    group.dedup();
    let (parameter, null) = variant.sized();
    Effect {
        name: name.to_owned(),
        place: variant.place().name().to_owned(),
        block: variant.block().name().to_owned(),
        parameter: parameter.to_owned(),
        value: null + variant.sign * size,
        size: *size,
        sizes: variant.sizes(),
        group,
    }
}
