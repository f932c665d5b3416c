//! How much a log parts two explanations of it, and what counts of a nat by which one is likelier.

use super::unsure::blocks;
use crate::judge::Judge;
use crate::plant::Planted;
use crate::weigh::groups::Signature;

/// Two explanations of a log.
pub(super) struct Apart {
    /// By so much the log parts what they predict, in nats.
    pub nats: f64,
    /// What counts of a nat by which one is likelier. Were the noise what it is taken for, that by which one is likelier would scatter by
    /// twice the nats that part them; as far as it scatters by more from block to block, less of it counts (Vuong 1989, whose test is of
    /// the same sum over the same variance).
    pub counts: f64,
}

impl Apart {
    /// Of these effects and those.
    pub(super) fn new(judge: &dyn Judge, these: &[Planted], those: &[Planted]) -> Self {
        let [these, those] = [these, those].map(|all| judge.read(&judge.numbers(all)));
        let nats = Signature::new(&these, &those).nats();
        let block = blocks(judge);
        let mut by_block = vec![0.0; block.last().map_or(0, |last| last + 1)];
        let terms = these.log_likelihoods.iter().zip(&those.log_likelihoods);
        block.iter().zip(terms).for_each(|(block, (this, that))| by_block[*block] += this - that);
        Self { nats, counts: counts(&by_block, nats) }
    }
}

/// Of by how much likelier one is in each block.
fn counts(by_block: &[f64], nats: f64) -> f64 {
    let n = by_block.len() as f64;
    let mean = by_block.iter().sum::<f64>() / n;
    let scatters = by_block.iter().fold(0.0, |sum, it| sum + (it - mean) * (it - mean)) * n / (n - 1.0);
    if scatters > 2.0 * nats { 2.0 * nats / scatters } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    /// Two explanations of a log of neither noise nor blocks but as they are taken to be: every nat counts, or nearly so. Where the log errs
    /// by three times as much as it is taken to, one in nine does.
    #[test]
    fn what_scatters_as_it_should_counts() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let of = |k: usize, share: f64| Planted { variant: kinds[k].clone(), size: share * kinds[k].sizes().1 };
        let (first, second) = (|t: usize| 3.0 * (0.37 * t as f64).sin(), |t: usize| 3.0 * (0.41 * t as f64).sin());
        let mean = |louder: f64| {
            let of_seed = |seed: u64| {
                let mut log = Straight::new(&[of(0, 0.5)], &[&first, &second], Seed(seed));
                let made: Vec<f64> =
                    (0..log.measured.len()).map(|t| log.made(&log.numbers(&[of(0, 0.5)]), t)).collect();
                log.measured.iter_mut().zip(made).for_each(|(it, made)| *it = made + louder * (*it - made));
                Apart::new(&log, &[of(0, 0.5)], &[of(1, 0.5)]).counts
            };
            (0..20).map(of_seed).sum::<f64>() / 20.0
        };
        let [as_it_is, louder] = [1.0, 3.0].map(mean);
        assert!(as_it_is > 0.7 && (0.07..0.17).contains(&louder), "{as_it_is} {louder}");
    }

    /// What one gains in a single block of twenty, and loses a little of in all others, hardly counts.
    #[test]
    fn a_single_block_is_hardly_counted() {
        let mut by_block = [0.0; 20];
        by_block[7] = 8.0;
        assert!(counts(&by_block, 3.0) < 0.1);
        assert!((counts(&[0.4; 20], 3.0) - 1.0).abs() < 1e-12);
    }
}
