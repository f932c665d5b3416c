//! A diagnosis held against the key.

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Verdict};
use asami_gap::{Likelihood, Planted, Variant};
use asami_math::elementary::exp;
use serde::{Deserialize, Serialize};

use super::next::{Advised, Next};
use super::referee::{Effect, HALF_SD, Reference, stands_for};

/// The word for no cause.
pub const NONE: &str = "none";
/// The word for a cause in nobody's list.
pub const UNKNOWN: &str = "unknown";

/// A row of `trials.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// The answer in one word; empty where there is none.
    pub verdict: String,
    /// `none`, `unknown`, or names.
    pub named: Vec<String>,
    /// Its probability.
    pub probability: f64,
    /// Probability of the true cause.
    pub true_probability: f64,
    /// The same by its evidence alone, every cause that was thought of as probable as any other beforehand.
    #[serde(default)]
    pub evidence_probability: Option<f64>,
    /// Whether the most probable cause is the truth or of its group.
    pub top_group_right: bool,
    /// Whether what was named is.
    pub named_right: bool,
    /// Whether the 90 % set holds the truth.
    pub in_set90: bool,
    /// Causes in that set.
    pub set_size: usize,
    /// Whether it acts where the truth does; of *unknown*, whether it shows in the truth's block.
    pub place_right: Option<bool>,
    /// Error of the size over `.67 / sqrt(2 D)` of it: 1 is the median of the best there can be.
    pub parameter_error: Option<f64>,
    /// The same over the error that the bound of Cramer and Rao leaves in half of all such logs: `D` says how far an effect shows,
    /// which of a share of what is missed is far more than how sharply.
    #[serde(default)]
    pub parameter_error_cr: Option<f64>,
    /// Whether the parameter's 90 % interval holds its value.
    pub parameter_covered: Option<bool>,
    /// Nats per observation below the better of the true world and the one found.
    pub excess_before: f64,
    /// The same with what was named in the world.
    pub excess_after: f64,
    /// Share of the gap that what was named closes, where there is one.
    pub closed: Option<f64>,
    /// Share that the truth closes.
    pub oracle_closed: Option<f64>,
    /// Nats that what was named gains over *none*.
    pub gained: f64,
    /// What the diagnoser itself says that it closed.
    pub closed_claimed: Option<f64>,
    /// Of *unknown*: what it is said to behave like.
    pub behaves_like: Option<String>,
    /// Of a tie: what is asked for next.
    #[serde(default)]
    pub advised: Option<Advised>,
    /// And what that shows of it.
    #[serde(default)]
    pub next: Option<Next>,
    /// Why there is no diagnosis; empty if there is one.
    pub error: String,
}

/// What a diagnosis is held against.
pub struct Key<'a> {
    /// What was planted, and how far it shows.
    pub reference: &'a Reference,
    /// Names that were taken out of the catalogue: *unknown* is the right answer where the truth is among them, and where a
    /// part of it is, so is the other part alone.
    pub withheld: &'a [String],
    /// The likelihood of the referee.
    pub likelihood: &'a dyn Likelihood,
    /// Every kind of effect that fits.
    pub variants: &'a [Variant],
}

impl Key<'_> {
    /// Whether a cause of these words is the truth.
    fn is(&self, words: &[String]) -> bool {
        let truth = &self.reference.effects;
        let listed: Vec<&Effect> = truth.iter().filter(|effect| !self.withheld.contains(&effect.name)).collect();
        let effects: &[String] = if words == [NONE] { &[] } else { words };
        if listed.len() == truth.len() {
            return stands_for(effects, &listed);
        }
        let is_unknown = matches!(words, [word] if word.split('/').next() == Some(UNKNOWN));
        is_unknown || (!listed.is_empty() && stands_for(effects, &listed))
    }

    /// Holds a diagnosis against the truth.
    #[must_use]
    pub fn score(&self, diagnosis: &Diagnosis) -> Answer {
        let top = diagnosis.which.first();
        let named = named(diagnosis);
        let cause = diagnosis.which.iter().find(|cause| cause.effects == named);
        let in_set: Vec<&Vec<String>> = diagnosis.set90.iter().filter(|words| self.is(words)).collect();
        // Those of the truth's group count as one.
        let set_size = diagnosis.set90.len() - in_set.len() + usize::from(!in_set.is_empty());
        let of_truth = diagnosis.which.iter().filter(|cause| self.is(&cause.effects));
        let estimate = cause.and_then(|cause| self.estimate(cause));
        let mut answer = Answer {
            verdict: diagnosis.verdict.name().to_owned(),
            probability: cause.map_or(0.0, |cause| cause.probability),
            true_probability: of_truth.fold(0.0, |sum, cause| sum + cause.probability),
            evidence_probability: self.by_evidence(diagnosis),
            top_group_right: top.is_some_and(|top| self.is(&top.effects)),
            named_right: self.is(&named),
            in_set90: !in_set.is_empty(),
            set_size,
            place_right: cause.and_then(|cause| self.place_right(cause)),
            parameter_error: estimate.map(|(off, _)| off * (2.0 * self.shown()).sqrt() / HALF_SD),
            parameter_error_cr: estimate.and_then(|(off, _)| Some(off / self.reference.least_error?)),
            parameter_covered: estimate.map(|(_, covered)| covered),
            closed_claimed: diagnosis.how_far.closed,
            behaves_like: cause.and_then(|cause| cause.behaves_like.clone()),
            named,
            ..Answer::default()
        };
        self.close(cause, &mut answer);
        answer
    }

    /// The truth's share of the evidence as it is.
    fn by_evidence(&self, diagnosis: &Diagnosis) -> Option<f64> {
        let most = diagnosis.which.iter().map(|cause| cause.evidence_nats).reduce(f64::max)?;
        let share = |cause: &Cause| exp(cause.evidence_nats - most);
        let of_truth = diagnosis.which.iter().filter(|cause| self.is(&cause.effects)).map(share);
        Some(of_truth.fold(0.0, |sum, it| sum + it) / diagnosis.which.iter().map(share).fold(0.0, |sum, it| sum + it))
    }

    fn place_right(&self, cause: &Cause) -> Option<bool> {
        let effects = &self.reference.effects;
        if effects.is_empty() {
            return None;
        }
        let in_block = |block: &String| effects.iter().any(|effect| effect.block == *block);
        let at_place = |place: &String| effects.iter().any(|effect| effect.place == *place);
        Some(match (&cause.block, &cause.place) {
            (Some(block), _) => in_block(block),
            (None, Some(place)) => at_place(place),
            (None, None) => false,
        })
    }

    /// Nats by which the true world is more likely than the nominal one.
    fn shown(&self) -> f64 {
        self.reference.truth.map_or(0.0, |truth| truth - self.reference.none)
    }

    /// Error of the size, as a share of it, and whether the interval holds the truth, of the very effect planted alone.
    fn estimate(&self, cause: &Cause) -> Option<(f64, bool)> {
        let [effect] = &self.reference.effects[..] else { return None };
        let found = cause.parameters.get(&format!("{}.{}", effect.name, effect.parameter))?;
        if cause.effects != [effect.name.as_str()] || self.shown() <= 0.0 {
            return None;
        }
        let off = (found.value - effect.value).abs() / effect.size;
        Some((off, found.interval[0] <= effect.value && effect.value <= found.interval[1]))
    }

    /// How far what was named closes the gap, by the referee's likelihood of the whole log.
    fn close(&self, cause: Option<&Cause>, answer: &mut Answer) {
        let Reference { none, truth, observations, .. } = *self.reference;
        let planted = cause.map_or_else(Vec::new, |cause| self.planted(cause));
        let found = if planted.is_empty() { none } else { self.likelihood.log_likelihood(&planted) };
        let best = truth.unwrap_or(none).max(found).max(none);
        let n = (observations.max(1)) as f64;
        (answer.excess_before, answer.excess_after, answer.gained) =
            ((best - none) / n, (best - found) / n, found - none);
        if let Some(truth) = truth.filter(|_| !self.reference.effects.is_empty() && best - none > 0.0) {
            answer.closed = Some((found - none) / (best - none));
            answer.oracle_closed = Some((truth - none) / (best - none));
        }
    }

    /// A cause's effects at its values, as kinds of the catalogue.
    fn planted(&self, cause: &Cause) -> Vec<Planted> {
        let value = |path: String| cause.parameters.get(&path).map(|it| it.value);
        let of = |name: &String| of_kind(self.variants, name, &|parameter| value(format!("{name}.{parameter}")));
        cause.effects.iter().filter_map(of).collect()
    }
}

/// An effect of these values as a kind of the catalogue at a size; what is not said is not held against a kind.
pub(super) fn of_kind(variants: &[Variant], name: &str, value: &dyn Fn(&str) -> Option<f64>) -> Option<Planted> {
    let fits = |variant: &&Variant| {
        let (parameter, null) = variant.sized();
        let side = value(parameter).is_some_and(|value| (value - null) * variant.sign >= 0.0);
        let chosen = |(name, choice): &(&str, f64)| value(name).is_none_or(|value| (value - choice).abs() < 1e-6);
        side && variant.choices.iter().all(chosen)
    };
    let variant = variants.iter().filter(|variant| variant.about.name == name).find(fits)?.clone();
    let (parameter, null) = variant.sized();
    let size = (value(parameter)? - null).abs();
    Some(Planted { variant, size })
}

/// What a diagnosis names: by its verdict *none*, *unknown*, or its most probable effects.
fn named(diagnosis: &Diagnosis) -> Vec<String> {
    let word = |word: &str| vec![word.to_owned()];
    let effects = diagnosis.which.iter().find(|cause| cause.effects != [NONE] && cause.effects != [UNKNOWN]);
    match diagnosis.verdict {
        Verdict::None => word(NONE),
        Verdict::Unknown => word(UNKNOWN),
        Verdict::Named | Verdict::Tied => effects.map_or_else(|| word(UNKNOWN), |cause| cause.effects.clone()),
    }
}
