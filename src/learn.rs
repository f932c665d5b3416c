//! One learner on one log.

use std::collections::BTreeMap;

use asami_dataset::{Log, Models, Seed};
use asami_learners::{CannotLearn, Learned, Learners, Needs, catalogue};

use crate::scenario::fault::nearest;
use crate::scenario::{Start, Starting};

/// What to learn with.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// The learner's name in the catalogue.
    pub learner: String,
    /// Its parameters, where they differ from the defaults.
    pub with: BTreeMap<String, f64>,
    /// Models that it is given, from a file.
    pub given: Models,
    /// A starting model that it is given by name.
    pub start: Option<Start>,
    /// Seed of its own draws.
    pub seed: u64,
}

/// What kept the learner from being run, or from learning.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// No learner of that name.
    #[error("there is no learner {name}{}; there are {}", meant(name), names())]
    NoSuchLearner {
        /// The name asked for.
        name: String,
    },
    /// A parameter that it lacks, or a value out of range.
    #[error("{0}")]
    Parameter(String),
    /// It must be given a model, and was not.
    #[error("{learner} needs {what}")]
    NotGiven {
        /// The learner.
        learner: String,
        /// What, and how.
        what: &'static str,
    },
    /// It cannot start from that.
    #[error("{learner} cannot start from {start}")]
    WrongStart {
        /// The learner.
        learner: String,
        /// The start asked for.
        start: &'static str,
    },
    /// The log lacks something.
    #[error("{learner} cannot learn from this log: {why}")]
    CannotLearn {
        /// The learner.
        learner: String,
        /// What it lacks.
        why: CannotLearn,
    },
}

fn names() -> String {
    catalogue().iter().map(|about| about.name).collect::<Vec<_>>().join(", ")
}

fn meant(name: &str) -> String {
    let nearest = nearest(name, catalogue().iter().map(|about| about.name));
    nearest.map_or(String::new(), |name| format!(" (did you mean {name}?)"))
}

/// Learns from `log`.
///
/// # Errors
/// [`Refusal`] where the request does not fit the learner or the log does not. Divergence is no error
/// but the learner's verdict.
pub fn learn(log: &Log, request: &Request) -> Result<Learned, Refusal> {
    let name = request.learner.as_str();
    let Some(about) = catalogue().into_iter().find(|about| about.name == name) else {
        return Err(Refusal::NoSuchLearner { name: name.to_owned() });
    };
    let learner = Learners::default().configured(name, &request.with).map_err(|faults| {
        let messages: Vec<String> = faults.into_iter().map(|fault| fault.message).collect();
        Refusal::Parameter(format!("{name}: {}", messages.join("; ")))
    })?;
    // Those of a car are made from the truth, which a log does not hold.
    let makes = |start: &Start| start.fits(about.needs) && about.needs != Needs::Firings;
    if let Some(start) = request.start.filter(|start| !makes(start)) {
        return Err(Refusal::WrongStart { learner: name.to_owned(), start: start.name() });
    }
    let cannot = |why| Refusal::CannotLearn { learner: name.to_owned(), why };
    let given = match request.start {
        Some(start) if about.needs == Needs::Both => Starting::default().models(start, log).map_err(cannot)?,
        Some(start) => Models { action: start.models().and_then(|it| it.action), ..request.given.clone() },
        None => request.given.clone(),
    };
    let not_given = |what| Err(Refusal::NotGiven { learner: name.to_owned(), what });
    match about.needs {
        Needs::Action if given.action.is_none() => {
            return not_given("an action model: --start c, sgn or one, or --given MODELS");
        }
        Needs::Sensor if given.sensor.is_none() => return not_given("a sensor model: --given MODELS"),
        Needs::Both if given.action.is_none() || given.sensor.is_none() => {
            return not_given("action, sensor and noise models: --start published, attempted, ..., or --given MODELS");
        }
        _ => {}
    }
    let mut rng = Seed(request.seed).stream(&format!("learner/{name}"));
    learner.learn(log, &given, &mut rng).map_err(cannot)
}
