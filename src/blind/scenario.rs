//! A blind scenario: `study = "blind"` in a TOML file.

use std::path::Path;

use asami_dataset::parameters::{Fault, Parameter, Parameters, out_of_range};
use serde::{Deserialize, Serialize};

use super::Mix;
use super::draw::chance;
use super::referee::Effect;
use crate::scenario::{Bad, Origin, Scenario, Simulation, parse as parse_nominal, wire};

/// Names of the diagnosers.
pub const DIAGNOSERS: [&str; 3] = ["asami", "all_at_once", "forward_selection"];

/// Names of the places where effects act.
const PLACES: [&str; 4] = ["actuation", "dynamics", "sensing", "scene"];

/// A checked blind scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blind {
    /// The file's name without its extension.
    pub name: String,
    /// The question that it asks.
    pub about: String,
    /// The nominal world's scenario.
    pub nominal: String,
    /// The nominal world, with the length of these logs.
    pub world: Simulation,
    /// Everything else.
    pub asked: Asked,
}

/// What is asked, as it stands in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Version of the format.
    pub schema: i64,
    /// `blind`.
    pub study: String,
    /// The question.
    pub about: String,
    /// The nominal world's scenario file, beside this one.
    pub nominal: String,
    /// Keys of that file that are other ones here, tables within tables: how its robot is driven, say.
    #[serde(default, skip_serializing_if = "toml::Table::is_empty")]
    pub change: toml::Table,
    /// Length of each log.
    pub duration_s: f64,
    /// How many cases.
    pub cases: usize,
    /// What every draw follows from; none where cases are others'.
    #[serde(default)]
    pub salt: String,
    /// The folder of cases that another program wrote, in the layout of `generate --withhold`.
    pub cases_from: Option<String>,
    /// How many effects are planted.
    #[serde(default)]
    pub mix: Mix,
    /// Only effects that act at one of these places are planted (`actuation`, `dynamics`, `sensing`, `scene`); none named:
    /// at any. What is thought of is the whole catalogue all the same.
    #[serde(default)]
    pub places: Vec<String>,
    /// Whether the group of each case's true effect is taken out of the catalogue.
    #[serde(default)]
    pub without_truth: bool,
    /// The same of only so many of the cases: a share, drawn case by case.
    #[serde(default)]
    pub without_truth_share: f64,
    /// Whether of two planted effects one, by chance, is taken out of the catalogue with its group: the other may be named, and
    /// *unknown* may, but nothing else.
    #[serde(default)]
    pub without_one_of_two: bool,
    /// Whether, where causes are tied, the log that is asked for next is recorded in the true world, and beside it another
    /// with the old commands.
    #[serde(default)]
    pub next_experiment: bool,
    /// Effects that act alike whatever their sizes, by groups: part of the question, so that they are frozen before
    /// any key is opened.
    #[serde(default)]
    pub groups: Vec<Vec<String>>,
    /// How many planted cases the probabilities are calibrated on, drawn by a salt of their own; none: the evidence is
    /// taken as it is.
    #[serde(default)]
    pub calibration_cases: usize,
    /// Who diagnoses.
    pub diagnosers: Vec<String>,
    /// What rivals may spend.
    #[serde(default)]
    pub rivals: Rivals,
    /// The expected answers.
    #[serde(default)]
    pub expect: Vec<Expect>,
}

asami_dataset::parameters! {
    /// What the rivals may spend on a log.
    pub struct Rivals {
        /// Likelihoods that `all_at_once` may ask for.
        evaluations: u32 = 2000, "1", 10.0..=1000000.0;
        /// Effects that `forward_selection` may add.
        most_effects: u32 = 2, "1", 1.0..=10.0;
    }
}

/// What is measured over cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Share of the planted cases whose most probable cause is of the truth's group.
    TopGroupRight,
    /// Share of the planted cases of which what is named is the truth, effect by effect.
    NamedRight,
    /// Share of the planted cases of which no effect is named that is not there.
    NothingElseNamed,
    /// Share of the cases whose 90 % set holds the truth.
    InSet90,
    /// Mean number of causes in the 90 % set.
    SetSize,
    /// Share of the cases without an effect that are called anything but *none*.
    NoneCalledElse,
    /// Share of the answers with a probability of 0.9 and more that are wrong.
    ConfidentWrong,
    /// Share of all the cases that are given a wrong name with a probability of 0.9 and more: neither *none* nor *unknown* is a name.
    ConfidentlyMisnamed,
    /// Share of the cases called *unknown*.
    Unknown,
    /// Share of the planted cases whose place is right.
    PlaceRight,
    /// Median error of the size over the limit of what the log shows.
    ParameterError,
    /// The same over the error that the bound of Cramer and Rao leaves.
    ParameterErrorCr,
    /// Share of the 90 % intervals that hold the true size.
    ParameterCovered,
    /// Nats gained by what was named over nats gained by the truth, both summed.
    ClosedRatio,
    /// The same of single cases: their 10th percentile.
    ClosedLow,
    /// Mean distance between probability and share right, over ten bins of probability.
    CalibrationError,
    /// How often answers of these probabilities that come true as often as they are said to are off by as much.
    CalibrationP,
    /// Mean logarithm of the truth's probability.
    LogScore,
    /// The same by the evidence as it is, every cause as probable as any other beforehand.
    LogScoreEvidence,
    /// The same by how often each truth is planted in these cases.
    LogScoreFrequencies,
    /// Share of the ties, of which other commands are said to split them, that a log so driven splits: it speaks for the truth
    /// by three nats and more.
    NextSplits,
    /// Share of them of which a log with the old commands, as long, does so.
    AgainSplits,
    /// Share of them of which the one speaks louder for the truth than the other.
    NextBeatsAgain,
}

/// An expected answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expect {
    /// Whose.
    pub diagnoser: String,
    /// Of what.
    pub measure: Measure,
    /// Only over cases whose truth is separated by at least so many nats.
    pub d_sep_min: Option<f64>,
    /// Only over cases whose truth is separated by less.
    pub d_sep_max: Option<f64>,
    /// Only over cases each of whose effects shows, beside the others, by at least so many nats.
    pub each_min: Option<f64>,
    /// Only over cases with so many effects.
    pub effects: Option<usize>,
    /// It is at least this.
    pub min: Option<f64>,
    /// It is at most this.
    pub max: Option<f64>,
}

const CASES: Parameter = number("cases", "1", (1.0, 100_000.0));
const DURATION: Parameter = number("duration_s", "s", (1.0, 3600.0));

const fn number(name: &'static str, unit: &'static str, range: (f64, f64)) -> Parameter {
    Parameter { name, unit, default: 0.0, range, whole: false, about: "" }
}

/// Reads and checks a blind scenario; `None` where the file asks another kind of question, or is no TOML at all,
/// which [`crate::scenario::read`] says better.
///
/// # Errors
/// [`Bad`] shows where in the file what rule is broken by which value.
pub fn read(path: &Path) -> Result<Option<Blind>, Bad> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(None) };
    let shown = path.display().to_string();
    let name = path.file_stem().map_or_else(|| shown.clone(), |stem| stem.to_string_lossy().into_owned());
    let folder = path.parent().unwrap_or(Path::new("."));
    parse(&name, &shown, &text, &|nominal| {
        let path = folder.join(format!("{nominal}.toml"));
        std::fs::read_to_string(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))
    })
}

/// Checks the text of a blind scenario; `shown` is the file's name in errors, `nominal` gives the text of the nominal
/// world's scenario by its name.
///
/// # Errors
/// [`Bad`] shows where in the text what rule is broken by which value.
pub fn parse(
    name: &str,
    shown: &str,
    text: &str,
    nominal: &dyn Fn(&str) -> Result<String, String>,
) -> Result<Option<Blind>, Bad> {
    let Ok(table) = toml::de::DeTable::parse(text) else { return Ok(None) };
    if wire::study(table.get_ref()) != Some("blind") {
        return Ok(None);
    }
    wire::check_schema(table.get_ref()).map_err(|fault| Bad::faults(shown, text, &table, &[fault]))?;
    let asked: Asked = toml::from_str(text).map_err(|error| Bad::syntax(shown, text, &error))?;
    let mut faults = asked.faults();
    let world = world(&asked, nominal);
    match world {
        Ok(world) if faults.is_empty() => {
            let (about, nominal) = (asked.about.clone(), asked.nominal.clone());
            Ok(Some(Blind { name: name.to_owned(), about, nominal, world, asked }))
        }
        found => {
            let path = if asked.change.is_empty() { "nominal" } else { "change" }.to_owned();
            faults.extend(found.err().map(|message| Fault { path, message }));
            Err(Bad::faults(shown, text, &table, &faults))
        }
    }
}

fn world(asked: &Asked, nominal: &dyn Fn(&str) -> Result<String, String>) -> Result<Simulation, String> {
    let name = &asked.nominal;
    let (mut text, mut shown) = (nominal(name)?, name.clone());
    // A text that is no TOML is better explained where it is read.
    if let Ok(mut table) = text.parse::<toml::Table>()
        && !asked.change.is_empty()
    {
        change(&mut table, &asked.change);
        (text, shown) = (table.to_string(), format!("{name}, changed"));
    }
    let scenario: Scenario = parse_nominal(name, &shown, &text).map_err(|bad| format!("{shown}: {bad}"))?;
    match scenario.origin {
        Origin::Simulated(world) => Ok(Simulation { duration_s: asked.duration_s, ..*world }),
        Origin::Recorded(_) => Err(format!("{} is about a recorded log, into which nothing is planted", asked.nominal)),
    }
}

/// Puts other values in the place of some, in tables within tables.
fn change(table: &mut toml::Table, by: &toml::Table) {
    for (key, value) in by {
        match (table.get_mut(key), value) {
            (Some(toml::Value::Table(there)), toml::Value::Table(by)) => change(there, by),
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
}

impl Expect {
    /// What is wrong with those that are asked of these diagnosers.
    #[must_use]
    pub fn faults(expected: &[Self], diagnosers: &[String]) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (i, expect) in expected.iter().enumerate() {
            if !diagnosers.contains(&expect.diagnoser) {
                let message = format!("{} is none of the diagnosers", expect.diagnoser);
                faults.push(Fault { path: format!("expect.{i}.diagnoser"), message });
            }
            if expect.min.is_none() && expect.max.is_none() {
                let message = "an expected answer must have min, max or both".to_owned();
                faults.push(Fault { path: format!("expect.{i}"), message });
            }
        }
        faults
    }
}

impl Asked {
    /// What is taken out of the catalogue for a case with these effects.
    #[must_use]
    pub fn withheld(&self, number: usize, effects: &[Effect]) -> Vec<String> {
        if self.without_truth || chance("asami 2026 withheld truth", &self.salt, number) < self.without_truth_share {
            return effects.iter().flat_map(|effect| effect.group.clone()).collect();
        }
        match effects {
            [one, two] if self.without_one_of_two => {
                let heads = chance("asami 2026 withheld one of two", &self.salt, number) < 0.5;
                let (out, stays) = if heads { (one, two) } else { (two, one) };
                out.group.iter().filter(|name| **name != stays.name).cloned().collect()
            }
            _ => Vec::new(),
        }
    }

    fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut fault = |path: String, message: String| faults.push(Fault { path, message });
        if self.about.trim().is_empty() {
            fault("about".into(), "about must state the question that the scenario asks, not nothing".into());
        }
        match &self.cases_from {
            None if self.salt.is_empty() => {
                fault("salt".into(), "salt must be some text, or cases_from a folder".into())
            }
            Some(_) if !self.salt.is_empty() => {
                fault(
                    "cases_from".into(),
                    "cases_from (another program's cases) and salt (our own) exclude each other".into(),
                );
            }
            Some(_) => {
                let needs = [
                    ("without_truth", self.without_truth),
                    ("without_truth_share", self.without_truth_share > 0.0),
                    ("without_one_of_two", self.without_one_of_two),
                    ("next_experiment", self.next_experiment),
                ];
                for (key, _) in needs.into_iter().filter(|(_, is_set)| *is_set) {
                    let message = format!(
                        "{key} needs keys before a diagnosis; those of cases_from are opened after all of them"
                    );
                    fault(key.into(), message);
                }
            }
            None => {}
        }
        if !(0.0..=1.0).contains(&self.without_truth_share) {
            let message = format!("without_truth_share must lie in 0..=1, not {}", self.without_truth_share);
            fault("without_truth_share".into(), message);
        }
        if self.mix.none_share + self.mix.one_share > 1.0 + 1e-9 {
            fault("mix".into(), "none_share and one_share must not exceed 1 together".into());
        }
        let names: Vec<&str> = asami_sim::effects::catalogue().into_iter().map(|about| about.name).collect();
        for (i, group) in self.groups.iter().enumerate() {
            for effect in group.iter().filter(|effect| !names.contains(&effect.as_str())) {
                fault(format!("groups.{i}"), format!("there is no effect {effect}"));
            }
        }
        for (i, place) in self.places.iter().enumerate().filter(|(_, place)| !PLACES.contains(&place.as_str())) {
            fault(format!("places.{i}"), format!("unknown place `{place}`, expected one of {}", PLACES.join(", ")));
        }
        if self.diagnosers.is_empty() {
            fault("diagnosers".into(), "diagnosers must hold at least one".into());
        }
        for (i, diagnoser) in self.diagnosers.iter().enumerate() {
            if !DIAGNOSERS.contains(&diagnoser.as_str()) {
                let known: Vec<_> = DIAGNOSERS.iter().map(|name| format!("`{name}`")).collect();
                let message = format!("unknown diagnoser `{diagnoser}`, expected one of {}", known.join(", "));
                fault(format!("diagnosers.{i}"), message);
            }
        }
        faults.extend(Expect::faults(&self.expect, &self.diagnosers));
        faults.extend(out_of_range("", &CASES, self.cases as f64));
        faults.extend(out_of_range("", &DURATION, self.duration_s));
        self.mix.check("mix", &mut faults);
        self.rivals.check("rivals", &mut faults);
        faults
    }

    /// The group of an effect, itself among it.
    #[must_use]
    pub fn group<'a>(&'a self, effect: &'a str) -> Vec<&'a str> {
        let group = self.groups.iter().find(|group| group.iter().any(|it| it == effect));
        group.map_or_else(|| vec![effect], |group| group.iter().map(String::as_str).collect())
    }
}

impl Blind {
    /// `blake3:` and the hash of everything that bears on a case's diagnosis: not the prose, the number of cases or the
    /// expected answers.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut bearing = self.clone();
        bearing.about.clear();
        bearing.asked.about.clear();
        bearing.asked.expect.clear();
        bearing.asked.cases = 0;
        bearing.world.seeds = 0;
        // Serialising to memory fails only for maps with keys that are no strings: there are none.
        let bytes = serde_json::to_vec(&bearing).unwrap_or_default();
        format!("blake3:{}", blake3::hash(&bytes).to_hex())
    }
}
