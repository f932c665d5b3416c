//! The calibration of least penalised log-loss.

use asami_math::elementary::{exp, ln_1p};

use super::{Calibration, HIDDEN, SLIP, class, counts, greatest, nats, parts, top_single};
use crate::weigh::causes::{NONE, is_unknown, leader};
use crate::weigh::practice::Case;

/// Share of cases whose cause is in nobody's list, in what is learned from: a wrong name is worse than none.
const SHARE_UNKNOWN: f64 = 0.2;
/// How many numbers there are beside the causes'.
const GLOBALS: usize = 4;
/// Steps of the descent.
const STEPS: usize = 400;
/// Prior mean of the logarithms of the fades per 100 nats.
const FADE_LN: f64 = -1.0;
/// Prior standard deviation of what is added for a cause.
const BETA_SD: f64 = 1.5;
/// What is added for a block is counted in so many nats: blocks pay for a freedom that hardly any cause needs in full.
const BLOCK_NATS: f64 = 10.0;

/// Gradient descent on the penalised log-loss, by Adam (Kingma and Ba 2015).
pub(super) fn fit(cases: &[&Case]) -> Calibration {
    let causes: Vec<String> = {
        let classes = cases.iter().flat_map(|case| case.evidence.keys()).map(|cause| class(cause));
        let all: std::collections::BTreeSet<&str> = classes.chain([NONE, HIDDEN]).collect();
        all.into_iter().map(str::to_owned).collect()
    };
    // Logarithms of the weight, of its fade, of the blocks' weight and of the fade of what is beyond, then what is added for each
    // cause.
    let mut at = vec![0.0; GLOBALS + causes.len()];
    (at[1], at[3]) = (FADE_LN, FADE_LN);
    let (mut mean, mut square) = (vec![0.0; at.len()], vec![0.0; at.len()]);
    let read = |at: &[f64]| Calibration {
        tau: exp(at[0]),
        fade: exp(at[1]) / 100.0,
        tau_beyond: exp(at[2]),
        fade_beyond: exp(at[3]) / 100.0,
        beta: causes.iter().zip(&at[GLOBALS..]).map(|(cause, at)| (cause.clone(), unit(cause) * at)).collect(),
        ..Calibration::default()
    };
    for step in 1..=STEPS {
        let slope = slope(cases, &read(&at), &causes, &at);
        let rate = 0.2 / (1.0 + step as f64 / 50.0);
        for (((at, slope), mean), square) in at.iter_mut().zip(slope).zip(&mut mean).zip(&mut square) {
            *mean = 0.9 * *mean + 0.1 * slope;
            *square = 0.99 * *square + 0.01 * slope * slope;
            let (m, s) = (*mean / (1.0 - 0.9_f64.powi(step as i32)), *square / (1.0 - 0.99_f64.powi(step as i32)));
            *at -= rate * m / (s.sqrt() + 1e-8);
        }
    }
    read(&at)
}

fn unit(cause: &str) -> f64 {
    if is_unknown(cause) { BLOCK_NATS } else { 1.0 }
}

/// How much a case whose cause is taken out of the list counts, so that they are as frequent as is wanted:
/// there is one for each case with one effect.
fn weight_of_unknown(cases: &[&Case]) -> f64 {
    let unknown = cases.iter().filter(|case| is_unknown(&case.truth)).count() as f64;
    let known = cases.len() as f64 - unknown;
    SHARE_UNKNOWN / (1.0 - SHARE_UNKNOWN) * known / unknown.max(1.0)
}

/// Gradient of the log-loss, with its penalties.
fn slope(cases: &[&Case], calibration: &Calibration, causes: &[String], at: &[f64]) -> Vec<f64> {
    let mut slope = vec![0.0; at.len()];
    let weigh_unknown = weight_of_unknown(cases);
    for case in cases {
        let weight = if is_unknown(&case.truth) { weigh_unknown } else { 1.0 };
        let probabilities = calibration.by_block(&case.evidence);
        let top = greatest(&case.evidence);
        let fading = 1.0 + calibration.fade * top;
        let even = SLIP / probabilities.len() as f64;
        let of_truth = probabilities.get(case.truth.as_str()).copied().unwrap_or(0.0);
        // The share of the truth's probability that evidence gave it.
        let told = if of_truth > 0.0 { (of_truth - even) / of_truth } else { 0.0 };
        let leader = leader(&case.evidence);
        let (top_single, leader_nats) = (top_single(&case.evidence), nats(&case.evidence, leader));
        let lasting = calibration.lasting(top_single);
        let lasting_slope = -calibration.fade_beyond * top_single * lasting * lasting;
        let off = |cause: &str, p: f64| {
            let sharp = (p - even) / (1.0 - SLIP);
            weight * told * (sharp - f64::from(u8::from(*cause == case.truth)))
        };
        let of_class = |slope: &mut [f64], class: &str, off: f64| {
            if let Ok(i) = causes.binary_search_by(|it| it.as_str().cmp(class)) {
                slope[GLOBALS + i] += off;
            }
        };
        // The blocks stand on the leader's probability.
        let mut of_blocks = 0.0;
        for (cause, p) in probabilities.iter().filter(|(cause, _)| is_unknown(cause)) {
            let off = off(cause, *p);
            of_blocks += off;
            let beyond = nats(&case.evidence, cause) - leader_nats + calibration.beta(cause);
            let (share, share_slope) = if beyond > 0.0 { (lasting, lasting_slope) } else { (1.0, 0.0) };
            slope[2] += off * calibration.tau_beyond * share * beyond;
            slope[3] += off * calibration.tau_beyond * share_slope * beyond;
            of_class(&mut slope, cause, off * calibration.tau_beyond * share * unit(cause));
        }
        for (cause, p) in probabilities.iter().filter(|(cause, _)| !is_unknown(cause)) {
            let off = off(cause, *p) + if *cause == leader { of_blocks } else { 0.0 };
            let (of_top, beyond) = parts(cause, nats(&case.evidence, cause), top_single);
            let (class, beyond) = calibration.beyond(cause, counts(beyond, lasting));
            slope[0] += off * calibration.tau * (of_top / fading + beyond);
            if beyond > 0.0 {
                slope[3] += off * calibration.tau * beyond / lasting * lasting_slope;
            }
            slope[1] -= off * of_top * calibration.tau * calibration.fade * top / (fading * fading);
            of_class(&mut slope, class, off);
        }
    }
    slope[0] += at[0] / 0.25;
    slope[1] += (at[1] - FADE_LN) / 4.0;
    slope[2] += at[2] / 0.25;
    slope[3] += (at[3] - FADE_LN) / 4.0;
    for (slope, at) in slope[GLOBALS..].iter_mut().zip(&at[GLOBALS..]) {
        *slope += at / (BETA_SD * BETA_SD);
    }
    slope
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
