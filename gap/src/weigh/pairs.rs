//! Two effects at once: which of them are worth a look, and how much a log speaks for them.

use asami_math::elementary::ln;

use crate::judge::Judge;
use crate::plant::{Planted, Variant};
use crate::weigh::causes::EVIDENT_NATS;
use crate::weigh::evidence::{CLOSE, PASSING, Weighed, weigh};
use crate::weigh::together::{climbed, promising};

/// Effects so close to the leader are each tried with every other beside it.
const NEAR_NATS: f64 = 10.0;
/// At most so many are.
const LEADERS: usize = 2;
/// At most so many, with those that the best pair brings in.
const MOST_LEADERS: usize = 4;
/// Of so many effects beside a leader both sizes are found together at once.
const PROMISING: usize = 8;
/// Those that make a log less likely than the leader alone by more than this are not, in nats.
const LOSES_NATS: f64 = 5.0;
/// A pair that was looked at closely is looked at again where there is one of the same two this much better, in nats.
const CLEARLY_NATS: f64 = 1.0;
/// So many pairs are looked at closely.
const SETTLED: usize = 4;
/// At most so often.
const MOST_ROUNDS: usize = 3;
/// A round that gains less is the last, in nats.
const GAINS_NOTHING_NATS: f64 = 0.2;

/// Two effects at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Their names, joined by `+`.
    pub cause: String,
    /// Logarithm of their evidence over that of *none*.
    pub evidence_nats: f64,
    /// At their most likely sizes.
    pub best: [Planted; 2],
    /// 90 % intervals of their sizes.
    pub intervals: [[f64; 2]; 2],
    /// Whether it was looked at closely.
    pub settled: bool,
}

impl Pair {
    /// Of two effects at their most likely sizes with intervals.
    fn new(mut of: [(Planted, [f64; 2]); 2], evidence_nats: f64) -> Self {
        of.sort_by_key(|(planted, _)| planted.variant.about.name);
        let cause = format!("{}+{}", of[0].0.variant.about.name, of[1].0.variant.about.name);
        let [a, b] = of;
        Self { cause, evidence_nats, best: [a.0, b.0], intervals: [a.1, b.1], settled: false }
    }
}

/// Every effect beside each of the leaders, the most evident first.
#[must_use]
pub fn pairs(judge: &dyn Judge, variants: &[Variant], weighed: &[Weighed]) -> Vec<Pair> {
    let Some(top) = weighed.first().map(|it| it.evidence_nats).filter(|nats| *nats > EVIDENT_NATS) else {
        return Vec::new();
    };
    let near = |it: &&Weighed| it.evidence_nats > top - NEAR_NATS;
    let mut leaders: Vec<Weighed> = weighed.iter().take(LEADERS).filter(near).cloned().collect();
    let mut pairs: Vec<Pair> = Vec::new();
    let mut at = 0;
    while let Some(leader) = leaders.get(at).cloned() {
        let others: Vec<Variant> = variants.iter().filter(|it| it.about.name != leader.effect).cloned().collect();
        beside(judge, &others, &leader, &mut pairs);
        together(judge, (variants, &others), &leader, &mut pairs);
        pairs.sort_by(|a, b| b.evidence_nats.total_cmp(&a.evidence_nats));
        settle(judge, &mut pairs);
        // One effect may act like two others together, and lead before either.
        let partner = pairs.first().and_then(|pair| {
            let own = |it: &&Weighed| pair.cause.split('+').any(|name| name == it.effect);
            let new = |it: &&Weighed| !leaders.iter().any(|leader| leader.effect == it.effect);
            let found = weighed.iter().find(|it| own(it) && new(it))?;
            let best = pair.best.iter().find(|it| it.variant.about.name == found.effect)?;
            Some(Weighed { best: best.clone(), ..found.clone() })
        });
        leaders.extend(partner.filter(|_| leaders.len() < MOST_LEADERS));
        at += 1;
    }
    pairs
}

/// Adds every effect beside a leader, as far as no better pair of the two is there.
fn beside(judge: &dyn Judge, others: &[Variant], leader: &Weighed, pairs: &mut Vec<Pair>) {
    let alone = judge.log_likelihood(std::slice::from_ref(&leader.best)) - judge.log_likelihood(&[]);
    // What it pays for its size.
    let paid = leader.evidence_nats - leader.gain_nats;
    for second in weigh(judge, others, std::slice::from_ref(&leader.best), PASSING) {
        let of = [(leader.best.clone(), leader.interval), (second.best, second.interval)];
        add(Pair::new(of, alone + paid + second.evidence_nats), pairs);
    }
}

/// Adds the most promising effects beside a leader with both sizes found together, as far as no better pair of the two is there.
fn together(judge: &dyn Judge, (variants, others): (&[Variant], &[Variant]), leader: &Weighed, pairs: &mut Vec<Pair>) {
    let none = judge.log_likelihood(&[]);
    let kinds = |of: &Planted| {
        let same = |it: &&Variant| it.about.name == of.variant.about.name && judge.knows(it);
        variants.iter().filter(same).count() as f64
    };
    let alone = judge.log_likelihood(std::slice::from_ref(&leader.best));
    let promising = promising(judge, &leader.best, others).into_iter().filter(|it| it.0 > alone - LOSES_NATS);
    for found in promising.take(PROMISING).filter_map(|(_, from)| climbed(judge, from)) {
        let of_a_kind = found.planted.iter().fold(0.0, |sum, it| sum - ln(kinds(it)));
        let evidence_nats = found.log_likelihood - none + found.ln_volume + of_a_kind;
        add(Pair::new(found.sized(), evidence_nats), pairs);
    }
}

/// Adds a pair, if no better one of the two is there.
fn add(pair: Pair, pairs: &mut Vec<Pair>) {
    match pairs.iter_mut().find(|it| it.cause == pair.cause) {
        Some(known) if known.evidence_nats + if known.settled { CLEARLY_NATS } else { 0.0 } >= pair.evidence_nats => {}
        Some(known) => *known = pair,
        None => pairs.push(pair),
    }
}

/// Finds both sizes of the most evident pairs in turn, each beside the other, until that gains nothing.
fn settle(judge: &dyn Judge, pairs: &mut [Pair]) {
    let Some(top) = pairs.first().map(|it| it.evidence_nats) else { return };
    let none = judge.log_likelihood(&[]);
    for pair in pairs.iter_mut().take(SETTLED).filter(|it| !it.settled && it.evidence_nats > top - NEAR_NATS) {
        pair.settled = true;
        let mut paid = [0.0; 2];
        let mut before = f64::NEG_INFINITY;
        for turn in 0..2 * MOST_ROUNDS {
            let (one, other) = (turn % 2, 1 - turn % 2);
            let (kind, with) = ([pair.best[one].variant.clone()], [pair.best[other].clone()]);
            let Some(found) = weigh(judge, &kind, &with, CLOSE).into_iter().next() else { break };
            let likely = judge.log_likelihood(&with) - none + found.gain_nats;
            paid[one] = found.evidence_nats - found.gain_nats;
            (pair.best[one], pair.intervals[one]) = (found.best, found.interval);
            if turn > 0 {
                pair.evidence_nats = likely + paid[0] + paid[1];
            }
            if turn > 0 && likely - before < GAINS_NOTHING_NATS {
                break;
            }
            before = likely;
        }
    }
    pairs.sort_by(|a, b| b.evidence_nats.total_cmp(&a.evidence_nats));
}
