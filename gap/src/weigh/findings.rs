//! All that a log says of every cause: single effects, two at once, and the unknown.

use crate::blocks::{self, Fitted};
use crate::judge::Judge;
use crate::plant::{Planted, Variant};
use crate::weigh::causes::{Evidence, UNKNOWN, leader};
use crate::weigh::evidence::{CLOSE, Weighed, weigh};
use crate::weigh::pairs::{Pair, pairs};

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
