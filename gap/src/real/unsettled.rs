//! Small parts of a gap of which a log does not settle what they are.
//!
//! A verdict is on a gap. Which of two effects makes a few hundredths of it takes nothing back of what makes the rest: what is sure is
//! named, and what the small part may be is said by itself.

use super::layers::{Layer, Rival, planted, take};
use super::settle::settle;
use super::{SURE, less, likeliest, odds, rivals};
use crate::answer::diagnosis::{Suspect, Unsettled};
use crate::judge::Judge;
use crate::weigh::groups::SPLIT_NATS;

/// What is settled explains no less than nine tenths of what all do.
const MOST_UNSETTLED: f64 = 0.1;

/// The effects that a log settles, with their sizes found together, and the small parts of the gap that it does not settle. Where
/// these are not small, all effects stay as they are: which they are is tied.
///
/// Effects are as sure as each of them is; the least sure goes first, for as long as they are not.
#[must_use]
pub fn settled(judge: &dyn Judge, found: Vec<Layer>) -> (Vec<Layer>, Vec<Unsettled>) {
    let explained = judge.log_likelihood(&planted(&found)) - judge.log_likelihood(&[]);
    let (mut sure, mut unsettled) = (found.clone(), Vec::new());
    loop {
        let others: Vec<f64> = sure.iter().map(|layer| another(&sure, layer)).collect();
        if others.iter().map(|it| 1.0 - it).product::<f64>() >= SURE {
            break;
        }
        let Some(at) = (0..sure.len()).max_by(|a, b| others[*a].total_cmp(&others[*b])) else { break };
        let one_of = suspects(&sure, &sure[at]);
        let layer = sure.remove(at);
        // Of it no other is a rival because it is gone.
        sure.iter_mut().for_each(|it| it.rivals.retain(|rival| rival.effect != layer.weighed.effect));
        unsettled.push(Unsettled { one_of, share: layer.weighed.gain_nats / explained });
    }
    if unsettled.iter().map(|it| it.share).sum::<f64>() > MOST_UNSETTLED {
        return (found, Vec::new());
    }
    if !unsettled.is_empty() {
        let together = settle(judge, planted(&sure)).effects;
        take(&mut sure, together);
    }
    (sure, unsettled)
}

/// How probable each is in the place of a layer: the layer itself, and each of its rivals.
fn probable<'a>(found: &'a [Layer], layer: &'a Layer) -> (f64, Vec<(&'a Rival, f64)>) {
    let rivals: Vec<(&Rival, f64)> = rivals(found, layer).map(|it| (it, odds(less(layer, it)))).collect();
    let whole = 1.0 + rivals.iter().map(|it| it.1).sum::<f64>();
    (1.0 / whole, rivals.into_iter().map(|(rival, odds)| (rival, odds / whole)).collect())
}

/// How probable it is that another, which the log can tell from it, is in its place.
fn another(found: &[Layer], layer: &Layer) -> f64 {
    let (_, rivals) = probable(found, layer);
    rivals.iter().filter(|(it, _)| it.apart_nats >= SPLIT_NATS).map(|it| it.1).sum()
}

/// The most probable in its place, until they have nine tenths of it.
fn suspects(found: &[Layer], layer: &Layer) -> Vec<Suspect> {
    let (own, rivals) = probable(found, layer);
    let rivals = rivals.into_iter().map(|(rival, probability)| (rival.effect, probability));
    let mut all: Vec<(&str, f64)> = std::iter::once((layer.weighed.effect, own)).chain(rivals).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let said = |(effect, probability): (&str, f64)| Suspect { effect: effect.to_owned(), probability };
    likeliest(all, |it| it.1).into_iter().map(said).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use asami_math::elementary::exp;

    use super::*;
    use crate::plant::Planted;
    use crate::straight::Straight;
    use crate::weigh::evidence::Weighed;

    /// A log of a scale and of a wheel base that is a little off, and both layers, the second with a rival that is so far behind and
    /// so far apart; `gain` is what the second adds.
    fn log_and_layers(gain_nats: f64, behind_nats: f64, apart_nats: f64) -> (Straight, Vec<Layer>) {
        let effects = ["command_scale", "wheel_base"].map(|name| {
            let variant = Straight::kind(name);
            Planted { size: 0.3 * variant.sizes().1, variant }
        });
        let first = |t: usize| 90.0 * (0.37 * t as f64).sin();
        let log = Straight::new(&effects, &[&first, &|t| 0.05 * (0.91 * t as f64).sin()], Seed(3));
        let layers = effects.map(|best| {
            let (effect, is_first) = (best.variant.about.name, best.variant.about.name == "command_scale");
            let evidence_nats = if is_first { 900.0 } else { gain_nats - 2.0 };
            let rival = Rival { effect: "unequal_wheels", evidence_nats: evidence_nats - behind_nats, apart_nats };
            let weighed = Weighed { effect, evidence_nats, gain_nats: evidence_nats + 2.0, best, interval: [0.0, 1.0] };
            Layer { weighed, pays_nats: 2.0, rivals: if is_first { Vec::new() } else { vec![rival] } }
        });
        (log, layers.into())
    }

    fn names(found: &[Layer]) -> Vec<&str> {
        found.iter().map(|it| it.weighed.effect).collect()
    }

    /// What is small is said by itself, with each as probable as it is, and what is named stays as large as it is by itself.
    #[test]
    fn what_is_small_and_not_settled_is_not_named() {
        let (log, layers) = log_and_layers(8.0, 0.5, 9.0);
        let (found, unsettled) = settled(&log, layers);
        assert_eq!(names(&found), ["command_scale"]);
        let alone = settle(&log, planted(&found)).effects[0].size;
        assert!((found[0].weighed.best.size / alone - 1.0).abs() < 1e-3);
        let [it] = &unsettled[..] else { panic!("{unsettled:?}") };
        let said: Vec<&str> = it.one_of.iter().map(|it| it.effect.as_str()).collect();
        assert_eq!(said, ["wheel_base", "unequal_wheels"]);
        assert!((it.one_of[0].probability - 1.0 / (1.0 + exp(-0.5))).abs() < 1e-12, "{it:?}");
        assert!(it.share > 0.0 && it.share < 0.01, "{it:?}");
    }

    /// What is large is a tie, what is settled a name, and so is what no log could tell from another.
    #[test]
    fn what_is_large_or_settled_or_alike_stays() {
        for (gain_nats, behind_nats, apart_nats) in [(20_000.0, 0.5, 9.0), (8.0, 4.0, 9.0), (8.0, 0.5, 0.4)] {
            let (log, layers) = log_and_layers(gain_nats, behind_nats, apart_nats);
            assert_eq!(settled(&log, layers.clone()), (layers, Vec::new()), "{gain_nats} {behind_nats}");
        }
    }

    /// A rival that goes with what is not settled takes no other's place.
    #[test]
    fn what_is_not_settled_is_no_rival_of_the_rest() {
        let (log, mut layers) = log_and_layers(8.0, 0.5, 9.0);
        layers[0].rivals = vec![Rival { effect: "wheel_base", evidence_nats: 899.9, apart_nats: 9.0 }];
        let (found, _) = settled(&log, layers);
        assert!(names(&found) == ["command_scale"] && found[0].rivals.is_empty(), "{found:?}");
    }
}
