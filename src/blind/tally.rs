//! Numbers over many cases: shares with intervals, by strata of how far a case's truth is separated.

use asami_math::elementary::{exp, ln};
use asami_math::statistics::{median, wilson_interval};

use super::answer::{Answer, NONE, UNKNOWN};
use super::next::Next;
use super::referee::Reference;
use super::scenario::Measure;
use super::scores;
use super::walk::{Record, Results};

/// One diagnoser's answer to one case that has a reference.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The case.
    pub record: &'a Record,
    /// Its key.
    pub reference: &'a Reference,
    /// The answer.
    pub answer: &'a Answer,
}

impl Asked<'_> {
    /// Whether anything was planted.
    #[must_use]
    pub fn is_planted(&self) -> bool {
        !self.record.planted.is_empty()
    }

    /// Whether the log tells the truth from everything else by so many nats.
    #[must_use]
    pub fn is_separated(&self, nats: std::ops::Range<f64>) -> bool {
        self.reference.d_sep.is_some_and(|d_sep| nats.contains(&d_sep))
    }

    fn names_nothing_else(&self) -> bool {
        let is_there = |name: &String| self.reference.effects.iter().any(|effect| effect.group.contains(name));
        self.answer.named.iter().all(|name| name == NONE || name == UNKNOWN || is_there(name))
    }
}

/// A share of cases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Cases of which it is so.
    pub count: u32,
    /// Of how many.
    pub of: u32,
}

impl Share {
    /// Of the items of which something is said at all.
    pub fn over(said: impl Iterator<Item = bool>) -> Self {
        said.fold(Self::default(), |so_far, it| Self { count: so_far.count + u32::from(it), of: so_far.of + 1 })
    }

    /// The share; `None` of nothing.
    #[must_use]
    pub fn value(&self) -> Option<f64> {
        (self.of > 0).then(|| f64::from(self.count) / f64::from(self.of))
    }

    /// Its 95 % interval (Wilson 1927).
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        wilson_interval(self.count, self.of, 0.95)
    }
}

/// A stratum of cases by `d_sep`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stratum {
    /// In tables.
    pub name: &'static str,
    /// From so many nats.
    pub from: f64,
    /// To less than so many.
    pub to: f64,
}

/// In the order of tables; the last is all of them.
pub const STRATA: [Stratum; 5] = [
    Stratum { name: "< 3", from: f64::NEG_INFINITY, to: 3.0 },
    Stratum { name: "3-10", from: 3.0, to: 10.0 },
    Stratum { name: "10-30", from: 10.0, to: 30.0 },
    Stratum { name: "> 30", from: 30.0, to: f64::INFINITY },
    Stratum { name: "all", from: f64::NEG_INFINITY, to: f64::INFINITY },
];

impl Stratum {
    /// Whether a case belongs to it.
    #[must_use]
    pub fn holds(&self, asked: &Asked<'_>) -> bool {
        self.holds_nats(asked.reference.d_sep)
    }

    /// Whether so many nats do. Of some cases nobody can say how many.
    #[must_use]
    pub fn holds_nats(&self, nats: Option<f64>) -> bool {
        let is_all = (self.from, self.to) == (f64::NEG_INFINITY, f64::INFINITY);
        is_all || nats.is_some_and(|nats| (self.from..self.to).contains(&nats))
    }
}

/// The answers of the `i`-th diagnoser to all cases that could be judged; a log that it would not diagnose is an answer
/// too, and right in nothing.
pub fn asked(results: &Results, i: usize) -> impl Iterator<Item = Asked<'_>> + Clone {
    results.records.iter().filter_map(move |record| asked_of(record, i))
}

/// That to one case.
#[must_use]
pub fn asked_of(record: &Record, i: usize) -> Option<Asked<'_>> {
    let (reference, answer) = (record.reference.as_ref()?, record.answers.get(i)?);
    Some(Asked { record, reference, answer })
}

/// Answers with a probability of so much are confident.
const CONFIDENT: f64 = 0.9;
/// Bins of probability.
const BINS: usize = 10;

/// A bin of the reliability curve: mean probability, share right, and how many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Mean probability of what was named.
    pub probability: f64,
    /// How often that was right.
    pub right: Share,
    /// Variance of how many of them would be right, were each as probable as it is said to be.
    pub variance: f64,
}

/// Probabilities of what was named against how often it was right, by ten bins of equal width; empty ones are left out.
pub fn reliability<'a>(cases: impl Iterator<Item = Asked<'a>>) -> Vec<Bin> {
    let mut bins = vec![Bin { probability: 0.0, right: Share::default(), variance: 0.0 }; BINS];
    for asked in cases.filter(|asked| asked.answer.error.is_empty()) {
        let probability = asked.answer.probability.clamp(0.0, 1.0);
        let bin = &mut bins[((probability * BINS as f64) as usize).min(BINS - 1)];
        bin.probability += probability;
        bin.variance += probability * (1.0 - probability);
        bin.right = Share { count: bin.right.count + u32::from(asked.answer.named_right), of: bin.right.of + 1 };
    }
    let mean = |bin: Bin| Bin { probability: bin.probability / f64::from(bin.right.of), ..bin };
    bins.into_iter().filter(|bin| bin.right.of > 0).map(mean).collect()
}

/// The calibration error to be expected by chance, were each probability just right: in every bin the mean size of a Gaussian of its
/// variance.
#[must_use]
pub fn calibration_by_chance(bins: &[Bin]) -> Option<f64> {
    let n: u32 = bins.iter().map(|bin| bin.right.of).sum();
    let off = |bin: &Bin| (bin.variance * std::f64::consts::FRAC_2_PI).sqrt();
    (n > 0).then(|| bins.iter().map(off).fold(0.0, |sum, off| sum + off) / f64::from(n))
}

/// A measure over cases, with the counts behind it where it is a share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The number; `None` where no case says anything.
    pub value: Option<f64>,
    /// Counts.
    pub share: Option<Share>,
}

impl From<Share> for Measured {
    fn from(share: Share) -> Self {
        Self { value: share.value(), share: Some(share) }
    }
}

impl From<Option<f64>> for Measured {
    fn from(value: Option<f64>) -> Self {
        Self { value, share: None }
    }
}

/// What was recorded next of those that were tied.
fn followed<'a>(cases: &'a [Asked<'_>]) -> impl Iterator<Item = Next> + 'a {
    cases.iter().filter_map(|asked| asked.answer.next)
}

/// The median of those there are.
fn middle(errors: impl Iterator<Item = Option<f64>>) -> Measured {
    median(&errors.flatten().collect::<Vec<_>>()).into()
}

/// Measures some cases.
#[must_use]
pub fn measure(measure: Measure, cases: &[Asked<'_>]) -> Measured {
    let all = || cases.iter();
    let planted = || all().filter(|asked| asked.is_planted());
    let mean = |values: Vec<f64>| asami_math::statistics::mean(&values);
    match measure {
        Measure::TopGroupRight => Share::over(planted().map(|asked| asked.answer.top_group_right)).into(),
        Measure::NamedRight => Share::over(planted().map(|asked| asked.answer.named_right)).into(),
        Measure::NothingElseNamed => Share::over(planted().map(|asked| asked.names_nothing_else())).into(),
        Measure::InSet90 => Share::over(all().map(|asked| asked.answer.in_set90)).into(),
        Measure::SetSize => mean(all().map(|asked| asked.answer.set_size as f64).collect()).into(),
        Measure::NoneCalledElse => {
            let none = all().filter(|asked| !asked.is_planted());
            Share::over(none.map(|asked| asked.answer.named != [NONE])).into()
        }
        Measure::ConfidentWrong => {
            let confident = all().filter(|asked| asked.answer.probability >= CONFIDENT);
            Share::over(confident.map(|asked| !asked.answer.named_right)).into()
        }
        Measure::ConfidentlyMisnamed => {
            let named =
                |answer: &Answer| answer.named != [NONE] && answer.named != [UNKNOWN] && !answer.named.is_empty();
            let misnamed = |answer: &Answer| named(answer) && answer.probability >= CONFIDENT && !answer.named_right;
            Share::over(all().map(|asked| misnamed(asked.answer))).into()
        }
        Measure::Unknown => Share::over(all().map(|asked| asked.answer.named == [UNKNOWN])).into(),
        Measure::PlaceRight => Share::over(planted().map(|asked| asked.answer.place_right == Some(true))).into(),
        Measure::ParameterError => middle(all().map(|asked| asked.answer.parameter_error)),
        Measure::ParameterErrorCr => middle(all().map(|asked| asked.answer.parameter_error_cr)),
        Measure::ParameterCovered => Share::over(all().filter_map(|asked| asked.answer.parameter_covered)).into(),
        Measure::ClosedRatio => {
            let judged = planted().filter_map(|asked| Some((asked, asked.reference.truth?)));
            let (found, oracle) = judged.fold((0.0, 0.0), |(found, oracle), (asked, truth)| {
                (found + asked.answer.gained, oracle + truth - asked.reference.none)
            });
            (oracle > 0.0).then_some(found / oracle).into()
        }
        Measure::ClosedLow => {
            let ratio =
                |asked: &Asked<'_>| Some(asked.answer.closed? / asked.answer.oracle_closed.filter(|it| *it > 0.0)?);
            let mut ratios: Vec<f64> = planted().filter_map(ratio).collect();
            ratios.sort_by(f64::total_cmp);
            ratios.get(ratios.len() / 10).copied().into()
        }
        Measure::CalibrationError => scores::calibration_error(&reliability(all().copied())).into(),
        Measure::CalibrationP => scores::calibration_p(cases).into(),
        Measure::LogScore => scores::of_answers(cases).into(),
        Measure::LogScoreEvidence => scores::of_evidence(cases).into(),
        Measure::LogScoreFrequencies => scores::of_frequencies(cases).into(),
        Measure::NextSplits => Share::over(followed(cases).map(|next| next.splits())).into(),
        Measure::AgainSplits => Share::over(followed(cases).map(|next| next.again_splits())).into(),
        Measure::NextBeatsAgain => Share::over(followed(cases).map(|next| next.advised_nats > next.again_nats)).into(),
    }
}

/// What is in the world, in the words of the confusion matrix.
#[must_use]
pub fn truth_word(record: &Record) -> String {
    match (record.planted.len(), &record.listed()[..]) {
        (0, _) => NONE.to_owned(),
        (1, [one]) => (*one).clone(),
        (_, []) => UNKNOWN.to_owned(),
        (_, [one]) => format!("{one}+{UNKNOWN}"),
        _ => "two".to_owned(),
    }
}

/// What was named, in the same words.
#[must_use]
pub fn named_word(answer: &Answer) -> String {
    match &answer.named[..] {
        [] => "no answer".to_owned(),
        [one] => one.clone(),
        _ => "two".to_owned(),
    }
}

/// Cases that the confusion matrix counts: rows are truths, columns what was named.
#[must_use]
pub fn confusion<'a>(cases: impl Iterator<Item = Asked<'a>>) -> std::collections::BTreeMap<(String, String), u32> {
    let mut counts = std::collections::BTreeMap::new();
    for asked in cases {
        *counts.entry((truth_word(asked.record), named_word(asked.answer))).or_insert(0) += 1;
    }
    counts
}

/// Bins of size in a power curve.
const SIZES: usize = 5;

/// A point of a power curve: the middle of the bin of sizes, and how often the effect was named there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// Geometric middle of the bin's sizes.
    pub size: f64,
    /// Top group right.
    pub right: Share,
}

/// How often an effect that was planted alone is the most probable cause, by its size.
pub fn power<'a>(cases: impl Iterator<Item = Asked<'a>>, effect: &str) -> Vec<Power> {
    let mut bins = [Share::default(); SIZES];
    let mut law = (1.0, 1.0);
    for asked in cases {
        let [planted] = &asked.reference.effects[..] else { continue };
        if planted.name != effect {
            continue;
        }
        law = planted.sizes;
        let place = ln(planted.size / law.0) / ln(law.1 / law.0);
        let bin = &mut bins[((place * SIZES as f64) as usize).min(SIZES - 1)];
        *bin = Share { count: bin.count + u32::from(asked.answer.top_group_right), of: bin.of + 1 };
    }
    let middle = |i: usize| law.0 * exp(ln(law.1 / law.0) * (i as f64 + 0.5) / SIZES as f64);
    let points = bins.iter().enumerate().filter(|(_, right)| right.of > 0);
    points.map(|(i, right)| Power { size: middle(i), right: *right }).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use rand::RngExt;

    use super::*;

    /// Of twelve answers, or fifty, at these probabilities, drawn ten thousand times over.
    #[test]
    fn what_is_off_by_chance_is_what_draws_of_right_probabilities_are_off() {
        let mut rng = Seed(3).stream("chance");
        for (n, about) in [(12, 0.75), (12, 0.5), (50, 0.95)] {
            let p: Vec<f64> = (0..n).map(|i| about + 0.04 * (f64::from(i) / f64::from(n) - 0.5)).collect();
            let sum: f64 = p.iter().sum();
            let off = |rng: &mut asami_dataset::Rng| {
                let right = p.iter().filter(|p| rng.random::<f64>() < **p).count();
                (right as f64 - sum).abs() / f64::from(n)
            };
            let drawn = (0..10_000).map(|_| off(&mut rng)).sum::<f64>() / 1e4;
            let variance = p.iter().map(|p| p * (1.0 - p)).sum();
            let bin = Bin { probability: sum / f64::from(n), right: Share { count: 0, of: n as u32 }, variance };
            let expected = calibration_by_chance(&[bin]).unwrap();
            assert!((drawn / expected - 1.0).abs() < 0.05, "{n} {about}: {drawn} {expected}");
        }
        assert_eq!(calibration_by_chance(&[]), None);
    }
}
