//! All that a log says of every cause: single effects, two at once, and the unknown.

use asami_math::elementary::ln;

use crate::blocks::{self, Fitted};
use crate::calibration::{Evidence, NONE, UNKNOWN};
use crate::evidence::{CLOSE, PASSING, Weighed, weigh};
use crate::judge::Judge;
use crate::plant::{Planted, Variant};

/// Prior odds of a second effect beside the first.
const PRIOR_OF_A_SECOND: f64 = 0.1;
/// Evidence from which on an effect may have another beside it, in nats.
const WORTH_A_SECOND: f64 = 3.0;
/// Effects so close to the leader are each tried with every other beside it.
const NEAR_NATS: f64 = 10.0;
/// At most so many are.
const LEADERS: usize = 2;

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
}

/// What a log says of every cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Findings {
    /// Single effects, the most evident first.
    pub weighed: Vec<Weighed>,
    /// Two at once, the most evident first.
    pub pairs: Vec<Pair>,
    /// The most evident cause in the list, [`NONE`] where nothing speaks for any.
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
        let single = weighed.first().map(|it| (it.evidence_nats, it.effect.to_owned()));
        let pair = pairs.first().map(|it| (it.evidence_nats + ln(PRIOR_OF_A_SECOND), it.cause.clone()));
        let best = single.into_iter().chain(pair).reduce(|a, b| if b.0 > a.0 { b } else { a });
        let leader = best.filter(|(nats, _)| *nats > WORTH_A_SECOND).map_or_else(|| NONE.to_owned(), |(_, it)| it);
        let mut findings = Self { weighed, pairs, leader, blocks: Vec::new() };
        let planted: Vec<Planted> = findings.planted(&findings.leader).into_iter().map(|(it, _)| it).collect();
        findings.blocks = blocks::fit(judge, &judge.numbers(&planted), &|_| true);
        findings
    }

    /// Logarithm of the leader's evidence over that of *none*.
    fn leader_nats(&self) -> f64 {
        let single = self.weighed.iter().find(|it| it.effect == self.leader).map(|it| it.evidence_nats);
        let pair = self.pairs.iter().find(|it| it.cause == self.leader).map(|it| it.evidence_nats);
        single.or(pair).unwrap_or(0.0)
    }

    /// Evidence by cause.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        let singles = self.weighed.iter().map(|it| (it.effect.to_owned(), it.evidence_nats));
        let pairs = self.pairs.iter().map(|it| (it.cause.clone(), it.evidence_nats));
        let top = self.leader_nats();
        let blocks = self.blocks.iter().map(|it| (format!("{UNKNOWN}/{}", it.block), top + it.evidence_nats));
        singles.chain(pairs).chain(blocks).collect()
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

/// By how much the most evident of some blocks is more probable than what it was put on top of, in nats.
#[must_use]
pub fn absorbed_nats(blocks: &[Fitted]) -> f64 {
    blocks.iter().map(|it| it.evidence_nats).fold(f64::NEG_INFINITY, f64::max)
}

/// Every effect beside each of the leaders, and the leader's size found again.
fn pairs(judge: &dyn Judge, variants: &[Variant], weighed: &[Weighed]) -> Vec<Pair> {
    let Some(top) = weighed.first().map(|it| it.evidence_nats).filter(|nats| *nats > WORTH_A_SECOND) else {
        return Vec::new();
    };
    let leaders = weighed.iter().take(LEADERS).filter(|it| it.evidence_nats > top - NEAR_NATS);
    let mut pairs: Vec<Pair> = Vec::new();
    for leader in leaders {
        let others: Vec<Variant> = variants.iter().filter(|it| it.about.name != leader.effect).cloned().collect();
        for second in weigh(judge, &others, std::slice::from_ref(&leader.best), PASSING) {
            if second.evidence_nats < WORTH_A_SECOND {
                continue;
            }
            let kinds = [leader.best.variant.clone()];
            let again = weigh(judge, &kinds, std::slice::from_ref(&second.best), CLOSE);
            let Some(first) = again.into_iter().next() else { continue };
            // Of the two orders in which the evidence can be added up, this one has both at their best.
            let evidence_nats = second.evidence_nats + leader.evidence_nats;
            let [mut a, mut b] = [(first.best, first.interval), (second.best, second.interval)];
            if a.0.variant.about.name > b.0.variant.about.name {
                std::mem::swap(&mut a, &mut b);
            }
            let cause = format!("{}+{}", a.0.variant.about.name, b.0.variant.about.name);
            let pair = Pair { cause, evidence_nats, best: [a.0, b.0], intervals: [a.1, b.1] };
            match pairs.iter_mut().find(|it| it.cause == pair.cause) {
                Some(known) if known.evidence_nats >= pair.evidence_nats => {}
                Some(known) => *known = pair,
                None => pairs.push(pair),
            }
        }
    }
    pairs.sort_by(|a, b| b.evidence_nats.total_cmp(&a.evidence_nats));
    pairs
}
