//! Finished blind sweeps of several worlds, scored together: `study = "pooled"` in a TOML file.

use std::path::{Path, PathBuf};

use asami_dataset::parameters::Fault;
use serde::{Deserialize, Serialize};

use super::scenario::{self, Blind, Expect};
use super::walk::{Question, Record, Results, name};
use crate::scenario::{Bad, wire};
use crate::sweep::cases;

/// A checked pool.
#[derive(Clone, Debug, PartialEq)]
pub struct Pool {
    /// The file's name without its extension.
    pub name: String,
    /// Everything else as it stands in the file.
    pub asked: Pooled,
    /// The scenarios that are pooled.
    pub of: Vec<Blind>,
}

/// What is asked, as it stands in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pooled {
    /// Version of the format.
    pub schema: i64,
    /// `pooled`.
    pub study: String,
    /// The question.
    pub about: String,
    /// Blind scenario files beside this one, of the same diagnosers.
    pub of: Vec<String>,
    /// The expected answers.
    #[serde(default)]
    pub expect: Vec<Expect>,
}

/// Why sweeps cannot be pooled.
#[derive(Debug, thiserror::Error)]
pub enum CannotPool {
    /// A sweep is not there, or not done.
    #[error("{} holds {found} of the {of} cases of {scenario}: `sweep scenarios/{scenario}.toml` makes them", folder.display())]
    Unfinished {
        /// Where its results should be.
        folder: PathBuf,
        /// The scenario's name.
        scenario: String,
        /// Cases that are there.
        found: usize,
        /// Cases that the scenario has.
        of: usize,
    },
    /// The scenario has changed since.
    #[error(
        "{} is of another {scenario}.toml than the one that is pooled: `sweep scenarios/{scenario}.toml` makes it anew",
        folder.display()
    )]
    Stale {
        /// Where its results are.
        folder: PathBuf,
        /// The scenario's name.
        scenario: String,
    },
}

/// Reads and checks a pool; `None` where the file asks another kind of question, or is no TOML at all.
///
/// # Errors
/// [`Bad`] shows where in the file what rule is broken by which value.
pub fn read(path: &Path) -> Result<Option<Pool>, Bad> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(None) };
    let shown = path.display().to_string();
    let name = path.file_stem().map_or_else(|| shown.clone(), |stem| stem.to_string_lossy().into_owned());
    let folder = path.parent().unwrap_or(Path::new("."));
    parse(&name, &shown, &text, &|of| {
        let path = folder.join(format!("{of}.toml"));
        match scenario::read(&path) {
            Ok(Some(blind)) => Ok(blind),
            Ok(None) => Err(format!("{} is no blind scenario, or is not there", path.display())),
            Err(bad) => Err(format!("{}: {bad}", path.display())),
        }
    })
}

/// Checks the text of a pool; `shown` is the file's name in errors, `blind` gives a scenario by its name.
///
/// # Errors
/// [`Bad`] shows where in the text what rule is broken by which value.
pub fn parse(
    name: &str,
    shown: &str,
    text: &str,
    blind: &dyn Fn(&str) -> Result<Blind, String>,
) -> Result<Option<Pool>, Bad> {
    let Ok(table) = toml::de::DeTable::parse(text) else { return Ok(None) };
    if wire::study(table.get_ref()) != Some("pooled") {
        return Ok(None);
    }
    wire::check_schema(table.get_ref()).map_err(|fault| Bad::faults(shown, text, &table, &[fault]))?;
    let asked: Pooled = toml::from_str(text).map_err(|error| Bad::syntax(shown, text, &error))?;
    let (mut faults, mut of): (Vec<Fault>, Vec<Blind>) = (Vec::new(), Vec::new());
    let mut fault = |path: String, message: String| faults.push(Fault { path, message });
    if asked.about.trim().is_empty() {
        fault("about".into(), "about must state the question that the scenario asks, not nothing".into());
    }
    if asked.of.len() < 2 {
        fault("of".into(), "of must name at least two blind scenarios".into());
    }
    for (i, name) in asked.of.iter().enumerate() {
        let found = match blind(name) {
            _ if asked.of[..i].contains(name) => Err(format!("{name} is pooled already")),
            Ok(it) if it.asked.cases_from.is_some() => Err(format!("{name} has another program's cases (cases_from)")),
            Ok(it) if of.first().is_some_and(|first| first.asked.diagnosers != it.asked.diagnosers) => {
                Err(format!("{name} asks other diagnosers than {}", asked.of[0]))
            }
            found => found,
        };
        match found {
            Ok(blind) => of.push(blind),
            Err(message) => fault(format!("of.{i}"), message),
        }
    }
    if let Some(first) = of.first() {
        faults.extend(Expect::faults(&asked.expect, &first.asked.diagnosers));
    }
    if faults.is_empty() {
        Ok(Some(Pool { name: name.to_owned(), asked, of }))
    } else {
        Err(Bad::faults(shown, text, &table, &faults))
    }
}

impl Pool {
    /// The cases of all its sweeps, whose results are in folders of their names under `results`.
    ///
    /// # Errors
    /// [`CannotPool`] names the first sweep that is not there, not done, or of another scenario.
    pub fn gathered(&self, results: &Path) -> Result<Results, CannotPool> {
        let mut records = Vec::new();
        for blind in &self.of {
            records.extend(finished(blind, &results.join(&blind.name))?);
        }
        let hashes: Vec<String> =
            self.of.iter().map(|blind| format!("{} {}", blind.asked.cases, blind.hash())).collect();
        let question = Question {
            name: self.name.clone(),
            about: self.asked.about.clone(),
            hash: format!("blake3:{}", blake3::hash(hashes.join("\n").as_bytes()).to_hex()),
            diagnosers: self.of.first().map(|it| it.asked.diagnosers.clone()).unwrap_or_default(),
            next_experiment: false,
            expect: self.asked.expect.clone(),
        };
        let of = self.of.iter().map(|blind| (blind.name.clone(), blind.asked.cases)).collect();
        Ok(Results { question, of, records })
    }
}

/// The cases of a finished sweep.
fn finished(blind: &Blind, folder: &Path) -> Result<Vec<Record>, CannotPool> {
    /// What is asked of a manifest.
    #[derive(Deserialize)]
    struct Made {
        scenario_hash: String,
    }
    let scenario = || blind.name.clone();
    let made = std::fs::read(folder.join("manifest.json")).ok();
    let made = made.and_then(|bytes| serde_json::from_slice::<Made>(&bytes).ok());
    if made.is_some_and(|made| made.scenario_hash != blind.hash()) {
        return Err(CannotPool::Stale { folder: folder.to_owned(), scenario: scenario() });
    }
    let of = blind.asked.cases;
    let records: Vec<Record> = (1..=of).filter_map(|number| cases::kept(folder, &name(number))).collect();
    if records.len() < of {
        return Err(CannotPool::Unfinished {
            folder: folder.to_owned(),
            scenario: scenario(),
            found: records.len(),
            of,
        });
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1\nstudy = \"pooled\"\nabout = \"Are causes named?\"\nof = [\n  \"a\",\n  \"b\",\n]\n\
                        [[expect]]\ndiagnoser = \"asami\"\nmeasure = \"set_size\"\nmax = 1.4\n";

    /// Of `a` and `b`, of which the latter may be another program's, and `c`, which asks somebody else.
    fn blind(name: &str) -> Result<Blind, String> {
        let diagnoser = if name == "c" { "forward_selection" } else { "asami" };
        let cases = if name == "foreign" { "cases_from = \"x\"" } else { "salt = \"s\"" };
        let text = format!(
            "schema = 1\nstudy = \"blind\"\nabout = \"?\"\nnominal = \"plain_2d\"\nduration_s = 10\ncases = 2\n{cases}\n\
             diagnosers = [\"{diagnoser}\"]\n"
        );
        let nominal = |_: &str| Ok(include_str!("../../scenarios/plain_2d.toml").to_owned());
        match scenario::parse(name, name, &text, &nominal) {
            Ok(Some(blind)) if ["a", "b", "c", "foreign"].contains(&name) => Ok(blind),
            _ => Err(format!("no {name}")),
        }
    }

    #[test]
    fn what_cannot_be_pooled_is_said_with_its_place() {
        let pool = parse("p", "p.toml", TEXT, &blind).unwrap().unwrap();
        assert_eq!(pool.of.iter().map(|it| it.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(parse("p", "p.toml", &TEXT.replace("pooled", "blind"), &blind).unwrap(), None);
        let broken = [
            ("\"b\"", "\"x\"", 6, "no x"),
            ("\"b\"", "\"a\"", 6, "pooled already"),
            ("\"b\"", "\"c\"", 6, "other diagnosers"),
            ("\"b\"", "\"foreign\"", 6, "another program's cases"),
            ("  \"b\",\n", "", 4, "at least two"),
            ("\"asami\"", "\"me\"", 8, "none of the diagnosers"),
            ("max = 1.4\n", "", 7, "min, max or both"),
            ("Are causes named?", " ", 3, "must state the question"),
        ];
        for (text, with, line, why) in broken {
            let bad = parse("p", "p.toml", &TEXT.replace(text, with), &blind).unwrap_err();
            let mut shown = String::new();
            miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none())
                .render_report(&mut shown, &bad)
                .unwrap();
            assert!(shown.contains(why), "{why}: {shown}");
            assert!(bad.line().is_some_and(|it| it.abs_diff(line) <= 1), "{why}: {:?}", bad.line());
        }
    }

    #[test]
    fn what_is_not_finished_is_not_pooled() {
        let pool = parse("p", "p.toml", TEXT, &blind).unwrap().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let keep = |name: &str, count: usize, hash: &str| {
            let store = cases::Store::open(&folder.path().join(name), "some key").unwrap();
            for number in 1..=count {
                store.keep(&super::name(number), &Record::blank(&blind(name).unwrap(), number, Vec::new())).unwrap();
            }
            let manifest = format!("{{\"scenario_hash\": \"{hash}\"}}");
            std::fs::write(folder.path().join(name).join("manifest.json"), manifest).unwrap();
        };
        let hash = |name: &str| blind(name).unwrap().hash();
        let why = || pool.gathered(folder.path()).unwrap_err().to_string();
        assert!(why().contains("a holds 0 of the 2 cases of a"), "{}", why());
        keep("a", 2, &hash("a"));
        keep("b", 1, &hash("b"));
        assert!(why().contains("b holds 1 of the 2 cases of b"), "{}", why());
        keep("b", 2, &hash("c"));
        assert!(why().contains("another b.toml"), "{}", why());
        keep("b", 2, &hash("b"));
        let results = pool.gathered(folder.path()).unwrap();
        let cases: Vec<(&str, usize)> = results.cases().map(|(name, record)| (name, record.number)).collect();
        assert_eq!(cases, [("a", 1), ("a", 2), ("b", 1), ("b", 2)]);
    }
}
