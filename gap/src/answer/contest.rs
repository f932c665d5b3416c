//! Something that diagnoses logs, and the likelihood by which all of them may judge.

use asami_dataset::Log;

use crate::answer::diagnose::Diagnoser;
use crate::answer::diagnosis::{Cause, Diagnosis, Estimate, HowFar, SCHEMA, Verdict};
use crate::judge::Judge;
use crate::library::Responds;
use crate::plant::Planted;
use crate::weigh::groups::Signature;

/// A log cannot be diagnosed: what it lacks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct CannotDiagnose(pub String);

/// Something that diagnoses logs. It has its library and its calibration; of a log it is given nothing else.
pub trait Diagnoses: Sync {
    /// Its name in tables.
    fn name(&self) -> &str;

    /// Where, which and how far.
    ///
    /// # Errors
    /// [`CannotDiagnose`] where the log cannot show anything.
    fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotDiagnose>;
}

impl Diagnoses for Diagnoser<'_> {
    fn name(&self) -> &str {
        "asami"
    }

    fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotDiagnose> {
        Diagnoser::diagnose(self, log).map_err(|error| CannotDiagnose(error.to_string()))
    }
}

/// How likely one log is, were these effects in the world.
pub trait Likelihood: Sync {
    /// Logarithms of the log's likelihood, one for each of its blocks in order of time; their sum counts.
    /// The blocks are the same whatever the effects.
    fn blocks(&self, effects: &[Planted]) -> Vec<f64>;

    /// Observations in the log.
    fn observations(&self) -> usize;

    /// How far predictions under two hypotheses lie apart, in nats: of what is seen, of its noise and of what is missed.
    /// Next to no chance is in it, since both are of the same log.
    fn apart(&self, one: &[Planted], other: &[Planted]) -> f64;

    /// The logarithm of the whole log's likelihood.
    fn log_likelihood(&self, effects: &[Planted]) -> f64 {
        self.blocks(effects).iter().fold(0.0, |sum, block| sum + block)
    }
}

/// Makes a log's likelihood.
pub trait Judges: Sync {
    /// The likelihood of this log.
    ///
    /// # Errors
    /// [`CannotDiagnose`] where the log has too little in it.
    fn of<'a>(&'a self, log: &'a Log) -> Result<Box<dyn Likelihood + 'a>, CannotDiagnose>;
}

/// Blocks are so long.
const BLOCK_S: f64 = 5.0;

/// A log's likelihood by a library of responses.
struct ByResponse<'a>(Box<dyn Judge + 'a>);

impl Likelihood for ByResponse<'_> {
    fn blocks(&self, effects: &[Planted]) -> Vec<f64> {
        let reading = self.0.read(&self.0.numbers(effects));
        let mut blocks: Vec<f64> = Vec::new();
        let mut ends_s = f64::NEG_INFINITY;
        for (step, log_likelihood) in self.0.steps().iter().zip(&reading.log_likelihoods) {
            if step.t_s >= ends_s {
                blocks.push(0.0);
                ends_s = step.t_s + BLOCK_S;
            }
            if let Some(block) = blocks.last_mut() {
                *block += log_likelihood;
            }
        }
        blocks
    }

    fn observations(&self) -> usize {
        self.0.steps().iter().map(|step| step.seen).sum()
    }

    fn apart(&self, one: &[Planted], other: &[Planted]) -> f64 {
        let [one, other] = [one, other].map(|effects| self.0.read(&self.0.numbers(effects)));
        Signature::new(&one, &other).nats()
    }
}

impl<R: Responds> Judges for R {
    fn of<'a>(&'a self, log: &'a Log) -> Result<Box<dyn Likelihood + 'a>, CannotDiagnose> {
        let judge = self.judge(log).map_err(|error| CannotDiagnose(error.to_string()))?;
        Ok(Box::new(ByResponse(judge)))
    }
}

impl Diagnosis {
    /// The answer of a diagnoser that names one cause and gives no probabilities: what it says, it says with
    /// probability one.
    #[must_use]
    pub fn flat(named: &[Planted]) -> Self {
        let none = named.is_empty();
        let effects: Vec<String> = match none {
            true => vec!["none".to_owned()],
            false => named.iter().map(|planted| planted.variant.about.name.to_owned()).collect(),
        };
        // What has no interval says so by one of no width.
        let of = |planted: &Planted| Estimate::of(planted, [planted.size; 2]);
        let cause = Cause {
            effects: effects.clone(),
            probability: 1.0,
            evidence_nats: 0.0,
            adequacy_p: None,
            place: named.first().map(|planted| planted.variant.place().name().to_owned()),
            block: None,
            behaves_like: None,
            parameters: named.iter().flat_map(of).collect(),
        };
        Self {
            schema: SCHEMA,
            verdict: if none { Verdict::None } else { Verdict::Named },
            places: Vec::new(),
            which: vec![cause],
            set90: vec![effects],
            cannot_tell_apart: Vec::new(),
            unsettled: Vec::new(),
            draws: Vec::new(),
            next_experiment: None,
            next_keys: None,
            next_nats: None,
            next_length_s: None,
            smallest_visible: std::collections::BTreeMap::new(),
            astray_s: None,
            halves_differ: None,
            picture_period_s: None,
            command_cycle_s: None,
            noise: None,
            calibrated_on: None,
            how_far: HowFar { comment: "not asked".to_owned(), ..HowFar::default() },
        }
    }
}
