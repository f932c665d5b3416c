//! From evidence to probabilities that mean what they say: learned from planted cases.
//!
//! Of every planted case the evidence of each cause is known, and the truth. A cause's probability is
//! `P(g) ~ prior_g exp(beta_g + tau(g) log Z_g)`, with evidence counting for the less, the more of it there
//! is: a library's error grows with what it describes. The parameters are those of least penalised log-loss,
//! and the set that holds the truth in 90 % of cases is found by leaving folds out (Vovk 2015).

use std::collections::BTreeMap;

use asami_math::elementary::{exp, ln, ln_1p};
use serde::{Deserialize, Serialize};

/// The cause in nobody's list.
pub const UNKNOWN: &str = "unknown";
/// No cause.
pub const NONE: &str = "none";
/// The class of all causes of several effects.
const SEVERAL: &str = "+";

/// Evidence of causes over *none*, by cause: an effect, several joined by `+`, or `unknown/` and a flexible block.
pub type Evidence = BTreeMap<String, f64>;

/// A planted case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The true cause, as in [`Evidence`], or [`NONE`].
    pub truth: String,
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

/// How evidence becomes probability.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Weight of the evidence.
    tau: f64,
    /// How fast that weight falls with the greatest evidence, per nat.
    fade: f64,
    /// What is added for each cause.
    beta: BTreeMap<String, f64>,
    /// The least probability that a cause in the 90 % set has, by stratum of the greatest evidence.
    thresholds: [f64; 3],
    /// How far truths were exceeded by flexible blocks, increasing.
    absorbed_nats: Vec<f64>,
    /// By how much sizes' intervals are too narrow.
    stretch: f64,
    /// How many planted cases there were.
    pub cases: usize,
}

/// Prior probability of no cause; the causes in the list share what this and [`PRIOR_UNKNOWN`] leave.
const PRIOR_NONE: f64 = 0.3;
/// Prior probability of a cause in nobody's list.
const PRIOR_UNKNOWN: f64 = 0.1;
/// Share of cases whose cause is in nobody's list, in what is learned from: a wrong name is worse than none.
const SHARE_UNKNOWN: f64 = 0.2;
/// Probability that the evidence misleads altogether, as a library that is wrong somewhere does; without it a few such
/// cases would have all evidence distrusted.
const SLIP: f64 = 0.02;
/// Folds of the cross-validation.
const FOLDS: usize = 5;
/// Strata of the 90 % set: below, between and above these nats of greatest evidence.
const STRATA_NATS: [f64; 2] = [3.0, 10.0];

impl Default for Calibration {
    /// The evidence as it is.
    fn default() -> Self {
        let (beta, absorbed_nats) = (BTreeMap::new(), Vec::new());
        Self { tau: 1.0, fade: 0.0, beta, thresholds: [0.05; 3], absorbed_nats, stretch: 1.0, cases: 0 }
    }
}

impl Calibration {
    /// The calibration of these cases.
    #[must_use]
    pub fn learn(cases: &[Case]) -> Self {
        let mut calibration = fit(&cases.iter().collect::<Vec<_>>());
        let mut scores: [Vec<f64>; 3] = Default::default();
        for fold in 0..FOLDS {
            let of = |held: bool| cases.iter().enumerate().filter(move |(i, _)| (i % FOLDS == fold) == held);
            let rest = fit(&of(false).map(|(_, case)| case).collect::<Vec<_>>());
            for (_, case) in of(true) {
                let truth = if is_unknown(&case.truth) { UNKNOWN } else { &case.truth };
                let probability = rest.probabilities(&case.evidence).get(truth).copied().unwrap_or(0.0);
                scores[stratum(&case.evidence)].push(probability);
            }
        }
        for (threshold, scores) in calibration.thresholds.iter_mut().zip(&mut scores) {
            scores.sort_by(f64::total_cmp);
            // The conformal rank: one in ten of n + 1, rounded down.
            let rank = ((scores.len() + 1) / 10).max(1) - 1;
            *threshold = scores.get(rank).copied().unwrap_or(0.05);
        }
        calibration.absorbed_nats = cases.iter().filter_map(|case| case.absorbed_nats).collect();
        calibration.absorbed_nats.sort_by(f64::total_cmp);
        let mut off_by: Vec<f64> = cases.iter().filter_map(|case| case.off_by).collect();
        off_by.sort_by(f64::total_cmp);
        let nine_in_ten = (off_by.len() * 9).div_ceil(10).checked_sub(1).and_then(|i| off_by.get(i));
        // A handful of sizes says nothing of their scatter.
        calibration.stretch = nine_in_ten.filter(|_| off_by.len() >= 20).map_or(1.0, |it| it.max(1.0));
        calibration.cases = cases.len();
        calibration
    }

    /// A 90 % interval of a size about the one found, as wide as planted sizes show it to be.
    #[must_use]
    pub fn interval(&self, found: f64, [low, high]: [f64; 2]) -> [f64; 2] {
        [(found - self.stretch * (found - low).max(0.0)).max(0.0), found + self.stretch * (high - found).max(0.0)]
    }

    /// Probabilities of all causes, *none* and [`UNKNOWN`] among them.
    #[must_use]
    pub fn probabilities(&self, evidence: &Evidence) -> BTreeMap<String, f64> {
        let mut probabilities = BTreeMap::new();
        for (cause, p) in self.by_block(evidence) {
            let cause = if is_unknown(&cause) { UNKNOWN.to_owned() } else { cause };
            *probabilities.entry(cause).or_insert(0.0) += p;
        }
        probabilities
    }

    /// The flexible block in which a cause in nobody's list would lie.
    #[must_use]
    pub fn block(&self, evidence: &Evidence) -> Option<String> {
        let unknown = self.by_block(evidence).into_iter().filter(|(cause, _)| is_unknown(cause));
        let best = unknown.reduce(|a, b| if b.1 > a.1 { b } else { a });
        best.and_then(|(cause, _)| cause.split_once('/').map(|(_, block)| block.to_owned()))
    }

    /// Probabilities with each flexible block of the unknown by itself.
    fn by_block(&self, evidence: &Evidence) -> BTreeMap<String, f64> {
        let weight = self.tau / (1.0 + self.fade * greatest(evidence));
        let singles = evidence.keys().filter(|cause| is_single(cause)).count().max(1) as f64;
        let none = [(NONE.to_owned(), ln(PRIOR_NONE) + self.beta(NONE))];
        let leader = leader(evidence);
        let score = |(cause, nats): (&String, &f64)| {
            let (named, beyond) = parts(cause, *nats, leader);
            let told = weight * named + self.tau * beyond;
            (cause.clone(), ln(prior(cause, singles)) + self.beta(cause) + told)
        };
        let sharp = softmax(evidence.iter().map(score).chain(none).collect());
        let even = SLIP / sharp.len() as f64;
        sharp.into_iter().map(|(cause, p)| (cause, (1.0 - SLIP) * p + even)).collect()
    }

    /// The causes of the 90 % set, the most probable first; never empty.
    #[must_use]
    pub fn set90(&self, evidence: &Evidence, probabilities: &BTreeMap<String, f64>) -> Vec<String> {
        let threshold = self.thresholds[stratum(evidence)];
        let mut causes: Vec<(&String, f64)> = probabilities.iter().map(|(cause, p)| (cause, *p)).collect();
        causes.sort_by(|a, b| b.1.total_cmp(&a.1));
        let in_set = causes.iter().enumerate().filter(|(i, (_, p))| *i == 0 || *p >= threshold);
        in_set.map(|(_, (cause, _))| (*cause).clone()).collect()
    }

    /// Share of planted truths that were exceeded by a flexible block by at least so much; `None` without cases.
    #[must_use]
    pub fn adequacy_p(&self, absorbed_nats: f64) -> Option<f64> {
        let n = self.absorbed_nats.len();
        let below = self.absorbed_nats.partition_point(|it| *it < absorbed_nats);
        (n > 0).then(|| (n - below + 1) as f64 / (n + 1) as f64)
    }

    fn beta(&self, cause: &str) -> f64 {
        self.beta.get(class(cause)).copied().unwrap_or(0.0)
    }
}

fn is_unknown(cause: &str) -> bool {
    cause.starts_with(UNKNOWN)
}

/// What shares one addend: all causes of several effects do.
fn class(cause: &str) -> &str {
    if cause.contains('+') { SEVERAL } else { cause }
}

/// One effect, not several and not *unknown*.
fn is_single(cause: &str) -> bool {
    !is_unknown(cause) && cause != NONE && !cause.contains('+')
}

fn prior(cause: &str, singles: f64) -> f64 {
    if is_unknown(cause) {
        return PRIOR_UNKNOWN / crate::blocks::BLOCKS.len() as f64;
    }
    // Each further effect costs a factor of 0.1, shared by all that it could have been.
    let further = cause.matches('+').count() as i32;
    (1.0 - PRIOR_NONE - PRIOR_UNKNOWN) / singles * (0.1 / singles).powi(further)
}

/// The evidence of the leading effect alone; 0 of *none*.
fn leader(evidence: &Evidence) -> f64 {
    evidence.iter().filter(|(cause, _)| is_single(cause)).map(|(_, nats)| *nats).fold(0.0, f64::max)
}

/// What a single effect says, and what a second one or a block says beyond the leading one: that is small and stays so,
/// however much the leader explains.
fn parts(cause: &str, nats: f64, leader: f64) -> (f64, f64) {
    let nats = nats.clamp(-1e6, 1e9);
    if is_single(cause) || cause == NONE { (nats, 0.0) } else { (leader, nats - leader) }
}

fn greatest(evidence: &Evidence) -> f64 {
    evidence.values().copied().fold(0.0, f64::max)
}

fn stratum(evidence: &Evidence) -> usize {
    STRATA_NATS.iter().filter(|nats| greatest(evidence) > **nats).count()
}

fn softmax(scores: Vec<(String, f64)>) -> BTreeMap<String, f64> {
    let top = scores.iter().map(|(_, score)| *score).fold(f64::NEG_INFINITY, f64::max);
    let sum = scores.iter().fold(0.0, |sum, (_, score)| sum + exp(score - top));
    scores.into_iter().map(|(cause, score)| (cause, exp(score - top) / sum)).collect()
}

/// Steps of the descent.
const STEPS: usize = 400;
/// Prior mean of the logarithm of the fade per 100 nats.
const FADE_LN: f64 = -1.0;
/// Prior standard deviation of what is added for a cause.
const BETA_SD: f64 = 1.5;

/// Gradient descent on the penalised log-loss, by Adam (Kingma and Ba 2015).
fn fit(cases: &[&Case]) -> Calibration {
    let causes: Vec<String> = {
        let classes = cases.iter().flat_map(|case| case.evidence.keys()).map(|cause| class(cause));
        let all: std::collections::BTreeSet<&str> = classes.chain([NONE]).collect();
        all.into_iter().map(str::to_owned).collect()
    };
    // ln tau, ln of the fade's scale, then the causes'.
    let mut at = vec![0.0; 2 + causes.len()];
    at[1] = FADE_LN;
    let (mut mean, mut square) = (vec![0.0; at.len()], vec![0.0; at.len()]);
    let read = |at: &[f64]| Calibration {
        tau: exp(at[0]),
        fade: exp(at[1]) / 100.0,
        beta: causes.iter().cloned().zip(at[2..].iter().copied()).collect(),
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
        let counts = if is_unknown(&case.truth) { weigh_unknown } else { 1.0 };
        let probabilities = calibration.by_block(&case.evidence);
        let top = greatest(&case.evidence);
        let fading = 1.0 + calibration.fade * top;
        let even = SLIP / probabilities.len() as f64;
        let of_truth = probabilities.get(&case.truth).copied().unwrap_or(0.0);
        // The share of the truth's probability that evidence gave it.
        let told = if of_truth > 0.0 { (of_truth - even) / of_truth } else { 0.0 };
        for (cause, p) in &probabilities {
            let sharp = (p - even) / (1.0 - SLIP);
            let off = counts * told * (sharp - f64::from(u8::from(*cause == case.truth)));
            let nats = case.evidence.get(cause).copied().unwrap_or(0.0);
            let (named, beyond) = parts(cause, nats, leader(&case.evidence));
            slope[0] += off * calibration.tau * (named / fading + beyond);
            slope[1] -= off * named * calibration.tau * calibration.fade * top / (fading * fading);
            if let Ok(i) = causes.binary_search_by(|it| it.as_str().cmp(class(cause))) {
                slope[2 + i] += off;
            }
        }
    }
    slope[0] += at[0] / 0.25;
    slope[1] += (at[1] - FADE_LN) / 4.0;
    for ((slope, at), cause) in slope[2..].iter_mut().zip(&at[2..]).zip(causes) {
        // Blocks pay for a freedom that hardly any cause needs in full.
        let sd = if is_unknown(cause) { 10.0 * BETA_SD } else { BETA_SD };
        *slope += at / (sd * sd);
    }
    slope
}

/// Mean of `-log2` probabilities given to the truth would be bits; this is in nats, for reports.
#[must_use]
pub fn log_loss(calibration: &Calibration, cases: &[Case]) -> f64 {
    let loss = |case: &Case| {
        let p = calibration.by_block(&case.evidence).get(&case.truth).copied().unwrap_or(0.0);
        -ln_1p(p.max(1e-12) - 1.0)
    };
    cases.iter().map(loss).fold(0.0, |sum, it| sum + it) / cases.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_dataset::Seed;
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    /// Two effects whose evidence is honest, or counts three times too much.
    fn cases(n: usize, exaggerated: f64, seed: u64) -> Vec<Case> {
        let mut rng = Seed(seed).stream("calibration/test");
        (0..n)
            .map(|_| {
                let u: f64 = rng.random();
                let truth = if u < 0.3 {
                    NONE
                } else if u < 0.65 {
                    "a"
                } else {
                    "b"
                };
                let nats = |cause: &str, rng: &mut asami_dataset::Rng| {
                    let normal: f64 = StandardNormal.sample(rng);
                    // Log-likelihood ratios of a shift of 2 standard deviations.
                    exaggerated * (2.0 * (normal + if cause == truth { 2.0 } else { 0.0 }) - 2.0)
                };
                let evidence = ["a", "b"].map(|cause| (cause.to_owned(), nats(cause, &mut rng)));
                Case { truth: truth.to_owned(), evidence: evidence.into(), absorbed_nats: None, off_by: None }
            })
            .collect()
    }

    #[test]
    fn intervals_are_stretched_until_nine_in_ten_planted_sizes_lie_in_them() {
        let mut of = cases(200, 1.0, 3);
        for (i, case) in of.iter_mut().enumerate() {
            case.off_by = Some(i as f64 / 50.0);
        }
        let [low, high] = Calibration::learn(&of).interval(10.0, [9.0, 12.0]);
        assert!((low - (10.0 - 3.58)).abs() < 1e-9 && (high - (10.0 + 2.0 * 3.58)).abs() < 1e-9, "{low} {high}");
        assert_eq!(Calibration::learn(&of[..10]).interval(10.0, [9.0, 12.0]), [9.0, 12.0]);
    }

    #[test]
    fn exaggerated_evidence_is_brought_down_and_probabilities_then_mean_what_they_say() {
        let calibration = Calibration::learn(&cases(1500, 3.0, 1));
        let held = cases(4000, 3.0, 2);
        let raw = Calibration::default();
        assert!(log_loss(&calibration, &held) < log_loss(&raw, &held) - 0.1);
        // Of answers given about 80 %, about 80 % are right: 4 standard errors.
        let (mut right, mut sum, mut n) = (0.0, 0.0, 0.0);
        for case in &held {
            for (cause, p) in calibration.probabilities(&case.evidence) {
                if (0.7..0.9).contains(&p) {
                    right += f64::from(u8::from(cause == case.truth));
                    sum += p;
                    n += 1.0;
                }
            }
        }
        assert!(n > 300.0 && (right - sum).abs() < 4.0 * (n * 0.16_f64).sqrt() + 0.02 * n, "{right} {sum} {n}");
    }

    #[test]
    fn the_set_holds_nine_truths_in_ten() {
        let calibration = Calibration::learn(&cases(1500, 3.0, 3));
        let held = cases(4000, 3.0, 4);
        let holds = |case: &&Case| {
            let probabilities = calibration.probabilities(&case.evidence);
            calibration.set90(&case.evidence, &probabilities).contains(&case.truth)
        };
        let share = held.iter().filter(holds).count() as f64 / held.len() as f64;
        assert!((0.87..0.95).contains(&share), "{share}");
    }

    #[test]
    fn probabilities_add_up_and_more_evidence_never_makes_a_cause_less_probable() {
        let calibration = Calibration::learn(&cases(300, 1.0, 5));
        let p = |nats: f64| {
            let evidence = Evidence::from([("a".to_owned(), nats), ("b".to_owned(), 1.0)]);
            let all = calibration.probabilities(&evidence);
            assert!((all.values().sum::<f64>() - 1.0).abs() < 1e-12);
            all["a"]
        };
        assert!(p(-5.0) < p(0.0) && p(0.0) < p(3.0) && p(3.0) < p(8.0));
    }
}
