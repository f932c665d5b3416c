//! All that a log says of every cause: single effects, two at once, and the unknown.

use crate::blocks::{self, Fitted};
use crate::judge::Judge;
use crate::plant::{Planted, Variant};
use crate::weigh::causes::{EVIDENT_NATS, Evidence, UNKNOWN, leader};
use crate::weigh::evidence::{CLOSE, PASSING, Weighed, weigh};

/// Effects so close to the leader are each tried with every other beside it.
const NEAR_NATS: f64 = 10.0;
/// At most so many are.
const LEADERS: usize = 2;
/// At most so many, with those that the best pair brings in.
const MOST_LEADERS: usize = 4;
/// Of so many pairs both sizes are found together.
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
    /// Whether both sizes were found together.
    pub settled: bool,
}

/// What a log says of every cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Findings {
    /// Single effects, the most evident first.
    pub weighed: Vec<Weighed>,
    /// Two at once, the most evident first.
    pub pairs: Vec<Pair>,
    /// The most evident cause in the list, [`NONE`](crate::weigh::causes::NONE) where nothing speaks for any.
    pub leader: String,
    /// Flexible blocks on top of the leader, in the order of [`blocks::BLOCKS`].
    pub blocks: Vec<Fitted>,
}

impl Findings {
    /// Weighs every cause.
    #[must_use]
    pub fn new(judge: &dyn Judge, variants: &[Variant]) -> Self {
        let mut weighed = weigh(judge, variants, &[], CLOSE);
        weighed.sort_by(|a, b| b.evidence_nats.total_cmp(&a.evidence_nats));
        let pairs = pairs(judge, variants, &weighed);
        Self::of(judge, weighed, pairs)
    }

    /// The same, had some effects not been in the list.
    #[must_use]
    pub fn without(&self, judge: &dyn Judge, effects: &[&str]) -> Self {
        let stays = |cause: &str| !cause.split('+').any(|effect| effects.contains(&effect));
        let weighed = self.weighed.iter().filter(|it| stays(it.effect)).cloned().collect();
        let pairs = self.pairs.iter().filter(|it| stays(&it.cause)).cloned().collect();
        Self::of(judge, weighed, pairs)
    }

    /// A cause in nobody's list must explain what the best in the list leaves.
    fn of(judge: &dyn Judge, weighed: Vec<Weighed>, pairs: Vec<Pair>) -> Self {
        let named = named(&weighed, &pairs);
        let leader = leader(&named).to_owned();
        let mut findings = Self { weighed, pairs, leader, blocks: Vec::new() };
        let planted: Vec<Planted> = findings.planted(&findings.leader).into_iter().map(|(it, _)| it).collect();
        findings.blocks = blocks::fit(judge, &judge.numbers(&planted), &|_| true);
        findings
    }

    /// Evidence by cause.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        let mut evidence = named(&self.weighed, &self.pairs);
        let top = evidence.get(&self.leader).copied().unwrap_or(0.0);
        evidence.extend(self.blocks.iter().map(|it| (format!("{UNKNOWN}/{}", it.block), top + it.evidence_nats)));
        evidence
    }

    /// A block by its name.
    #[must_use]
    pub fn block(&self, name: &str) -> Option<&Fitted> {
        self.blocks.iter().find(|it| it.block == name)
    }

    /// The effects of a cause at their most likely sizes, with 90 % intervals; none of *unknown* and *none*.
    #[must_use]
    pub fn planted(&self, cause: &str) -> Vec<(Planted, [f64; 2])> {
        if let Some(weighed) = self.weighed.iter().find(|it| it.effect == cause) {
            return vec![(weighed.best.clone(), weighed.interval)];
        }
        let pair = self.pairs.iter().find(|it| it.cause == cause);
        pair.map_or_else(Vec::new, |pair| pair.best.iter().cloned().zip(pair.intervals).collect())
    }
}

/// Evidence of the causes in the list.
fn named(weighed: &[Weighed], pairs: &[Pair]) -> Evidence {
    let singles = weighed.iter().map(|it| (it.effect.to_owned(), it.evidence_nats));
    singles.chain(pairs.iter().map(|it| (it.cause.clone(), it.evidence_nats))).collect()
}

/// By how much the most evident of some blocks is more probable than what it was put on top of, in nats.
#[must_use]
pub fn absorbed_nats(blocks: &[Fitted]) -> f64 {
    blocks.iter().map(|it| it.evidence_nats).fold(f64::NEG_INFINITY, f64::max)
}

/// Every effect beside each of the leaders; the most evident pairs with both sizes found together.
fn pairs(judge: &dyn Judge, variants: &[Variant], weighed: &[Weighed]) -> Vec<Pair> {
    let Some(top) = weighed.first().map(|it| it.evidence_nats).filter(|nats| *nats > EVIDENT_NATS) else {
        return Vec::new();
    };
    let near = |it: &&Weighed| it.evidence_nats > top - NEAR_NATS;
    let mut leaders: Vec<Weighed> = weighed.iter().take(LEADERS).filter(near).cloned().collect();
    let mut pairs: Vec<Pair> = Vec::new();
    let mut at = 0;
    while let Some(leader) = leaders.get(at).cloned() {
        beside(judge, variants, &leader, &mut pairs);
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
fn beside(judge: &dyn Judge, variants: &[Variant], leader: &Weighed, pairs: &mut Vec<Pair>) {
    let others: Vec<Variant> = variants.iter().filter(|it| it.about.name != leader.effect).cloned().collect();
    let alone = judge.log_likelihood(std::slice::from_ref(&leader.best)) - judge.log_likelihood(&[]);
    // What it pays for its size.
    let paid = leader.evidence_nats - leader.gain_nats;
    for second in weigh(judge, &others, std::slice::from_ref(&leader.best), PASSING) {
        let mut of = [(leader.best.clone(), leader.interval), (second.best, second.interval)];
        of.sort_by_key(|(planted, _)| planted.variant.about.name);
        let [a, b] = of;
        let pair = Pair {
            cause: format!("{}+{}", a.0.variant.about.name, b.0.variant.about.name),
            evidence_nats: alone + paid + second.evidence_nats,
            best: [a.0, b.0],
            intervals: [a.1, b.1],
            settled: false,
        };
        match pairs.iter_mut().find(|it| it.cause == pair.cause) {
            Some(known) if known.settled || known.evidence_nats >= pair.evidence_nats => {}
            Some(known) => *known = pair,
            None => pairs.push(pair),
        }
    }
    pairs.sort_by(|a, b| b.evidence_nats.total_cmp(&a.evidence_nats));
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
