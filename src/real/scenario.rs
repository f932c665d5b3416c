//! A scenario of real logs: `study = "real"` in a TOML file.

use std::path::Path;

use asami_dataset::parameters::Fault;
use asami_gap::real::Search;
use serde::{Deserialize, Serialize};

use super::odometry::Readied;
use crate::import;
use crate::scenario::{Bad, Start, wire};

/// A checked scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Real {
    /// The file's name without its extension.
    pub name: String,
    /// What is asked.
    pub asked: Asked,
}

/// What is asked, as it stands in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Version of the format.
    pub schema: i64,
    /// `real`.
    pub study: String,
    /// The question.
    pub about: String,
    /// What is learned in the nominal and in the repaired world.
    pub learning: Option<Learning>,
    /// The logs.
    pub logs: Vec<Source>,
}

/// What is learned from real logs and from simulated ones in their place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learning {
    /// Rows of the scenarios that logs are learned in.
    pub learners: Vec<String>,
    /// What they start from.
    pub starting_model: Start,
    /// So many simulated logs of each world in the place of each real one.
    pub seeds: u32,
}

/// Where logs come from, and what they are held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Their name in tables.
    pub name: String,
    /// Path of the recording, from the project's root.
    pub source: String,
    /// Its format: the name of an importer.
    pub format: String,
    /// The robots whose logs are taken, of a recording of several.
    pub robots: Option<Vec<u16>>,
    /// The scenario of the nominal world: a shipped one's name.
    pub nominal: String,
    /// Odometry that is noisy at each reading stands in for commands, and is averaged over so long: see [`super::odometry`].
    pub average_s: Option<f64>,
    /// Odometry stands in for commands, and each reading is of the time before it: so much earlier it was commanded.
    pub earlier_s: Option<f64>,
    /// How many pictures a second the camera takes, by a clock of its own: see [`super::clock`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera_hz: Option<f64>,
    /// About how long a cycle is in which commands are taken up once: see [`super::cycle`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command_cycle_s: Option<f64>,
    /// Over how long what is seen of a landmark is put together: see [`super::points`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points_s: Option<f64>,
    /// Of frames that follow at once, one in so long is taken: see [`super::odometry`].
    pub every_s: Option<f64>,
    /// Effects are found both one after another and backwards from all of them at once: see [`Search`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub both_ways: bool,
    /// The scenario by which this recording is learned from: a shipped one's name.
    pub learned_in: Option<String>,
}

impl Source {
    /// What is made of its logs.
    #[must_use]
    pub fn readied(&self) -> Readied {
        let Self { average_s, earlier_s, camera_hz, command_cycle_s, points_s, every_s, .. } = *self;
        Readied { average_s, earlier_s, camera_hz, command_cycle_s, points_s, every_s }
    }

    /// In which order its effects are found.
    #[must_use]
    pub fn search(&self) -> Search {
        Search::of(self.both_ways)
    }
}

/// Reads and checks a scenario of real logs; `None` where the file asks another kind of question, or is no TOML at all, which
/// [`crate::scenario::read`] says better.
///
/// # Errors
/// [`Bad`] shows where in the file what rule is broken by which value.
pub fn read(path: &Path) -> Result<Option<Real>, Bad> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(None) };
    let shown = path.display().to_string();
    let name = path.file_stem().map_or_else(|| shown.clone(), |stem| stem.to_string_lossy().into_owned());
    parse(&name, &shown, &text)
}

/// Checks the text of a scenario of real logs; `shown` is the file's name in errors.
///
/// # Errors
/// [`Bad`] shows where in the text what rule is broken by which value.
pub fn parse(name: &str, shown: &str, text: &str) -> Result<Option<Real>, Bad> {
    let Ok(table) = toml::de::DeTable::parse(text) else { return Ok(None) };
    if wire::study(table.get_ref()) != Some("real") {
        return Ok(None);
    }
    wire::check_schema(table.get_ref()).map_err(|fault| Bad::faults(shown, text, &table, &[fault]))?;
    let asked: Asked = toml::from_str(text).map_err(|error| Bad::syntax(shown, text, &error))?;
    let faults = asked.faults();
    if faults.is_empty() {
        Ok(Some(Real { name: name.to_owned(), asked }))
    } else {
        Err(Bad::faults(shown, text, &table, &faults))
    }
}

impl Asked {
    fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut fault = |path: String, message: String| faults.push(Fault { path, message });
        if self.about.trim().is_empty() {
            fault("about".into(), "about must state the question that the scenario asks, not nothing".into());
        }
        if self.logs.is_empty() {
            fault("logs".into(), "logs must hold at least one".into());
        }
        if let Some(Learning { learners, seeds, .. }) = &self.learning {
            if learners.is_empty() {
                fault("learning.learners".into(), "learners must hold at least one".into());
            }
            if !(1..=100).contains(seeds) {
                fault("learning.seeds".into(), format!("seeds must lie in 1..=100, not {seeds}"));
            }
        }
        let formats = import::catalogue();
        for (i, log) in self.logs.iter().enumerate() {
            let at = |key: &str| format!("logs.{i}.{key}");
            if self.logs[..i].iter().any(|it| it.name == log.name) {
                fault(at("name"), format!("each log must have a name of its own; {} is taken", log.name));
            }
            let Some(importer) = formats.iter().find(|it| it.name == log.format) else {
                let names: Vec<_> = formats.iter().map(|importer| format!("`{}`", importer.name)).collect();
                fault(at("format"), format!("unknown format `{}`, expected one of {}", log.format, names.join(", ")));
                continue;
            };
            log.readied().faults().into_iter().for_each(|(key, message)| fault(at(key), message));
            if log.learned_in.is_some() && self.learning.is_none() {
                fault(at("learned_in"), "learned_in says nothing without a table [learning]".into());
            }
            let robots = log.robots.as_deref().unwrap_or_default();
            let holds = importer.robots();
            if let Some(robot) = robots.iter().find(|robot| !holds.contains(robot)) {
                fault(at("robots"), format!("a {} source has no robot {robot}", log.format));
            }
            if robots.is_empty() && !holds.is_empty() {
                fault(at("format"), format!("of a {} source, robots must say whose logs", log.format));
            }
        }
        faults
    }
}

impl Real {
    /// `blake3:` and the hash of everything that bears on a diagnosis: not the prose.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut bearing = self.clone();
        bearing.asked.about.clear();
        // Serialising to memory fails only for maps with keys that are no strings: there are none.
        let bytes = serde_json::to_vec(&bearing).unwrap_or_default();
        format!("blake3:{}", blake3::hash(&bytes).to_hex())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1\nstudy = \"real\"\nabout = \"What parts them?\"\n[[logs]]\nname = \"m\"\nsource = \"x\"\n\
                        format = \"mrclam\"\nrobots = [1, 2]\nnominal = \"create\"\n";

    #[test]
    fn a_scenario_of_real_logs_is_read_and_others_are_left_to_others() {
        let real = parse("r", "r.toml", TEXT).unwrap().unwrap();
        assert_eq!(real.asked.logs[0].robots, Some(vec![1, 2]));
        assert_eq!(real.asked.logs[0].search(), Search::Forwards);
        let both = parse("r", "r.toml", &TEXT.replace("nominal =", "both_ways = true\nnominal =")).unwrap().unwrap();
        assert_eq!(both.asked.logs[0].search(), Search::BothWays);
        assert_ne!(both.hash(), real.hash(), "cases of the one are none of the other");
        assert_eq!(parse("r", "r.toml", &TEXT.replace("\"real\"", "\"line\"")).unwrap(), None);
        assert_eq!(parse("r", "r.toml", "no = [toml").unwrap(), None);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let said = |from: &str, to: &str| {
            let bad = parse("r", "r.toml", &TEXT.replace(from, to)).unwrap_err();
            format!("{:?}", miette::Report::new(bad))
        };
        assert!(said("\"mrclam\"", "\"clam\"").contains("unknown format `clam`"));
        assert!(said("nominal =", "every_s = 11.0\nnominal =").contains("every_s must lie in 0.001..=10 s, not 11"));
        assert!(said("nominal =", "points_s = 0.0\nnominal =").contains("points_s must lie in 0.01..=5 s, not 0"));
        assert!(said("nominal =", "earlier_s = 3.0\nnominal =").contains("earlier_s must lie in 0.001..=1 s, not 3"));
        assert!(
            said("nominal =", "camera_hz = 1e3\nnominal =").contains("camera_hz must lie in 0.5..=200 Hz, not 1000")
        );
        assert!(said("nominal =", "average_s = 0.0\nnominal =").contains("average_s must lie in 0.01..=10 s, not 0"));
        assert!(said("nominal =", "learned_in = \"mrclam\"\nnominal =").contains("without a table [learning]"));
        let learning = |table: &str| said("[[logs]]", &format!("[learning]\n{table}\n[[logs]]"));
        let none = learning("learners = []\nstarting_model = \"attempted\"\nseeds = 1");
        assert!(none.contains("learners must hold at least one"), "{none}");
        let many = learning("learners = [\"batch\"]\nstarting_model = \"attempted\"\nseeds = 101");
        assert!(many.contains("seeds must lie in 1..=100, not 101"), "{many}");
        let start = learning("learners = [\"batch\"]\nstarting_model = \"attemted\"\nseeds = 1");
        assert!(start.contains("unknown variant `attemted`"), "{start}");
        assert!(said("[1, 2]", "[1, 9]").contains("a mrclam source has no robot 9"));
        assert!(said("robots = [1, 2]\n", "").contains("robots must say whose logs"));
        assert!(said("What parts them?", " ").contains("about must state the question"));
        assert!(said("nominal", "nominel").contains("nominel"));
        assert!(said("schema = 1", "schema = 2").contains("schema must be 1"));
        let twice = format!("{TEXT}[[logs]]\nname = \"m\"\nsource = \"y\"\nformat = \"av21\"\nnominal = \"car\"\n");
        let said = format!("{:?}", miette::Report::new(parse("r", "r.toml", &twice).unwrap_err()));
        assert!(said.contains("each log must have a name of its own"), "{said}");
    }
}
