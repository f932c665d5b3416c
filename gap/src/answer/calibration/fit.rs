//! The calibration of least penalised log-loss.

use asami_math::elementary::{exp, ln, ln_1p};
use asami_math::quasi_newton::lbfgs;

use super::{Calibration, HIDDEN, Left, SEVERAL, SLIP, Said, class, greatest, nats};
use crate::weigh::causes::{NONE, is_unknown, leader};
use crate::weigh::practice::Case;

/// Of cases in which there is a cause, the share of those whose cause is in nobody's list, in what is learned from.
const SHARE_UNKNOWN: f64 = 0.2;
/// How many numbers there are beside the causes'.
const GLOBALS: usize = 4;
/// Steps of the search.
const STEPS: usize = 300;
/// Where the slope is so flat, in nats, it ends.
const FLAT: f64 = 1e-3;
/// Prior mean of the logarithm of the fade per 100 nats.
const FADE_LN: f64 = -1.0;
/// Prior mean of the logarithm of the library's error: a part in fifty of what an effect explains.
const ERROR_LN: f64 = -4.0;
/// Prior standard deviation of what is added for a cause.
const BETA_SD: f64 = 1.5;
/// Prior standard deviation of the logarithm of how many times the error an effect has.
const OWN_SD: f64 = 1.0;
/// What is added for a block is counted in so many nats: blocks pay for a freedom that hardly any cause needs in full.
const BLOCK_NATS: f64 = 10.0;

/// The least penalised log-loss.
pub(super) fn fit(cases: &[&Left]) -> Calibration {
    let causes = causes(cases);
    let mut start = vec![0.0; GLOBALS + 2 * causes.len()];
    (start[1], start[3]) = (FADE_LN, ERROR_LN);
    let loss = |at: &[f64]| loss(cases, &read(&causes, at), &causes, at);
    read(&causes, &lbfgs(loss, &start, STEPS, FLAT).at)
}

/// All that numbers are learned for.
fn causes(cases: &[&Left]) -> Vec<String> {
    let classes = cases.iter().flat_map(|left| left.case.evidence.keys()).map(|cause| class(cause));
    let all: std::collections::BTreeSet<&str> = classes.chain([NONE, HIDDEN]).collect();
    all.into_iter().map(str::to_owned).collect()
}

/// Numbers as they are searched: logarithms of the weight, of its fade, of the blocks' weight and of the library's error, then what
/// is added for each cause, then how many times that error each effect has.
fn read(causes: &[String], at: &[f64]) -> Calibration {
    let (added, own) = at[GLOBALS..].split_at(causes.len());
    Calibration {
        tau: exp(at[0]),
        fade: exp(at[1]) / 100.0,
        tau_beyond: exp(at[2]),
        error: exp(at[3]),
        beta: causes.iter().zip(added).map(|(cause, at)| (cause.clone(), unit(cause) * at)).collect(),
        own_error: causes.iter().cloned().zip(own.iter().copied()).collect(),
        ..Calibration::default()
    }
}

fn place(causes: &[String], cause: &str) -> Option<usize> {
    causes.binary_search_by(|it| it.as_str().cmp(cause)).ok()
}

fn unit(cause: &str) -> f64 {
    if is_unknown(cause) { BLOCK_NATS } else { 1.0 }
}

/// How much cases count. There is one that stands for a cause in nobody's list for each that was planted with one effect; as many
/// as were planted have a cause at all.
pub(super) struct Weights {
    of_planted: f64,
    of_stand_in: f64,
}

impl Weights {
    pub(super) fn of(cases: &[&Left]) -> Self {
        let planted = cases.iter().filter(|left| left.planted && left.case.truth != NONE).count() as f64;
        let stand_ins = cases.iter().filter(|left| !left.planted).count() as f64;
        if stand_ins > 0.0 {
            Self { of_planted: 1.0 - SHARE_UNKNOWN, of_stand_in: SHARE_UNKNOWN * planted / stand_ins }
        } else {
            Self { of_planted: 1.0, of_stand_in: 0.0 }
        }
    }

    pub(super) fn weight(&self, left: &Left) -> f64 {
        match left.planted {
            true if left.case.truth == NONE => 1.0,
            true => self.of_planted,
            false => self.of_stand_in,
        }
    }
}

/// The log-loss with its penalties, and its gradient.
fn loss(cases: &[&Left], calibration: &Calibration, causes: &[String], at: &[f64]) -> (f64, Vec<f64>) {
    let (mut loss, mut slope) = (0.0, vec![0.0; at.len()]);
    let weights = Weights::of(cases);
    for left in cases {
        let weight = weights.weight(left);
        loss += weight * of_case(&left.case, calibration, causes, weight, &mut slope);
    }
    for (i, (slope, at)) in slope.iter_mut().zip(at).enumerate() {
        let (mean, sd) = prior(i, causes.len());
        let off = (at - mean) / sd;
        loss += 0.5 * off * off;
        *slope += off / sd;
    }
    (loss, slope)
}

/// Prior mean and standard deviation of the `i`-th number.
fn prior(i: usize, causes: usize) -> (f64, f64) {
    match i {
        0 | 2 => (0.0, 0.5),
        1 => (FADE_LN, 2.0),
        3 => (ERROR_LN, 2.0),
        _ if i < GLOBALS + causes => (0.0, BETA_SD),
        _ => (0.0, OWN_SD),
    }
}

/// The log-loss of a case; its gradient, so many times, is added to `slope`.
fn of_case(case: &Case, calibration: &Calibration, causes: &[String], weight: f64, slope: &mut [f64]) -> f64 {
    let probabilities = calibration.sharp_and_slipped(&case.evidence);
    let top = greatest(&case.evidence);
    let fading = 1.0 + calibration.fade * top;
    // What is nowhere among the causes says nothing.
    let Some([by_evidence, slipped]) = probabilities.get(case.truth.as_str()).copied() else { return 0.0 };
    let of_truth = by_evidence + slipped;
    // The share of the truth's probability that evidence gave it.
    let told = by_evidence / of_truth;
    let leader = leader(&case.evidence);
    let leader_nats = nats(&case.evidence, leader);
    let of_one = calibration.top(&case.evidence);
    let (error, own) = (of_one.error, of_one.effect.and_then(|effect| place(causes, effect)));
    let off =
        |cause: &str, sharp: f64| weight * told * (sharp / (1.0 - SLIP) - f64::from(u8::from(*cause == case.truth)));
    let of_class = |slope: &mut [f64], class: &str, off: f64| {
        if let Some(i) = place(causes, class) {
            slope[GLOBALS + i] += off;
        }
    };
    let of_error = |slope: &mut [f64], off: f64| {
        slope[3] -= off * error;
        if let Some(i) = own {
            slope[GLOBALS + causes.len() + i] -= off * error;
        }
    };
    // The blocks stand on the leader's probability.
    let mut of_blocks = 0.0;
    for (cause, [sharp, _]) in probabilities.iter().filter(|(cause, _)| is_unknown(cause)) {
        let off = off(cause, *sharp);
        of_blocks += off;
        let beyond = nats(&case.evidence, cause) - leader_nats + calibration.beta(cause) - error;
        let of_nats = off * calibration.tau_beyond;
        slope[2] += of_nats * beyond;
        of_error(slope, of_nats);
        of_class(slope, cause, of_nats * unit(cause));
    }
    for (cause, [sharp, _]) in probabilities.iter().filter(|(cause, _)| !is_unknown(cause)) {
        let off = off(cause, *sharp) + if *cause == leader { of_blocks } else { 0.0 };
        let Said { of_top, class, beyond } = calibration.said(cause, &case.evidence, &of_one);
        slope[0] += off * calibration.tau * of_top / fading;
        slope[1] -= off * of_top * calibration.tau * calibration.fade * top / (fading * fading);
        if class == SEVERAL {
            slope[0] += off * calibration.tau * beyond;
            of_error(slope, off * calibration.tau);
        }
        of_class(slope, class, off);
    }
    -ln(of_truth)
}

/// Mean of `-log2` probabilities given to the truth would be bits; this is in nats, for reports.
#[must_use]
pub fn log_loss(calibration: &Calibration, cases: &[Case]) -> f64 {
    let loss = |case: &Case| {
        let p = calibration.by_block(&case.evidence).get(case.truth.as_str()).copied().unwrap_or(0.0);
        -ln_1p(p.max(1e-12) - 1.0)
    };
    cases.iter().map(loss).fold(0.0, |sum, it| sum + it) / cases.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::less;
    use super::super::tests::with_a_library_that_errs;
    use super::*;

    #[test]
    fn the_gradient_is_the_loss_s() {
        let cases = with_a_library_that_errs(60);
        let cases = less(&cases, &[]);
        let cases: Vec<&Left> = cases.iter().collect();
        let causes = causes(&cases);
        let at: Vec<f64> = (0..GLOBALS + 2 * causes.len()).map(|i| [-0.3, 0.4, 0.2, -3.0][i % GLOBALS] * 0.9).collect();
        let value = |at: &[f64]| loss(&cases, &read(&causes, at), &causes, at);
        let (_, slope) = value(&at);
        for i in 0..at.len() {
            let moved = |by: f64| {
                let mut at = at.clone();
                at[i] += by;
                value(&at).0
            };
            let found = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((found - slope[i]).abs() < 1e-5 * (1.0 + found.abs()), "{i}: {found} {}", slope[i]);
        }
    }
}
