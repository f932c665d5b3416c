//! What probabilities are worth over many cases: their log score beside two that need no calibration, and whether they could be
//! just right.

use std::collections::BTreeMap;

use asami_dataset::Seed;
use asami_math::elementary::ln;
use rand::RngExt;

use super::tally::{Asked, Bin, reliability};

/// A diagnosis leaves less probable causes out, so that no truth is told to be less probable.
const LEAST: f64 = 1e-4;
/// How often answers are drawn that come true as often as they are said to.
const DRAWS: usize = 2000;

/// The mean logarithm of the truth's probability (Good 1952); `None` of no case, or where one has none.
fn log_score(of_truth: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let said: Option<Vec<f64>> = of_truth.map(|p| p.map(|p| ln(p.clamp(LEAST, 1.0)))).collect();
    asami_math::statistics::mean(&said?)
}

/// That of the probabilities that were said.
#[must_use]
pub fn of_answers(cases: &[Asked<'_>]) -> Option<f64> {
    log_score(cases.iter().map(|asked| Some(asked.answer.true_probability)))
}

/// That of the evidence as it is, every cause that was thought of as probable as any other beforehand.
#[must_use]
pub fn of_evidence(cases: &[Asked<'_>]) -> Option<f64> {
    log_score(cases.iter().map(|asked| asked.answer.evidence_probability))
}

/// That of how often each truth is planted in these very cases, whatever their logs show.
#[must_use]
pub fn of_frequencies(cases: &[Asked<'_>]) -> Option<f64> {
    let class = |asked: &Asked<'_>| {
        let mut names = asked.record.planted.clone();
        names.sort();
        (names, !asked.record.withheld.is_empty())
    };
    let mut counts: BTreeMap<_, f64> = BTreeMap::new();
    cases.iter().for_each(|asked| *counts.entry(class(asked)).or_default() += 1.0);
    log_score(cases.iter().map(|asked| counts.get(&class(asked)).map(|count| count / cases.len() as f64)))
}

/// Distance between probability and share right, over bins.
#[must_use]
pub fn calibration_error(bins: &[Bin]) -> Option<f64> {
    let n: u32 = bins.iter().map(|bin| bin.right.of).sum();
    let off = |bin: &Bin| (bin.right.value().unwrap_or(0.0) - bin.probability).abs() * f64::from(bin.right.of);
    (n > 0).then(|| bins.iter().map(off).fold(0.0, |sum, off| sum + off) / f64::from(n))
}

/// How often answers of the same probabilities that are just right are off by as much or more (Bröcker and Smith 2007); below 0.05
/// these are not.
#[must_use]
pub fn calibration_p(cases: &[Asked<'_>]) -> Option<f64> {
    let off = calibration_error(&reliability(cases.iter().copied()))?;
    let mut answers: Vec<_> = cases.iter().map(|asked| asked.answer.clone()).collect();
    let mut rng = Seed(1).stream("answers that are just right");
    let as_far = (0..DRAWS).filter(|_| {
        for answer in &mut answers {
            answer.named_right = rng.random::<f64>() < answer.probability;
        }
        let drawn = cases.iter().zip(&answers).map(|(asked, answer)| Asked { answer, ..*asked });
        calibration_error(&reliability(drawn)).is_some_and(|drawn| drawn >= off)
    });
    Some(as_far.count() as f64 / DRAWS as f64)
}
