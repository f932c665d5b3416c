//! Where to look for one more effect beside several: with all sizes where they were likeliest, were the log-likelihood quadratic in
//! them (a score test's, Rao 1948). An effect that the others have made up for shows nothing as long as they stay where they are.

use crate::judge::Judge;
use crate::newton::Curvature;
use crate::plant::{Planted, Variant};

/// Differences are taken over such a share of a size.
const DIFFERENCE: f64 = 0.02;
/// And from no size at all, over this share of the least.
const LITTLE: f64 = 0.1;
/// No size changes by more at once than so many times what it is.
const LONGEST: f64 = 4.0;

/// A start: what is in the world, and one more effect, or two, the last.
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

/// So many that promise most.
fn most(tops: impl Iterator<Item = Top>, most: usize) -> impl Iterator<Item = Top> {
    let mut tops: Vec<Top> = tops.collect();
    tops.sort_by(|a, b| b.promised.total_cmp(&a.promised));
    tops.into_iter().take(most)
}

/// The log-likelihood about some sizes, as if it were quadratic in them and in those of others, of which there is nothing yet.
pub struct About<'a> {
    /// What is there, at these sizes.
    pub with: &'a [Planted],
    /// What may be put beside it.
    pub kinds: &'a [Variant],
    /// By how much likelier each step is for a change of the logarithm of each size.
    of_with: Vec<Vec<f64>>,
    /// Those of the kinds that the judge knows, and by how much likelier for each unit of size.
    others: Vec<(&'a Variant, Vec<f64>)>,
}

/// Where that is greatest.
struct Top {
    /// Steps of the sizes of what is there, by their logarithms.
    moves: Vec<f64>,
    /// Further effects, by their place, and their sizes.
    more: Vec<(usize, f64)>,
    /// By so much likelier, in nats.
    promised: f64,
}

impl<'a> About<'a> {
    /// About `with`.
    #[must_use]
    pub fn new(judge: &dyn Judge, kinds: &'a [Variant], with: &'a [Planted]) -> Self {
        let terms = |all: &[Planted]| judge.terms(&judge.numbers(all));
        let here = terms(with);
        let per = |there: Vec<f64>, by: f64| -> Vec<f64> {
            there.iter().zip(&here).map(|(there, here)| (there - here) / by).collect()
        };
        let of_with = (0..with.len()).map(|i| {
            let mut larger = with.to_vec();
            larger[i].size *= 1.0 + DIFFERENCE;
            per(terms(&larger), DIFFERENCE)
        });
        let others = kinds.iter().filter(|variant| judge.knows(variant)).map(|variant| {
            let size = LITTLE * variant.sizes().0;
            let little = Planted { variant: variant.clone(), size };
            (variant, per(terms(&[with, &[little]].concat()), size))
        });
        Self { with, kinds, of_with: of_with.collect(), others: others.collect() }
    }

    /// For each effect that the slope calls for the likeliest kind's start.
    #[must_use]
    pub fn starts(&self, judge: &dyn Judge) -> Vec<Start> {
        let mut found: Vec<Start> = Vec::new();
        for new in (0..self.others.len()).filter_map(|i| self.start(judge, &self.top(&[i])?)) {
            match found.iter_mut().find(|it| it.name() == new.name()) {
                Some(known) if known.likely >= new.likely => {}
                Some(known) => *known = new,
                None => found.push(new),
            }
        }
        found
    }

    /// Starts with so many single effects more, and with so many pairs that may be there together: those that promise most, whatever
    /// they are worth before all sizes are found together.
    #[must_use]
    pub fn promising(
        &self,
        judge: &dyn Judge,
        may: impl Fn(&Variant, &Variant) -> bool,
        [alone, of_two]: [usize; 2],
    ) -> Vec<Start> {
        let singles = (0..self.others.len()).filter_map(|i| self.top(&[i]));
        let pairs = (0..self.others.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let pairs = pairs.filter(|[i, j]| may(self.others[*i].0, self.others[*j].0));
        let tops = most(singles, alone).chain(most(pairs.filter_map(|pair| self.top(&pair)), of_two));
        tops.filter_map(|top| self.start(judge, &top)).collect()
    }

    /// Where these others are there too; `None` where one of them is called for by nothing.
    fn top(&self, more: &[usize]) -> Option<Top> {
        let of_more = more.iter().map(|i| &self.others[*i].1);
        let scores: Vec<&[f64]> = self.of_with.iter().chain(of_more).map(Vec::as_slice).collect();
        let slope: Vec<f64> = scores.iter().map(|score| score.iter().fold(0.0, |sum, it| sum + it)).collect();
        let step = Curvature::new(&scores, 0.0)?.step(&slope);
        let promised = 0.5 * slope.iter().zip(&step).fold(0.0, |sum, (slope, step)| sum + slope * step);
        let (moves, sizes) = step.split_at(self.with.len());
        let more: Vec<(usize, f64)> = more.iter().copied().zip(sizes.iter().copied()).collect();
        more.iter().all(|it| it.1 > 0.0).then(|| Top { moves: moves.to_vec(), more, promised })
    }

    fn start(&self, judge: &dyn Judge, top: &Top) -> Option<Start> {
        let within = |it: &(usize, f64)| {
            let (least, greatest) = self.others[it.0].0.sizes();
            it.1.clamp(least, greatest)
        };
        // What is held at an end of its law takes so much less from the others.
        let share = top.more.iter().map(|it| within(it) / it.1);
        let share = share.fold(1.0, |far: f64, it| if (it - 1.0).abs() > (far - 1.0).abs() { it } else { far });
        let moved = self.with.iter().zip(&top.moves).map(|(it, by)| {
            let (low, high) = it.variant.sizes();
            Planted { size: (it.size * (1.0 + (share * by).min(LONGEST))).clamp(low, high), ..it.clone() }
        });
        let more = top.more.iter().map(|it| Planted { variant: self.others[it.0].0.clone(), size: within(it) });
        let effects: Vec<Planted> = moved.chain(more).collect();
        let likely = judge.log_likelihood(&effects);
        likely.is_finite().then_some(Start { effects, likely })
    }
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
        let found = About::new(&world, &kinds[2..], &with).starts(&world);
        assert_eq!(found.len(), 1);
        assert!(found[0].likely > likely + 30.0 && found[0].effects.len() == 3, "{} {likely}", found[0].likely);
        for (found, truth) in found[0].effects.iter().zip(&truth) {
            // Nearer than where the two stood, and than none of the third.
            let off = found.size / truth.size;
            assert!((0.6..1.5).contains(&off), "{}: {off}", truth.variant.about.name);
        }
        let unknown = [Straight::kind("slope")];
        assert!(
            About::new(&world, &unknown, &with).starts(&world).is_empty(),
            "what the judge does not know is not tried"
        );
    }

    /// Two effects that nearly undo each other: either promises little by itself, and both together what they are worth.
    #[test]
    fn what_shows_only_beside_another_is_promised_with_it() {
        let kinds = NAMES.map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let (a, b) = (|t: usize| (0.37 * t as f64).sin(), |t: usize| (0.91 * t as f64).sin());
        let waves: [&dyn Fn(usize) -> f64; 3] =
            [&|t| 4.0 * a(t) + 0.6 * b(t), &|t| 0.6 * b(t) - 4.0 * a(t), &|t| (1.53 * t as f64).sin()];
        let truth = [of(0, 0.5), of(1, 0.5)];
        let log = Straight::new(&[&truth[..], &[of(2, 1e-6)]].concat(), &waves, Seed(4));
        let of_two = |may: fn(&Variant, &Variant) -> bool| About::new(&log, &kinds, &[]).promising(&log, may, [0, 1]);
        let [found] = &of_two(|_, _| true)[..] else { panic!("one pair") };
        let likely = log.log_likelihood(&[]);
        let alone = kinds.iter().flat_map(|kind| About::new(&log, std::slice::from_ref(kind), &[]).starts(&log));
        let alone = alone.map(|it| it.likely - likely).fold(0.0, f64::max);
        assert!(alone < 10.0 && found.likely - likely > 30.0, "{alone} {}", found.likely - likely);
        for (found, truth) in found.effects.iter().zip(&truth) {
            assert!(found.variant == truth.variant && (found.size / truth.size - 1.0).abs() < 0.5, "{found:?}");
        }
        assert!(of_two(|_, _| false).is_empty(), "of which only one may be there");
        assert!(
            About::new(&log, &kinds, &truth)
                .promising(&log, |_, _| true, [2, 0])
                .iter()
                .all(|it| it.effects.len() == 3)
        );
    }
}
