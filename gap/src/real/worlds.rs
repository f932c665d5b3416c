//! What the world of a log may be: with what is named alone, and with more that is not worth a name.

use asami_math::elementary::exp;

use super::layers::{Least, beside_others, further, of_what_counts};
use super::settle::{Settled, settle};
use super::starts::About;
use crate::judge::Judge;
use crate::plant::{Planted, Variant};

/// So often what is most probable is put beside what is named, for more to be put beside it.
const UNNAMED: usize = 4;
/// So many single effects and so many pairs are tried for what they promise.
const PROMISING: [usize; 2] = [4, 6];
/// A world less probable than this is left out.
const HARDLY: f64 = 0.02;

/// A world that a log may be of.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Its effects, about where the log is likeliest: those that are asked for, and others after them.
    pub effects: Vec<Planted>,
    /// How probable it is beside others, all of which make one.
    pub share: f64,
}

/// Effects, and the logarithm of how probable a world with them is over that with the named ones alone.
type Odds = (Vec<Planted>, f64);

/// What the world may be, where these effects are named: they alone, and with others that are not worth a name. An effect's size
/// hangs on what else there is, so that it would be said too surely, and with what others do put down to it, were there nothing
/// (Hoeting et al. 1999, "Bayesian Model Averaging").
///
/// Ten to one are against a name. Against there being something there are no odds: in hardly any robot anything is just as it is told
/// to be.
#[must_use]
pub fn worlds(judge: &dyn Judge, variants: &[Variant], named: &[Planted], least: &Least) -> Vec<World> {
    let mut all: Vec<Odds> = vec![(named.to_vec(), 0.0)];
    let mut base = all[0].clone();
    for _ in 0..UNNAMED {
        let further = beside(judge, variants, &base, least);
        let likeliest = further.iter().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|it| it.1 > base.1).cloned();
        further.into_iter().for_each(|it| add(&mut all, it));
        let Some(likeliest) = likeliest else { break };
        base = likeliest;
    }
    let top = all.iter().fold(f64::NEG_INFINITY, |top, it| top.max(it.1));
    let whole = all.iter().fold(0.0, |sum, it| sum + exp(it.1 - top));
    let shared = all.into_iter().map(|(effects, odds)| World { effects, share: exp(odds - top) / whole });
    shared.filter(|it| it.share >= HARDLY).collect()
}

/// What may be beside what is in a world: what shows there, what shows once that gives way, and what shows only with a second one.
fn beside(judge: &dyn Judge, variants: &[Variant], base: &Odds, least: &Least) -> Vec<Odds> {
    let (with, odds) = (&base.0, base.1);
    let likely = judge.log_likelihood(with);
    let others = least.beside(variants, with);
    let about = About::new(judge, &others, with);
    let shows = further(judge, least, &about, likely).into_iter().map(|(it, settled)| {
        let counts = counts(judge, least, &settled, with.len());
        (settled.effects, odds + of_what_counts(&it, counts))
    });
    let may = |a: &Variant, b: &Variant| !least.rules_out(b, &[Planted { variant: a.clone(), size: b.sizes().0 }]);
    let promised = about.promising(judge, may, PROMISING).into_iter().filter_map(|start| {
        let settled = settle(judge, start.effects);
        let pays = |i: usize| {
            let it = beside_others(judge, &settled.effects, i)?;
            Some(it.pays_nats + least.kin.more_against_nats(it.weighed.effect))
        };
        let pays: f64 = (with.len()..settled.effects.len()).map(pays).sum::<Option<f64>>()?;
        let gains = counts(judge, least, &settled, with.len()) * (settled.likely - likely);
        Some((settled.effects, odds + gains - pays))
    });
    shows.chain(promised).collect()
}

/// What counts of a nat that the effects after the first `before` gain: as blocks leave it of each, and where more is asked for because
/// the library may be off by as much, so much less; of several the harmonic mean (Pauli, Racugno and Ventura 2011).
fn counts(judge: &dyn Judge, least: &Least, settled: &Settled, before: usize) -> f64 {
    let more = settled.effects.iter().zip(&settled.counts).skip(before);
    let takes =
        more.map(|(it, counts)| least.gain_of(judge, &settled.effects, it, settled.likely) / (least.nats * counts));
    let (n, takes) = takes.fold((0.0, 0.0), |(n, sum), it| (n + 1.0, sum + it));
    n / takes
}

/// One of these effects is as probable as where it is most so.
fn add(all: &mut Vec<Odds>, new: Odds) {
    let has = |of: &[Planted], it: &Planted| of.iter().any(|other| other.variant.about.name == it.variant.about.name);
    let same = |a: &[Planted], b: &[Planted]| a.len() == b.len() && a.iter().all(|it| has(b, it));
    match all.iter_mut().find(|it| same(&it.0, &new.0)) {
        Some(known) if known.1 >= new.1 => {}
        Some(known) => *known = new,
        None => all.push(new),
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::real::layers::ANY_SHARE as LEAST;
    use crate::real::unsure::{believed, walks};
    use crate::straight::Straight;

    /// What is not worth a name may be there all the same, and what is named makes up for it: intervals allow for that.
    #[test]
    fn sizes_allow_for_what_else_there_may_be() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let truth = [of(0, 0.5), of(1, 0.3)];
        let wave = |t: usize, step: f64| (step * t as f64).sin();
        // By itself the second wave is worth 4.4 nats: less than a name is.
        let alike = |t: usize| wave(t, 0.37) + 0.7 * wave(t, 0.91);
        let [mut held, mut alone] = [0, 0];
        for seed in 0..40 {
            let log = Straight::new(&truth, &[&|t| wave(t, 0.37), &alike], Seed(seed));
            let named = settle(&log, vec![of(0, 0.5)]).effects;
            let holds = |worlds: &[World]| {
                let [low, high] = believed(worlds, &walks(&log, worlds))[0].interval;
                low <= truth[0].size && truth[0].size <= high
            };
            let worlds = worlds(&log, &kinds, &named, &LEAST);
            let shares: f64 = worlds.iter().map(|it| it.share).sum();
            assert!((0.95..1.0 + 1e-9).contains(&shares), "{shares}");
            held += usize::from(holds(&worlds));
            alone += usize::from(holds(&[World { effects: named, share: 1.0 }]));
        }
        assert!(held >= 30 && alone <= 10, "{held} and {alone} of 40");
    }

    /// Two effects that nearly undo each other, for what is left of which the one that is named makes up: there is a world with both, which
    /// counts, and none comes twice.
    #[test]
    fn two_that_show_only_beside_each_other_may_both_be_there() {
        let kinds = ["turn_slowing", "command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let (a, b) = (|t: usize| (0.37 * t as f64).sin(), |t: usize| (0.91 * t as f64).sin());
        let waves: [&dyn Fn(usize) -> f64; 3] = [&|t| 3.0 * b(t), &|t| 4.0 * a(t) + 0.5 * b(t), &|t| {
            0.5 * b(t) - 4.0 * a(t) + 0.7 * (1.53 * t as f64).sin()
        }];
        let truth = of(0, 0.3).size;
        let [mut both, mut held, mut alone] = [0; 3];
        for seed in 0..40 {
            let log = Straight::new(&[of(0, 0.3), of(1, 0.5), of(2, 0.5)], &waves, Seed(seed));
            let named = settle(&log, vec![of(0, 0.3)]).effects;
            let found = worlds(&log, &kinds, &named, &LEAST);
            let with_both: f64 = found.iter().filter(|it| it.effects.len() == 3).map(|it| it.share).sum();
            assert!(found.iter().filter(|it| it.effects.len() == 3).count() <= 1, "{found:?}");
            let holds = |worlds: &[World]| {
                let [low, high] = believed(worlds, &walks(&log, worlds))[0].interval;
                usize::from((low..=high).contains(&truth))
            };
            both += usize::from(with_both > 0.5);
            held += holds(&found);
            alone += holds(&[World { effects: named, share: 1.0 }]);
        }
        // A robot that has both, always, is not one of nine in ten: that neither is there counts as well.
        assert!(both >= 30 && held >= 26 && alone <= 4, "{both}, {held} and {alone} of 40");
    }

    /// One of two shows throughout a log, the other in two blocks of twenty. What counts of a nat that they gain together hangs on
    /// both, whichever comes last, and lies between what counts of either's.
    #[test]
    fn what_counts_of_two_is_of_both() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let throughout = |t: usize| 3.0 * (0.37 * t as f64).sin();
        let twice = |t: usize| if t / 20 % 10 == 3 { 4.0 * (0.37 * t as f64).cos() } else { 0.0 };
        let mut log = Straight::new(&[of(0, 0.5), of(1, 0.5)], &[&throughout, &twice], Seed(5));
        // More in the one block than in the other.
        (0..20).for_each(|t| log.measured[60 + t] += 0.5 * twice(60 + t));
        (0..20).for_each(|t| log.measured[260 + t] -= 0.5 * twice(260 + t));
        let settled = settle(&log, vec![of(0, 0.5), of(1, 0.5)]);
        let turned = settle(&log, vec![of(1, 0.5), of(0, 0.5)]);
        let both = counts(&log, &LEAST, &settled, 0);
        assert!((both / counts(&log, &LEAST, &turned, 0) - 1.0).abs() < 0.05, "{both}");
        let [first, second] = [counts(&log, &LEAST, &turned, 1), counts(&log, &LEAST, &settled, 1)];
        assert!(first > 2.0 * second && second < both && both < first, "{first}, {second} and {both} of both");
    }
}
