//! Which scenario a log is held against.

use std::path::{Path, PathBuf};

use asami_dataset::{Known, Log};

use crate::scenario::{self, Bad, Origin, Simulation};
use crate::sweep::manifest::repository;

/// The scenario whose world is taken as the nominal one.
#[derive(Clone, Debug)]
pub struct Held {
    /// Its name.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// The file's text.
    pub text: String,
    /// Its world.
    pub simulation: Box<Simulation>,
}

/// There is no nominal world.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum NoNominal {
    /// The scenario's file cannot be used.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Bad(#[from] Bad),
    /// No file of that name.
    #[error("there is no scenario {name}: no file of that name, and no {}", shipped.display())]
    Absent {
        /// The name.
        name: String,
        /// Where a shipped one would be.
        shipped: PathBuf,
    },
    /// Nothing names one, and nothing is shipped for such a robot.
    #[error("no world is shipped for robot \"{0}\": name a scenario with --nominal")]
    NoneShipped(String),
    /// It is about a recording.
    #[error("scenario {0} is about a recorded log: it has no world to hold this log against")]
    Recorded(String),
    /// It is about another robot.
    #[error("the log is of robot \"{log}\", the world of scenario {scenario} of robot \"{world}\"")]
    OtherRobot {
        /// The log's.
        log: String,
        /// The scenario.
        scenario: String,
        /// Its robot.
        world: &'static str,
    },
}

impl Held {
    /// The scenario asked for, else the one that the log names, else the one shipped for its robot.
    ///
    /// # Errors
    /// [`NoNominal`] where there is none, or it cannot be used.
    pub fn find(asked: Option<&Path>, log: &Log) -> Result<Self, NoNominal> {
        let known = &*log.known;
        if let Some(asked) = asked.filter(|asked| asked.is_file()) {
            return Self::read(asked, known);
        }
        let name = match (asked, &known.nominal) {
            (Some(asked), _) => asked.display().to_string(),
            (None, Some(nominal)) => nominal.clone(),
            (None, None) => shipped(log).ok_or_else(|| NoNominal::NoneShipped(known.robot.clone()))?.to_owned(),
        };
        let path = repository().join("scenarios").join(format!("{name}.toml"));
        // A name, and no way to a file elsewhere.
        let is_name = Path::new(&name).file_name().is_some_and(|last| last == name.as_str());
        if is_name && path.is_file() {
            Self::read(&path, known)
        } else {
            Err(NoNominal::Absent { name, shipped: path })
        }
    }

    fn read(path: &Path, known: &Known) -> Result<Self, NoNominal> {
        let scenario = scenario::read(path)?;
        let text =
            std::fs::read_to_string(path).map_err(|error| Bad::unreadable(&path.display().to_string(), &error))?;
        let Origin::Simulated(simulation) = scenario.origin else { return Err(NoNominal::Recorded(scenario.name)) };
        let world = simulation.robot.name();
        if world != known.robot {
            return Err(NoNominal::OtherRobot { log: known.robot.clone(), scenario: scenario.name, world });
        }
        Ok(Self { name: scenario.name, path: path.to_owned(), text, simulation })
    }
}

/// The scenario shipped for the log's robot and what it sees.
fn shipped(log: &Log) -> Option<&'static str> {
    match log.known.robot.as_str() {
        "aibo" if log.known.landmarks.len() > 1 => Some("aibo_2d"),
        "aibo" => Some("aibo_1d"),
        "plain" => Some("plain_2d"),
        "create" => Some("create"),
        "car" => Some("car"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Beacon;

    use super::*;

    fn log(robot: &str, landmarks: usize, nominal: Option<&str>) -> Log {
        let beacon = |id| Beacon { id, x_m: 0.0, y_m: 0.0, height_m: None };
        let known = Known {
            robot: robot.to_owned(),
            landmarks: (0..landmarks as u16).map(beacon).collect(),
            nominal: nominal.map(str::to_owned),
            ..Known::default()
        };
        Log { known: known.into(), ..Log::default() }
    }

    #[test]
    fn asked_goes_before_named_and_named_before_shipped() {
        let plane = Path::new("plain_2d");
        assert_eq!(Held::find(Some(plane), &log("plain", 0, Some("no_such"))).unwrap().name, "plain_2d");
        assert_eq!(Held::find(None, &log("aibo", 1, Some("aibo_2d"))).unwrap().name, "aibo_2d");
        for (robot, landmarks, name) in [
            ("aibo", 1, "aibo_1d"),
            ("aibo", 4, "aibo_2d"),
            ("plain", 4, "plain_2d"),
            ("create", 15, "create"),
            ("car", 0, "car"),
        ] {
            assert_eq!(Held::find(None, &log(robot, landmarks, None)).unwrap().name, name);
        }
    }

    #[test]
    fn what_is_no_nominal_world_is_said() {
        let said = |asked: Option<&str>, log: &Log| Held::find(asked.map(Path::new), log).unwrap_err().to_string();
        assert!(said(None, &log("tank", 1, None)).contains("no world is shipped for robot \"tank\""));
        assert!(said(None, &log("plain", 1, Some("no_such"))).contains("there is no scenario no_such"));
        assert!(said(Some("barfoot_1d"), &log("create", 1, None)).contains("recorded log"));
        assert!(said(Some("aibo_1d"), &log("plain", 1, None)).contains("of robot \"aibo\""));
    }
}
