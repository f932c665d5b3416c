//! What probabilities are worth, counted by hand.

use asami::blind::answer::{Answer, Key};
use asami::blind::scenario::Measure;
use asami::blind::tally::{Asked, asked, measure};
use asami::blind::walk::Record;
use asami_dataset::Seed;
use asami_gap::{Diagnosis, Variant};
use rand::RngExt;

use super::{OfBytes, record, results};

fn said(planted: &[&str], probability: f64, right: bool, of_truth: f64, by_evidence: Option<f64>) -> Record {
    let mut record = record(planted, "a", probability, right, 20.0);
    let answer = &mut record.answers[0];
    *answer = Answer { true_probability: of_truth, evidence_probability: by_evidence, ..answer.clone() };
    record
}

/// Good (1952): the mean logarithm of what the truth was given; nothing is told to be less probable than 1e-4.
#[test]
fn the_log_score_is_the_mean_logarithm_of_the_truth_s_probability() {
    let mut records = vec![
        said(&[], 0.9, true, 0.9, Some(0.5)),
        said(&[], 0.8, true, 0.8, Some(0.25)),
        said(&["a"], 0.7, true, 0.7, Some(0.5)),
        said(&["b"], 0.7, false, 0.0, Some(0.0)),
    ];
    let found = |records: &[Record], what| {
        let results = results(records.to_vec());
        measure(what, &asked(&results, 0).collect::<Vec<Asked<'_>>>()).value
    };
    let close = |found: Option<f64>, expected: f64| assert!((found.unwrap() - expected).abs() < 1e-12, "{found:?}");
    close(found(&records, Measure::LogScore), (0.9_f64.ln() + 0.8_f64.ln() + 0.7_f64.ln() + 1e-4_f64.ln()) / 4.0);
    close(found(&records, Measure::LogScoreEvidence), (2.0 * 0.5_f64.ln() + 0.25_f64.ln() + 1e-4_f64.ln()) / 4.0);
    close(found(&records, Measure::LogScoreFrequencies), (2.0 * 0.5_f64.ln() + 2.0 * 0.25_f64.ln()) / 4.0);
    // One that was kept before evidence was.
    records.push(said(&[], 0.9, true, 0.9, None));
    assert_eq!(found(&records, Measure::LogScoreEvidence), None);
    assert_eq!(found(&[], Measure::LogScore), None);
}

/// Probabilities that are just right are not called off more often than one time in twenty, and ones that boast are.
#[test]
fn what_is_off_by_more_than_chance_is_told() {
    let mut rng = Seed(4).stream("answers");
    let mut p = |boast: f64| {
        let one = |_| {
            let probability = rng.random_range(0.5..1.0);
            said(&["a"], probability, rng.random::<f64>() < probability - boast, probability, None)
        };
        let results = results((0..120).map(one).collect());
        measure(Measure::CalibrationP, &asked(&results, 0).collect::<Vec<Asked<'_>>>()).value.unwrap()
    };
    let right: Vec<f64> = (0..40).map(|_| p(0.0)).collect();
    let below = |level: f64| right.iter().filter(|p| **p < level).count();
    // Of 40 even draws, each bound by a chance of less than a thousandth.
    assert!(below(0.05) <= 8 && (8..=32).contains(&below(0.5)), "{right:?}");
    assert!((0..10).all(|_| p(0.25) < 0.01));
}

/// A diagnosis whose causes have 0, 2 and 4 nats: by evidence alone the second has `e^2` of `1 + e^2 + e^4`.
#[test]
fn evidence_alone_takes_every_cause_for_as_probable_beforehand() {
    let variants = Variant::all("plain", 4, &[]);
    let reference = record(&["command_delay"], "a", 0.5, true, 20.0).reference.unwrap();
    let likelihood = OfBytes { base: 0.0 };
    let key = Key { reference: &reference, withheld: &[], likelihood: &likelihood, variants: &variants };
    let mut diagnosis = Diagnosis::flat(&[]);
    let like = diagnosis.which[0].clone();
    let causes = [("none", 0.0), ("command_delay", 2.0), ("slope", 4.0)];
    let cause = |(name, nats): (&str, f64)| {
        let mut cause = like.clone();
        (cause.effects, cause.evidence_nats, cause.probability) = (vec![name.to_owned()], nats, 1.0 / 3.0);
        cause
    };
    diagnosis.which = causes.map(cause).to_vec();
    let found = key.score(&diagnosis).evidence_probability.unwrap();
    let expected = 2.0_f64.exp() / (1.0 + 2.0_f64.exp() + 4.0_f64.exp());
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}
