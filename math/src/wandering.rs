//! A phase that wanders: a hidden Markov chain on a circle, forwards and backwards (Baum et al. 1970; Rabiner 1989, section III.A).

use crate::elementary::{exp, ln};

/// What is known of a phase at every step.
#[derive(Clone, Debug, PartialEq)]
pub struct Phases<const N: usize> {
    /// How likely all evidence together is, as a logarithm.
    pub log_likelihood: f64,
    /// For every step how probable each phase is, by all evidence.
    pub probable: Vec<[f64; N]>,
}

/// From step to step the phase moves by a Gaussian on the circle, whose standard deviation is `wanders` turns; at first every phase is
/// as probable. `evidence` holds for every step the logarithm of how likely what is seen there is at each of `N` phases.
#[must_use]
pub fn phases<const N: usize>(evidence: &[[f64; N]], wanders: f64) -> Phases<N> {
    let moves = moves::<N>(wanders);
    let mut log_likelihood = 0.0;
    let mut before = [1.0 / N as f64; N];
    let mut probable = Vec::with_capacity(evidence.len());
    for seen in evidence {
        let (most, likely) = relative(seen);
        let joint: [f64; N] = std::array::from_fn(|i| before[i] * likely[i]);
        let sum: f64 = joint.iter().sum();
        log_likelihood += most + ln(sum);
        let now = joint.map(|it| it / sum);
        probable.push(now);
        before = moved(&now, &moves);
    }
    let mut after = [1.0; N];
    for (now, seen) in probable.iter_mut().zip(evidence).rev() {
        let joint: [f64; N] = std::array::from_fn(|i| now[i] * after[i]);
        let sum: f64 = joint.iter().sum();
        *now = joint.map(|it| it / sum);
        let (_, likely) = relative(seen);
        // A move is as probable as the one back.
        after = moved(&std::array::from_fn(|i| after[i] * likely[i]), &moves);
        let sum: f64 = after.iter().sum();
        after = after.map(|it| it / sum);
    }
    Phases { log_likelihood, probable }
}

/// How probable it is to move by so many `N`-ths of a turn.
fn moves<const N: usize>(wanders: f64) -> [f64; N] {
    let weight = |by: usize| {
        let turns = by.min(N - by) as f64 / N as f64 / wanders.max(1e-9);
        exp(-0.5 * turns * turns)
    };
    let weights: [f64; N] = std::array::from_fn(weight);
    let sum: f64 = weights.iter().sum();
    weights.map(|it| it / sum)
}

fn moved<const N: usize>(from: &[f64; N], moves: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|to| (0..N).map(|by| moves[by] * from[(to + N - by) % N]).sum())
}

/// The greatest logarithm, and the others' numbers in units of its own.
fn relative<const N: usize>(logarithms: &[f64; N]) -> (f64, [f64; N]) {
    let most = logarithms.iter().fold(f64::NEG_INFINITY, |most, it| most.max(*it));
    (most, logarithms.map(|it| exp(it - most)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 5;
    const SEEN: [[f64; N]; 4] =
        [[0.0, -1.0, -2.0, 0.5, 0.3], [0.0; N], [-3.0, 0.2, -0.1, -0.4, -900.0], [0.7, -1.0, 0.1, -2.0, 0.4]];

    /// Over all ways through four steps, added up one by one.
    #[test]
    fn forwards_and_backwards_is_the_sum_over_all_ways() {
        for wanders in [0.05, 0.2, 2.0] {
            let moves = moves::<N>(wanders);
            let (mut all, mut of) = (0.0, [[0.0; N]; 4]);
            for way in 0..N.pow(4) {
                let at: [usize; 4] = std::array::from_fn(|step| way / N.pow(step as u32) % N);
                let moved = (1..4).fold(1.0 / N as f64, |p, step| p * moves[(at[step] + N - at[step - 1]) % N]);
                let p = moved * exp((0..4).map(|step| SEEN[step][at[step]]).sum());
                all += p;
                (0..4).for_each(|step| of[step][at[step]] += p);
            }
            let found = phases(&SEEN, wanders);
            assert!((found.log_likelihood - ln(all)).abs() < 1e-12, "{wanders}");
            for (found, of) in found.probable.iter().zip(of) {
                assert!((0..N).all(|i| (found[i] - of[i] / all).abs() < 1e-12), "{wanders}: {found:?}");
            }
        }
    }

    /// A phase that stays is known everywhere by what is seen once; one that wanders is forgotten.
    #[test]
    fn a_phase_is_remembered_for_as_long_as_it_stays() {
        let mut seen = vec![[0.0; N]; 50];
        seen[0][3] = 40.0;
        assert!((phases(&seen, 1e-3).probable[49][3] - 1.0).abs() < 1e-9);
        assert!((phases(&seen, 0.3).probable[49][3] - 0.2).abs() < 1e-9);
        assert_eq!(phases::<N>(&[], 0.1), Phases { log_likelihood: 0.0, probable: Vec::new() });
    }
}
