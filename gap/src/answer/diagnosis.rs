//! The answer, in the form of `diagnosis.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::plant::Planted;
use crate::weigh::causes::{NONE, UNKNOWN};

/// Version of the form.
pub const SCHEMA: u32 = 1;

/// Where, which and how far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The answer in one word.
    pub verdict: Verdict,
    /// Where the world and the log part, the largest share first; empty where they do not.
    #[serde(rename = "where")]
    pub places: Vec<Cell>,
    /// Causes, the most probable first, *unknown* and *none* among them.
    pub which: Vec<Cause>,
    /// The smallest set of causes that holds the true one in 90 % of the calibration's cases; each a list
    /// of effects, or of the one word `unknown` or `none`.
    pub set90: Vec<Vec<String>>,
    /// Effects that this log cannot split, by groups of two and more.
    pub cannot_tell_apart: Vec<Vec<String>>,
    /// Small parts of a real robot's gap, of which the log does not settle what they are; named is the rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unsettled: Vec<Unsettled>,
    /// Of a real robot worlds as they are believed, each as probable as any other: the values of what is named and of what else may be
    /// there, by `NAME.PARAM`. What is to work on the robot is to work in all of them (Peng et al. 2018, "Sim-to-Real Transfer of
    /// Robotic Control with Dynamics Randomization").
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub draws: Vec<BTreeMap<String, f64>>,
    /// What to record to split what is tied; `None` where nothing is.
    pub next_experiment: Option<String>,
    /// The keys of the scenario that drive the robot so, as `table.key = value`; `None` where the log's own commands are as
    /// good as any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_keys: Option<String>,
    /// By how many nats the two most probable causes part in this log, and are expected to part in a log so driven.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_nats: Option<[f64; 2]>,
    /// How long a log so driven should be, in seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_length_s: Option<f64>,
    /// For each effect's sized parameter, `NAME.PARAM`, the smallest distance from its null value that this
    /// log would have shown.
    pub smallest_visible: BTreeMap<String, f64>,
    /// For how long, in seconds, a real robot did not do what it was told, whatever is found: not scored; `None` of other logs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub astray_s: Option<f64>,
    /// By how many times as much as they are said to sizes differ between halves of a real robot's log, or of logs of its make, each by
    /// itself; the log's own nats count as much less as the square of that is more. 1: no more, or nobody looked; `None` of other logs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub halves_differ: Option<f64>,
    /// Of a real robot whose camera takes pictures by a clock of its own, by which what it saw was dated anew: from each to the next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture_period_s: Option<f64>,
    /// Of a real robot whose commands are taken up once in a cycle, by which they are given as they were: how long that is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command_cycle_s: Option<f64>,
    /// How noisy a real robot and its sensor are, of each part of the log out of the others; `None` of other logs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
    /// What the probabilities were calibrated on; `None`: they are the evidence as it is.
    pub calibrated_on: Option<CalibratedOn>,
    /// The gap before and after the most probable cause is added.
    pub how_far: HowFar,
}

impl Diagnosis {
    /// The cause that is said: the most probable that names effects.
    #[must_use]
    pub fn said(&self) -> Option<&Cause> {
        self.which.iter().find(|cause| cause.names_effects())
    }
}

impl Cause {
    /// Whether it is of effects, neither *unknown* nor *none*.
    #[must_use]
    pub fn names_effects(&self) -> bool {
        !self.effects.iter().any(|it| it == NONE || it == UNKNOWN)
    }
}

/// A small part of a gap, of which the log does not settle what it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unsettled {
    /// What it may be, the most probable first, until they have nine tenths of what all have.
    pub one_of: Vec<Suspect>,
    /// Share of the nats that all effects explain.
    pub share: f64,
}

/// An effect that may be there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// Its name.
    pub effect: String,
    /// How probable it is, where one is there.
    pub probability: f64,
}

/// Standard deviations over those of the nominal world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Of sizes or ranges, in the (geometric) mean over bands of distance.
    pub size_ratio: f64,
    /// Of bearings, the same.
    pub bearing_ratio: f64,
    /// Of motion while the robot moves, slow and fast together, in the (geometric) mean over ways forward and turns.
    pub motion_ratio: f64,
    /// Share of the sightings that are of something else.
    pub false_share: f64,
    /// Share of the variance of sizes that lasts for a while, each landmark's by itself.
    #[serde(default)]
    pub lasting_share: f64,
    /// It fades to 1/e in so many seconds.
    #[serde(default)]
    pub fades_s: f64,
}

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// One group of one effect, or of several at once.
    Named,
    /// Several causes that cannot be told apart.
    Tied,
    /// A cause that is in nobody's list.
    Unknown,
    /// No gap.
    None,
}

impl Verdict {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Named => "named",
            Verdict::Tied => "tied",
            Verdict::Unknown => "unknown",
            Verdict::None => "none",
        }
    }
}

/// What differs in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The mean.
    Bias,
    /// The scatter.
    Spread,
    /// The correlation in time.
    Memory,
}

/// A channel in a regime.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// One of the channels that every report uses: `forward`, `height_px`, ...
    pub channel: String,
    /// In words.
    pub regime: String,
    /// What differs.
    pub kind: Kind,
    /// Share of the gap.
    pub share: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
    /// Probability of so large a difference where there is none.
    pub p: f64,
}

/// A cause.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// Effects' names, or the one word `unknown` or `none`.
    pub effects: Vec<String>,
    /// Its probability.
    pub probability: f64,
    /// Logarithm of its evidence over that of *none*.
    #[serde(default)]
    pub evidence_nats: f64,
    /// Probability of so bad a fit where the cause is true; `None` where that was not tried.
    #[serde(default)]
    pub adequacy_p: Option<f64>,
    /// Where it acts: `actuation`, `dynamics`, `sensing` or `scene`.
    #[serde(default)]
    pub place: Option<String>,
    /// Of *unknown*: the flexible block that it shows in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<String>,
    /// Of *unknown*: an effect of the catalogue that would act alike.
    #[serde(default)]
    pub behaves_like: Option<String>,
    /// Values, by `NAME.PARAM`.
    #[serde(default)]
    pub parameters: BTreeMap<String, Estimate>,
}

/// A value with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value, in the parameter's unit.
    pub value: f64,
    /// Its 90 % interval.
    pub interval: [f64; 2],
    /// Whether the effect is at the largest size that is known: it may be larger.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_end: bool,
}

/// Sizes from this share of the largest on are as good as that.
const AT_END: f64 = 0.999;

impl Estimate {
    /// The values of a planted effect's parameters, by `NAME.PARAM`, with those at the ends of an interval of sizes.
    #[must_use]
    pub fn of(planted: &Planted, interval: [f64; 2]) -> Vec<(String, Self)> {
        let at = |size: f64| values(&Planted { size, ..planted.clone() });
        let ends = interval.map(at);
        let (least, greatest) = planted.variant.sizes();
        let at_end = least < greatest && planted.size >= AT_END * greatest;
        let values = at(planted.size).into_iter().enumerate().map(|(i, (name, value))| {
            let (a, b) = (ends[0][i].1, ends[1][i].1);
            (name, Self { value, interval: [a.min(b), a.max(b)], at_end })
        });
        values.collect()
    }
}

/// Values of the parameters of an effect, by `NAME.PARAM`.
#[must_use]
pub fn values(planted: &Planted) -> Vec<(String, f64)> {
    let name = planted.variant.about.name;
    let values = planted.variant.values(planted.size).into_iter();
    values.map(|(parameter, value)| (format!("{name}.{parameter}"), value)).collect()
}

/// What probabilities were calibrated on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratedOn {
    /// The scenario.
    pub scenario: String,
    /// Planted cases.
    pub cases: usize,
    /// How their effects and sizes were drawn, in words.
    pub size_law: String,
}

/// The gap before and after, on blocks that no fit has seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HowFar {
    /// What the numbers are, in words.
    pub comment: String,
    /// Nats per observation by which the log is less likely than under the best adequate model.
    pub excess_before: f64,
    /// The same with the cause added.
    pub excess_after: f64,
    /// Nats per observation more than the world itself expects.
    pub misfit_before: f64,
    /// The same with the cause added.
    pub misfit_after: f64,
    /// `1 - excess_after / excess_before`; `None` where the excess's interval holds 0.
    pub closed: Option<f64>,
    /// 95 % interval of `closed`, by a paired block bootstrap.
    pub interval: Option<[f64; 2]>,
    /// Root mean squares by channel.
    pub channels: BTreeMap<String, Rms>,
}

/// Root mean square of a channel's innovations, in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rms {
    /// In the nominal world.
    pub rms_before: f64,
    /// With the cause added.
    pub rms_after: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Variant;

    /// Of every effect the largest size is at the end, half of it is not; and what is not at the end is not written down.
    #[test]
    fn the_largest_size_that_is_known_is_at_the_end() {
        for variant in Variant::all("plain", 4, &[]).iter().chain(&Variant::all("car", 0, &[])) {
            let (least, greatest) = variant.sizes();
            let of = |size: f64| Estimate::of(&Planted { variant: variant.clone(), size }, [least, greatest]);
            let is_range = least < greatest;
            assert!(of(greatest).iter().all(|(_, it)| it.at_end == is_range), "{}", variant.name());
            assert!(of(0.5 * (least + greatest)).iter().all(|(_, it)| !it.at_end), "{}", variant.name());
        }
        let inside = Estimate { value: 1.0, interval: [0.5, 2.0], at_end: false };
        assert_eq!(serde_json::to_string(&inside).unwrap(), r#"{"value":1.0,"interval":[0.5,2.0]}"#);
    }
}
