//! How often probabilities given to causes were right.

use asami_gap::answer::calibration::{Calibration, Left};
use asami_gap::weigh::causes::UNKNOWN;

/// Ends of the bins of probabilities.
const BINS: [f64; 7] = [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95];
/// Fewer answers make no point.
const LEAST: f64 = 5.0;
/// Fewer cases make no curve.
const LEAST_CASES: usize = 80;

/// For each bin: mean probability given, share that was true, number of answers. Each half of the cases is judged by the
/// calibration of the other.
pub(super) fn curve(cases: &[Left]) -> Vec<[f64; 3]> {
    if cases.len() < LEAST_CASES {
        return Vec::new();
    }
    // Cases that were played together stand together.
    let halves = cases.split_at(cases.len() / 2);
    let mut bins = [[0.0_f64; 3]; BINS.len()];
    for (known, held) in [halves, (halves.1, halves.0)] {
        let calibration = Calibration::of(known);
        for Left { case, .. } in held {
            // Which block an unknown cause lies in is another question.
            let truth = case.truth.split('/').next().unwrap_or(UNKNOWN);
            for (cause, probability) in calibration.probabilities(&case.evidence) {
                let bin = BINS.iter().rposition(|from| probability >= *from).unwrap_or(0);
                bins[bin][0] += probability;
                bins[bin][1] += f64::from(u8::from(cause == truth));
                bins[bin][2] += 1.0;
            }
        }
    }
    let there = bins.into_iter().filter(|[_, _, n]| *n >= LEAST);
    there.map(|[claimed, found, n]| [claimed / n, found / n, n]).collect()
}

#[cfg(test)]
mod tests {
    use asami_gap::answer::calibration::less;
    use asami_gap::weigh::causes::Evidence;
    use asami_gap::weigh::practice::Case;

    use super::*;

    /// Causes that always have plenty of evidence are given high probabilities, and were true.
    #[test]
    fn plain_cases_make_a_curve_that_ends_at_certainty() {
        let case = |i: usize| {
            let truth = if i % 2 < 1 { "a" } else { "b" };
            let nats = |cause: &str| if cause == truth { 60.0 } else { -5.0 };
            let evidence = ["a", "b", "unknown/timing"].map(|cause| (cause.to_owned(), nats(cause)));
            Case {
                truth: truth.to_owned(),
                shown: None,
                evidence: Evidence::from(evidence),
                absorbed_nats: None,
                off_by: None,
            }
        };
        let curve = curve(&less(&(0..100).map(|i| case(i / 2)).collect::<Vec<_>>(), &[]));
        let [claimed, found, n] = curve[curve.len() - 1];
        assert!(claimed > 0.95 && found == 1.0 && n == 100.0, "{curve:?}");
        assert!(curve[0][0] < 0.05 && curve[0][1] == 0.0, "{curve:?}");
    }
}
