//! Where to look for one more effect beside several: with all sizes where they were likeliest, were the log-likelihood quadratic in
//! them (a score test's, Rao 1948). An effect that the others have made up for shows nothing as long as they stay where they are.

use asami_math::elementary::exp;

use crate::judge::Judge;
use crate::newton::Curvature;
use crate::plant::{Planted, Variant};

/// Differences are taken over such a change of a size's logarithm.
const DIFFERENCE: f64 = 0.02;
/// And from no size at all, over this share of the least.
const LITTLE: f64 = 0.1;
/// No size changes by more at once, by its logarithm.
const LONGEST: f64 = 1.0;

/// A start: what is in the world, and one more effect, the last.
pub struct Start {
    /// With their sizes.
    pub effects: Vec<Planted>,
    /// The log-likelihood there.
    pub likely: f64,
}

impl Start {
    fn name(&self) -> Option<&'static str> {
        self.effects.last().map(|it| it.variant.about.name)
    }
}

/// For each effect of `others` that the slope calls for the likeliest kind's start beside `with`.
#[must_use]
pub fn starts(judge: &dyn Judge, others: &[Variant], with: &[Planted]) -> Vec<Start> {
    let terms = |all: &[Planted]| judge.terms(&judge.numbers(all));
    let here = terms(with);
    let per = |there: Vec<f64>, by: f64| -> Vec<f64> {
        there.iter().zip(&here).map(|(there, here)| (there - here) / by).collect()
    };
    let of_with: Vec<Vec<f64>> = (0..with.len())
        .map(|i| {
            let mut larger = with.to_vec();
            larger[i].size *= exp(DIFFERENCE);
            per(terms(&larger), DIFFERENCE)
        })
        .collect();
    let start = |variant: &Variant| {
        let (least, greatest) = variant.sizes();
        let planted = |size: f64| Planted { variant: variant.clone(), size };
        let more = per(terms(&[with, &[planted(LITTLE * least)]].concat()), LITTLE * least);
        let scores: Vec<&[f64]> = of_with.iter().chain([&more]).map(Vec::as_slice).collect();
        let slope: Vec<f64> = scores.iter().map(|score| score.iter().fold(0.0, |sum, it| sum + it)).collect();
        let (found, moves) = Curvature::new(&scores, 0.0)?.step(&slope).split_last().map(|(a, b)| (*a, b.to_vec()))?;
        let size = (found > 0.0).then(|| found.clamp(least, greatest))?;
        // What is held at an end of its law takes so much less from the others.
        let share = size / found;
        let moved = with.iter().zip(moves).map(|(it, by)| {
            let (low, high) = it.variant.sizes();
            Planted { size: (it.size * exp((share * by).clamp(-LONGEST, LONGEST))).clamp(low, high), ..it.clone() }
        });
        let effects: Vec<Planted> = moved.chain([planted(size)]).collect();
        let likely = judge.log_likelihood(&effects);
        likely.is_finite().then_some(Start { effects, likely })
    };
    let mut found: Vec<Start> = Vec::new();
    for new in others.iter().filter(|variant| judge.knows(variant)).filter_map(start) {
        match found.iter_mut().find(|it| it.name() == new.name()) {
            Some(known) if known.likely >= new.likely => {}
            Some(known) => *known = new,
            None => found.push(new),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    const NAMES: [&str; 3] = ["command_scale", "wheel_base", "turn_slowing"];

    /// Two effects have made up for a third, which does much what the two do together: beside them as they are it is worth nothing,
    /// and where it and they should start it is worth what it is in truth.
    #[test]
    fn an_effect_that_others_made_up_for_is_worth_something_once_they_give_way() {
        let kinds = NAMES.map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let truth = [of(0, 0.3), of(1, 0.4), of(2, 0.5)];
        let wave = |t: usize, step: f64| (step * t as f64).sin();
        let third = |t: usize| 3.0 * (wave(t, 0.37) + wave(t, 0.91)) + 1.5 * wave(t, 1.7);
        let world = Straight::new(&truth, &[&|t| 5.0 * wave(t, 0.37), &|t| 5.0 * wave(t, 0.91), &third], Seed(3));
        // By least squares of the first two: the third's share of each.
        let with = [of(0, 0.3 + 0.5 * 0.6), of(1, 0.4 + 0.5 * 0.6)];
        let likely = world.log_likelihood(&with);
        let as_they_are = world.log_likelihood(&[&with[..], &truth[2..]].concat());
        assert!(as_they_are < likely - 100.0, "{as_they_are} {likely}");
        let found = starts(&world, &kinds[2..], &with);
        assert_eq!(found.len(), 1);
        assert!(found[0].likely > likely + 30.0 && found[0].effects.len() == 3, "{} {likely}", found[0].likely);
        for (found, truth) in found[0].effects.iter().zip(&truth) {
            // Nearer than where the two stood, and than none of the third.
            let off = found.size / truth.size;
            assert!((0.6..1.5).contains(&off), "{}: {off}", truth.variant.about.name);
        }
        let unknown = [Straight::kind("slope")];
        assert!(starts(&world, &unknown, &with).is_empty(), "what the judge does not know is not tried");
    }
}
