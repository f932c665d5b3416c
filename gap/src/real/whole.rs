//! All effects at once, then one less after another.
//!
//! What is named one after another is named beside what was there before: of effects that act much alike that which comes first makes
//! up for the others, none of them then shows beside it, and no step leads from there to where all have their sizes. With all of
//! them in the world, each at whatever size and sign is likeliest, nothing has to make up for anything. Then that goes which is missed
//! least, until each that is left is missed (from general to specific: Hendry 1995, "Dynamic Econometrics").

use super::layers::Least;
use crate::judge::Judge;
use crate::newton::{Curvature, climb};
use crate::plant::{Planted, Variant};

/// Steps of Newton's method with all in the world, and once one has gone.
const STEPS: usize = 25;
const FEWER_STEPS: usize = 12;
/// A step that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 0.05;
/// Differences are taken over such a share of a size's unit.
const DIFFERENCE: f64 = 0.05;
/// No step changes a size by more, in its unit.
const LONGEST: f64 = 1.0;
/// Smaller sizes, in their unit, are none.
const NOTHING: f64 = 1e-9;
/// Of so many that seem to be missed least that goes which is.
const TRIED: usize = 3;

/// An effect of any size to either side of nothing, as far as it has sides.
#[derive(Clone, Copy)]
struct Knob<'a> {
    below: Option<&'a Variant>,
    above: Option<&'a Variant>,
    /// Signed, in units.
    size: f64,
}

impl<'a> Knob<'a> {
    /// Each of these kinds in one with its other side, at the sizes that are planted.
    fn all(variants: impl Iterator<Item = &'a Variant>, planted: &[Planted]) -> Vec<Self> {
        let mut knobs: Vec<Self> = Vec::new();
        for variant in variants {
            let same = knobs.iter().position(|it| it.kinds().any(|kind| is_like(kind, variant)));
            let at = same.unwrap_or(knobs.len());
            if same.is_none() {
                knobs.push(Self { below: None, above: None, size: 0.0 });
            }
            let knob = &mut knobs[at];
            *(if variant.sign < 0.0 { &mut knob.below } else { &mut knob.above }) = Some(variant);
            if let Some(it) = planted.iter().find(|it| it.variant == *variant) {
                knob.size = variant.sign * it.size / knob.unit();
            }
        }
        knobs
    }

    fn kinds(&self) -> impl Iterator<Item = &'a Variant> {
        [self.below, self.above].into_iter().flatten()
    }

    fn sizes(&self) -> (f64, f64) {
        self.kinds().next().map_or((1.0, 1.0), Variant::sizes)
    }

    /// The middle of its law.
    fn unit(&self) -> f64 {
        let (least, greatest) = self.sizes();
        (least * greatest).sqrt()
    }

    /// The greatest size, in units.
    fn most(&self) -> f64 {
        self.sizes().1 / self.unit()
    }

    /// The same at another size, or at the end of its law.
    fn at(self, size: f64) -> Self {
        let end = |side: Option<&Variant>| if side.is_some() { self.most() } else { 0.0 };
        Self { size: size.clamp(-end(self.below), end(self.above)), ..self }
    }

    /// The same a little larger, or smaller where it is at its upper end.
    fn beside(self) -> Self {
        let larger = self.at(self.size + DIFFERENCE);
        if larger.size > self.size { larger } else { self.at(self.size - DIFFERENCE) }
    }

    fn planted(&self) -> Option<Planted> {
        let side = if self.size < 0.0 { self.below } else { self.above };
        let variant = side.filter(|_| self.size.abs() > NOTHING)?;
        Some(Planted { variant: variant.clone(), size: self.size.abs() * self.unit() })
    }
}

/// Whether two kinds are the sides of one.
fn is_like(a: &Variant, b: &Variant) -> bool {
    a.about.name == b.about.name && a.choices == b.choices
}

fn planted(knobs: &[Knob]) -> Vec<Planted> {
    knobs.iter().filter_map(Knob::planted).collect()
}

/// Effects at their likeliest sizes.
struct Fit<'a> {
    knobs: Vec<Knob<'a>>,
    /// The log-likelihood.
    likely: f64,
    /// By how much less likely the log would be without each, were it quadratic in all sizes.
    missed: Vec<f64>,
}

impl<'a> Fit<'a> {
    /// By Newton's method on sizes, of which large ones are beforehand a little less probable.
    fn new(judge: &dyn Judge, mut knobs: Vec<Knob<'a>>, steps: usize) -> Self {
        let terms = |knobs: &[Knob]| judge.terms(&judge.numbers(&planted(knobs)));
        let precisions: Vec<f64> = knobs.iter().map(|it| (it.most() * it.most()).recip()).collect();
        let strange = |knobs: &[Knob]| {
            knobs.iter().zip(&precisions).fold(0.0, |sum, (it, precision)| sum + 0.5 * precision * it.size * it.size)
        };
        let mut here = terms(&knobs);
        let mut missed = vec![0.0; knobs.len()];
        for _ in 0..steps {
            let score = |i: usize| -> Vec<f64> {
                let mut there = knobs.clone();
                there[i] = knobs[i].beside();
                let by = there[i].size - knobs[i].size;
                terms(&there).iter().zip(&here).map(|(there, here)| (there - here) / by).collect()
            };
            let scores: Vec<Vec<f64>> = (0..knobs.len()).map(score).collect();
            let Some(curvature) = Curvature::new(&scores, 0.0).and_then(|it| it.with(&precisions)) else { break };
            let squares = |(knob, var): (&Knob, f64)| 0.5 * knob.size * knob.size / var;
            missed = knobs.iter().zip(curvature.variances()).map(squares).collect();
            let slope = scores.iter().zip(&knobs).zip(&precisions);
            let slope: Vec<f64> = slope.map(|((score, it), precision)| total(score) - precision * it.size).collect();
            let step = curvature.step(&slope);
            let before = total(&here) - strange(&knobs);
            let better = climb(before, &[1.5], |share| {
                let moved = knobs.iter().zip(&step);
                let there: Vec<Knob> =
                    moved.map(|(it, step)| it.at(it.size + (share * step).clamp(-LONGEST, LONGEST))).collect();
                let of_there = terms(&there);
                (total(&of_there) - strange(&there), (there, of_there))
            });
            let Some((found, (there, of_there))) = better else { break };
            (knobs, here) = (there, of_there);
            if found - before < GAINS_NOTHING_NATS {
                break;
            }
        }
        Self { knobs, likely: total(&here), missed }
    }

    /// The same without that which is missed least, and where it was.
    fn without_one(&self, judge: &dyn Judge) -> Option<(usize, Self)> {
        let mut order: Vec<usize> = (0..self.knobs.len()).collect();
        order.sort_by(|a, b| self.missed[*a].total_cmp(&self.missed[*b]));
        let without = |i: usize| {
            let mut knobs = self.knobs.clone();
            knobs.remove(i);
            (i, Self::new(judge, knobs, FEWER_STEPS))
        };
        let tried = order.into_iter().take(TRIED).map(without);
        tried.reduce(|a, b| if b.1.likely > a.1.likely { b } else { a })
    }

    /// Whether one of these is worth its name, where the log is so likely without it.
    fn needs(&self, judge: &dyn Judge, i: usize, without: f64, least: &Least) -> bool {
        let mut with = self.knobs.clone();
        let one = with.remove(i);
        let Some(one) = one.planted() else { return false };
        let against_nats = least.kin.more_against_nats(one.variant.about.name);
        let all = [planted(&with), vec![one]].concat();
        self.likely - without >= least.gain(judge, &all, self.likely) + against_nats
    }
}

fn total(terms: &[f64]) -> f64 {
    terms.iter().fold(0.0, |sum, it| sum + it)
}

/// What is left of all effects, at sizes found together; what was found `before` where that is worth more. Kinds that differ by
/// more than their side are too many to be there at once: of those only what was found is.
#[must_use]
pub fn whole(judge: &dyn Judge, variants: &[Variant], before: &[Planted], least: &Least) -> Vec<Planted> {
    let is_found = |variant: &Variant| before.iter().any(|it| is_like(&it.variant, variant));
    let known = |variant: &&Variant| judge.knows(variant);
    let of_found = before.iter().flat_map(|it| variants.iter().filter(|kind| is_like(kind, &it.variant)));
    let together = |variant: &&Variant| {
        variant.choices.is_empty()
            && !is_found(variant)
            && !least.rules_out(variant, before)
            && !least.one_of_two(variant)
    };
    let knobs = Knob::all(of_found.chain(variants.iter().filter(together)).filter(known), before);
    let mut fit = Fit::new(judge, knobs, STEPS);
    while let Some((i, fewer)) = fit.without_one(judge) {
        if fit.needs(judge, i, fewer.likely, least) {
            break;
        }
        fit = fewer;
    }
    let found = planted(&fit.knobs);
    if least.worth(judge, &found) > least.worth(judge, before) { found } else { before.to_vec() }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::real::layers::{ANY_SHARE as LEAST, layers, planted as of_layers};
    use crate::straight::Straight;

    fn names(found: &[Planted]) -> Vec<&str> {
        found.iter().map(|it| it.variant.about.name).collect()
    }

    /// The third is nearly both of the others at once: it is named first, beside it neither of them shows, and all in the world do.
    #[test]
    fn what_makes_up_for_two_goes_once_both_are_there() {
        let kinds = ["command_scale", "wheel_base", "unequal_wheels"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let [a, b] = [0.37, 0.91].map(|step| move |t: usize| (step * t as f64).sin());
        let both = |t: usize| a(t) + b(t) + 0.4 * (1.53 * t as f64).sin();
        let log = Straight::new(&[of(0, 0.8), of(1, 0.8), of(2, 1e-6)], &[&a, &b, &both], Seed(8));
        let one_by_one = of_layers(&layers(&log, &kinds, &LEAST));
        assert_eq!(names(&one_by_one), ["unequal_wheels"]);
        let found = whole(&log, &kinds, &one_by_one, &LEAST);
        assert_eq!(names(&found), ["command_scale", "wheel_base"]);
        found.iter().enumerate().for_each(|(k, it)| assert!((it.size / of(k, 0.8).size - 1.0).abs() < 0.2, "{it:?}"));
    }

    /// Out of nothing, to whichever side.
    #[test]
    fn sides_are_found_and_what_is_not_there_is_not() {
        let [below, above] = [-1.0, 1.0].map(|sign| Variant { sign, ..Straight::kind("command_scale") });
        let kinds = [below, above, Straight::kind("wheel_base")];
        for (k, other) in [(0, 1), (1, 0)] {
            let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
            let mut truth = [of(0, 1e-6), of(1, 1e-6), of(2, 1e-6)];
            truth[k] = of(k, 0.9);
            let wave = |t: usize| (0.37 * t as f64).sin();
            let log = Straight::new(&truth, &[&|t| -wave(t), &wave, &|t| (0.91 * t as f64).cos()], Seed(3 + k as u64));
            let found = whole(&log, &kinds, &[], &LEAST);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].variant, kinds[k], "not {:?}", kinds[other]);
            assert!((found[0].size / truth[k].size - 1.0).abs() < 0.2, "{found:?}");
        }
    }

    /// What was found stays where nothing is better, with what nobody else could find: its choices.
    #[test]
    fn nothing_is_lost() {
        let kinds =
            [Variant { choices: vec![("uphill_rad", 1.5)], ..Straight::kind("slope") }, Straight::kind("wheel_base")];
        let truth = [0, 1].map(|k| Planted { variant: kinds[k].clone(), size: 0.5 * kinds[k].sizes().1 });
        let waves: [&dyn Fn(usize) -> f64; 2] = [&|t| (0.37 * t as f64).sin(), &|t| (0.91 * t as f64).sin()];
        let log = Straight::new(&truth, &waves, Seed(4));
        assert_eq!(names(&whole(&log, &kinds, &[], &LEAST)), ["wheel_base"]);
        assert_eq!(names(&whole(&log, &kinds, &truth, &LEAST)), ["slope", "wheel_base"]);
    }
}
