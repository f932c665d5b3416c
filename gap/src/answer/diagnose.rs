//! From a log to its diagnosis.

use std::collections::BTreeMap;

use asami_dataset::Log;

use crate::answer::calibration::Calibration;
use crate::answer::diagnosis::{Cause, Diagnosis, Estimate, HowFar, SCHEMA, Verdict};
use crate::answer::experiment::{Advice, Courses, advice};
use crate::answer::how_far::how_far;
use crate::answer::place::places;
use crate::judge::Judge;
use crate::library::Responds;
use crate::plant::{Planted, Variant};
use crate::view::CannotSee;
use crate::weigh::causes::{NONE, UNKNOWN};
use crate::weigh::evidence::Weighed;
use crate::weigh::findings::{Findings, absorbed_nats};
use crate::weigh::groups::{groups, smallest_visible};

/// *None* is the verdict unless it is less probable than this.
const NOT_NONE: f64 = 0.1;
/// A named model is not adequate where fewer planted truths than this were exceeded as far by a flexible block.
const INADEQUATE: f64 = 0.01;
/// Causes less probable than this are left out: those given sum to 1 but for less than a hundredth.
const NEGLIGIBLE: f64 = 1e-4;

/// Causes less probable than this are not worth an experiment.
const WORTH_SPLITTING: f64 = 0.05;

/// All that a diagnosis of logs of one nominal world needs.
#[derive(Clone, Copy)]
pub struct Diagnoser<'a> {
    /// The response library.
    pub library: &'a dyn Responds,
    /// How evidence becomes probability; without one, as it is.
    pub calibration: &'a Calibration,
    /// Kinds of effects that are thought of.
    pub variants: &'a [Variant],
    /// How the robot may be driven next.
    pub courses: &'a dyn Courses,
}

impl Diagnoser<'_> {
    /// Where, which and how far.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotSee> {
        let judge = self.library.judge(log)?;
        let judge = &*judge;
        let findings = Findings::new(judge, self.variants);
        let evidence = findings.evidence();
        let probabilities = self.calibration.probabilities(&evidence);
        let set90 = self.calibration.set90(&evidence, &probabilities);
        let near = findings.weighed.first().map_or(0.0, |it| it.evidence_nats) - 30.0;
        let leaders: Vec<&Weighed> = findings.weighed.iter().filter(|it| it.evidence_nats > near.max(0.0)).collect();
        let cannot_tell_apart = groups(judge, &leaders);

        let mut ranked: Vec<(&String, f64)> = probabilities.iter().map(|(cause, p)| (cause, *p)).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let named = |cause: &&(&String, f64)| *cause.0 != UNKNOWN && *cause.0 != NONE;
        let best = ranked.iter().find(named).map(|(cause, _)| (*cause).clone());
        let planted: Vec<Planted> =
            best.iter().flat_map(|best| findings.planted(best)).map(|(planted, _)| planted).collect();
        let adequacy_p = self.adequacy(&findings, &probabilities, best.as_deref());
        let verdict = verdict(&probabilities, &set90, &cannot_tell_apart, adequacy_p);
        let block = self.calibration.block(&evidence);
        let fitted = block.as_deref().and_then(|block| findings.block(block));
        let better = match verdict {
            Verdict::None => None,
            Verdict::Unknown => fitted.map(|block| block.numbers.clone()),
            Verdict::Named | Verdict::Tied => Some(judge.numbers(&planted)),
        };
        let base = &judge.numbers(&[]);
        let advice = (verdict == Verdict::Tied).then(|| self.next_experiment(judge, &findings, &ranked)).flatten();
        let next = advice.as_ref().and_then(|advice| advice.next.as_ref().map(|next| (advice.parted_nats, next)));
        let added: &[Planted] = if matches!(verdict, Verdict::Named | Verdict::Tied) { &planted } else { &[] };
        Ok(Diagnosis {
            schema: SCHEMA,
            verdict,
            places: better.map_or_else(Vec::new, |better| places(judge, base, &better)),
            which: self.causes(&findings, &ranked, best.as_deref(), block.as_deref(), adequacy_p),
            next_nats: next.map(|(parted_nats, next)| [parted_nats, next.promised_nats]),
            next_length_s: next.map(|(_, next)| next.length_s),
            next_keys: next.map(|(_, next)| next.keys.clone()),
            next_experiment: advice.map(|advice| advice.words),
            set90: set90.iter().map(|cause| split(cause)).collect(),
            cannot_tell_apart,
            unsettled: Vec::new(),
            draws: Vec::new(),
            smallest_visible: smallest_visible(judge, self.variants),
            astray_s: None,
            halves_differ: None,
            picture_period_s: None,
            command_cycle_s: None,
            noise: None,
            calibrated_on: None,
            how_far: if verdict == Verdict::None { HowFar::default() } else { how_far(judge, added) },
        })
    }

    /// What to record to split single effects that are about as probable.
    fn next_experiment(&self, judge: &dyn Judge, findings: &Findings, ranked: &[(&String, f64)]) -> Option<Advice> {
        let single = |(cause, p): &(&String, f64)| {
            findings.weighed.iter().find(|it| it.effect == cause.as_str()).map(|weighed| (weighed, *p))
        };
        let tied: Vec<(&Weighed, f64)> = ranked.iter().filter(|it| it.1 > WORTH_SPLITTING).filter_map(single).collect();
        if tied.len() < 2 { None } else { advice(judge, self.library, self.courses, &tied) }
    }

    /// How often a planted truth is exceeded by a flexible block as far as the best named model is here.
    fn adequacy(&self, findings: &Findings, probabilities: &BTreeMap<String, f64>, best: Option<&str>) -> Option<f64> {
        let none = probabilities.get(NONE).copied().unwrap_or(0.0);
        if none >= NOT_NONE || best != Some(findings.leader.as_str()) {
            return None;
        }
        self.calibration.adequacy_p(absorbed_nats(&findings.blocks))
    }

    fn causes(
        &self,
        findings: &Findings,
        ranked: &[(&String, f64)],
        best: Option<&str>,
        block: Option<&str>,
        adequacy_p: Option<f64>,
    ) -> Vec<Cause> {
        let evidence = findings.evidence();
        let of_block = block.and_then(|block| findings.block(block)).map_or(0.0, |block| block.evidence_nats);
        let worth = |cause: &str, p: f64| p > NEGLIGIBLE || cause == NONE || cause == UNKNOWN;
        let cause = |cause: &str, probability: f64| {
            let planted = findings.planted(cause);
            let is_unknown = cause == UNKNOWN;
            Cause {
                effects: split(cause),
                probability,
                evidence_nats: if is_unknown { of_block } else { evidence.get(cause).copied().unwrap_or(0.0) },
                adequacy_p: adequacy_p.filter(|_| best == Some(cause)),
                place: planted.first().map(|(planted, _)| planted.variant.place().name().to_owned()),
                block: block.filter(|_| is_unknown).map(str::to_owned),
                behaves_like: best.filter(|_| is_unknown).map(str::to_owned),
                parameters: planted
                    .iter()
                    .flat_map(|(planted, interval)| {
                        Estimate::of(planted, self.calibration.interval(planted.size, *interval))
                    })
                    .collect(),
            }
        };
        ranked.iter().filter(|(name, p)| worth(name, *p)).map(|(name, p)| cause(name, *p)).collect()
    }
}

fn split(cause: &str) -> Vec<String> {
    cause.split('+').map(str::to_owned).collect()
}

fn verdict(
    probabilities: &BTreeMap<String, f64>,
    set90: &[String],
    groups: &[Vec<String>],
    adequacy_p: Option<f64>,
) -> Verdict {
    let of = |cause: &str| probabilities.get(cause).copied().unwrap_or(0.0);
    if of(NONE) >= NOT_NONE {
        return Verdict::None;
    }
    let leads = probabilities.values().all(|p| *p <= of(UNKNOWN));
    if leads || adequacy_p.is_some_and(|p| p < INADEQUATE) {
        return Verdict::Unknown;
    }
    let one_group = groups.iter().any(|group| set90.iter().all(|cause| group.contains(cause)));
    if set90.len() <= 1 || one_group { Verdict::Named } else { Verdict::Tied }
}
