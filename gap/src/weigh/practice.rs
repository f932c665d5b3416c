//! Planted cases to learn from: what a diagnosis would say of logs whose cause is known.

use asami_dataset::{Log, Rng, Seed};
use asami_sim::effect::About;
use asami_sim::effects::catalogue;
use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::judge::Judge;
use crate::library::{Responds, play};
use crate::nominal::{CannotPlay, Nominal};
use crate::plant::{Planted, Variant};
use crate::weigh::causes::{Evidence, NONE, UNKNOWN};
use crate::weigh::evidence::Weighed;
use crate::weigh::findings::{Findings, absorbed_nats};
use crate::weigh::groups::SPLIT_NATS;

/// Share of cases with nothing planted, as in a blind check.
pub const NONE_SHARE: f64 = 0.34;
/// Share of cases with one effect; the rest has two.
pub const ONE_SHARE: f64 = 0.5;

/// How [`draw`] draws, in words.
pub const LAW: &str = "none 34 %, one effect 50 %, two 16 %, each effect as likely; sizes log-uniform as `list effects` \
                       shows, from half a decade below what a log of 150 s shows";

/// A planted case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The true cause, as in [`Evidence`], or [`NONE`].
    pub truth: String,
    /// What of it the log shows, where that may be less: of two effects one, if the other cannot be seen beside it.
    #[serde(default)]
    pub shown: Option<String>,
    /// What speaks for each cause.
    pub evidence: Evidence,
    /// By how much the best flexible block on top of the truth is more probable than the truth; of cases with a
    /// cause in the list.
    pub absorbed_nats: Option<f64>,
    /// By how much the size of a single effect that shows lies off the one found, in shares of the 90 % interval on that
    /// side.
    #[serde(default)]
    pub off_by: Option<f64>,
}

/// None, one or two effects that fit a robot among so many landmarks, at sizes by their laws.
#[must_use]
pub fn draw(robot: &str, landmarks: usize, without: &[String], rng: &mut Rng) -> Vec<Planted> {
    let fits = |about: &&'static About| {
        about.fits.contains(&robot) && !about.law.is_empty() && !without.iter().any(|name| name == about.name)
    };
    let mut effects: Vec<&'static About> = catalogue().into_iter().filter(fits).collect();
    let share: f64 = rng.random();
    let number = usize::from(share >= NONE_SHARE) + usize::from(share >= NONE_SHARE + ONE_SHARE);
    let mut planted = Vec::with_capacity(number);
    for _ in 0..number.min(effects.len()) {
        let about = effects.swap_remove(rng.random_range(0..effects.len()));
        planted.extend(Planted::draw(about, landmarks, rng));
    }
    planted
}

/// The name of a cause: its effects' names in alphabetical order, joined by `+`.
#[must_use]
pub fn cause(planted: &[Planted]) -> String {
    let mut names: Vec<&str> = planted.iter().map(|it| it.variant.about.name).collect();
    names.sort_unstable();
    if names.is_empty() { NONE.to_owned() } else { names.join("+") }
}

/// Plants, plays and weighs one case: the case itself, and, of a case with one effect, the same had that effect been
/// in nobody's list. Empty where the log says nothing.
///
/// # Errors
/// If the world cannot be played.
pub fn practise(
    nominal: &dyn Nominal,
    library: &dyn Responds,
    variants: &[Variant],
    seed: Seed,
    until_s: f64,
) -> Result<Vec<Case>, CannotPlay> {
    let planted = draw(nominal.robot(), nominal.landmarks(), &[], &mut seed.stream("practice"));
    let run = play(nominal, &planted, seed, until_s)?;
    Ok(judged(&run.log, planted, library, variants))
}

/// The same of a log in which these effects are planted.
#[must_use]
pub fn judged(log: &Log, planted: Vec<Planted>, library: &dyn Responds, variants: &[Variant]) -> Vec<Case> {
    let Ok(judge) = library.judge(log) else { return Vec::new() };
    let findings = Findings::new(&*judge, variants);
    let whole = cause(&planted);
    let planted = shown(&*judge, planted);
    let shown = cause(&planted);
    let absorbed_nats = (findings.leader == shown && !planted.is_empty()).then(|| absorbed_nats(&findings.blocks));
    let evidence = findings.evidence();
    // Where nothing shows, nothing was tried beside it.
    let truth = if evidence.contains_key(&whole) { whole } else { shown.clone() };
    let mut cases = Vec::with_capacity(2);
    if let [only] = planted.as_slice() {
        let name = only.variant.about.name;
        let rest = findings.without(&*judge, &[name]).evidence();
        if !has_alias(evidence.get(name).copied().unwrap_or(0.0), &rest) {
            let truth = format!("{UNKNOWN}/{}", only.variant.block().name());
            cases.push(Case { truth, shown: None, evidence: rest, absorbed_nats: None, off_by: None });
        }
    }
    let off_by = if let [only] = planted.as_slice() { off_by(&findings, only) } else { None };
    cases.push(Case { truth, shown: Some(shown), evidence, absorbed_nats, off_by });
    cases
}

/// By how much a planted size lies off the one found, in shares of the interval on that side, where it shows.
fn off_by(findings: &Findings, planted: &Planted) -> Option<f64> {
    let same = |it: &&Weighed| it.best.variant == planted.variant && it.evidence_nats > SPLIT_NATS;
    let found = findings.weighed.iter().find(same)?;
    let off = planted.size - found.best.size;
    let [low, high] = found.interval;
    let room = if off > 0.0 { high - found.best.size } else { found.best.size - low };
    Some(off.abs() / room.max(1e-3 * found.best.size))
}

/// Of two effects the one alone, where the log does not show the other beside it: nobody can be asked to name it.
fn shown(judge: &dyn Judge, planted: Vec<Planted>) -> Vec<Planted> {
    let [a, b] = planted.as_slice() else { return planted };
    let both = judge.log_likelihood(&planted);
    let alone = [a, b].map(|it| judge.log_likelihood(std::slice::from_ref(it)));
    let better = if alone[0] > alone[1] { 0 } else { 1 };
    if both - alone[better] < SPLIT_NATS { vec![planted[better].clone()] } else { planted }
}

/// Whether an effect left in the list explains all that the one taken out does: then it is no mistake to name it.
fn has_alias(truth_nats: f64, rest: &Evidence) -> bool {
    let named = rest.iter().filter(|(cause, _)| !cause.starts_with(UNKNOWN));
    let best = named.map(|(_, nats)| *nats).fold(0.0, f64::max);
    truth_nats > 0.0 && best > truth_nats - SPLIT_NATS.max(0.1 * truth_nats)
}
