//! A log's diagnosis: the nominal world it is held against, the library and the calibration for it, and what is
//! written of the answer.

pub mod courses;
pub mod kin;
pub mod lasers;
pub mod limits;
pub mod nominal;
pub mod progress;
mod rehearsed;
mod reliability;
pub mod repaired;
pub mod self_test;
pub mod shelf;
pub mod words;

use std::path::{Path, PathBuf};

use asami_dataset::Log;
use asami_gap::answer::calibration::{Calibration, Left, less};
use asami_gap::answer::diagnose::Diagnoser;
use asami_gap::answer::diagnosis::CalibratedOn;
use asami_gap::library::Responses;
use asami_gap::real::kin::Kin;
use asami_gap::real::prior::{Prior, halves_differ};
use asami_gap::real::scanner::lasers::Laser;
use asami_gap::real::scanner::{self, Found};
use asami_gap::real::{self, Search};
use asami_gap::view::CannotSee;
use asami_gap::weigh::causes::Evidence;
use asami_gap::weigh::findings::Findings;
use asami_gap::weigh::practice::LAW;
use asami_gap::{Budget, Diagnosis, Nominal, Responds, Variant};
use asami_sim::effects::catalogue;

use crate::report::diagnosis::{Beside, report};
use crate::scenario::Robot;
use crate::scenario::fault::nearest;
use crate::sweep::manifest::program;
use courses::Played;
use limits::{Limited, ShowsNothing};
use nominal::{Held, NoNominal};
use progress::Listener;
use repaired::CannotRepair;
use shelf::{CannotShelve, Shelf, Shelved};

/// Planted cases that probabilities are calibrated on.
const CASES: usize = 300;
/// Of a robot in Rapier, where each takes seconds. The Aibo's log-loss on cases held back is 4.1 nats uncalibrated, 2.6 with
/// 50 planted, 2.3 with 75, and 2.2 from 100 to 200.
const CASES_IN_RAPIER: usize = 75;
/// Fewer cases, those with their effect taken out of the list among them, are not learned from.
const LEAST_CASES: usize = 75;
const _: () = assert!(LEAST_CASES <= CASES_IN_RAPIER && CASES_IN_RAPIER <= CASES);

/// What a real robot's log is diagnosed by.
const BY_HALVES: &str = "of each half of the log, in pieces of 20 s by turns, the other half says how noisy robot and sensor are; \
                         probabilities are not calibrated";
/// And a real laser scanner's.
const BY_SCANS: &str = "the scanner is held against the table of its own lasers, by its scans alone; how they scatter from second \
                        to second says how much is chance, and probabilities are not calibrated";

/// And a real car's that tells its own motion.
const BY_PEDALS: &str = "the car is held against what its pedals and steering bring about in the nominal world, by its odometry, while \
                         it is under way; a quarter of the log, in pieces of 20 s, says how that scatters; it is not diagnosed, and \
                         probabilities are not calibrated";

/// What is asked of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The nominal scenario, where not the one that the log names.
    pub nominal: Option<PathBuf>,
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// Where libraries are kept.
    pub libraries: PathBuf,
    /// How much is played for one, where not what suits the robot.
    pub budget: Option<Budget>,
    /// Whether the log is of a real robot, whose noise nobody simulated: see [`asami_gap::real`].
    pub real: bool,
    /// And what others of its make have.
    pub kin: Kin,
    /// And whether its halves are diagnosed first, each by itself, and its nats count as much less as they differ by more than they
    /// are said to.
    pub by_halves: bool,
    /// And in which order effects are found.
    pub search: Search,
    /// And, where its camera takes pictures by a clock of its own, from each to the next.
    pub picture_period_s: Option<f64>,
    /// And, where commands are taken up once in a cycle, how long that is.
    pub command_cycle_s: Option<f64>,
    /// What is to be said of what was made of the log before.
    pub notes: Vec<String>,
    /// Planted cases that must be there to calibrate on, where not what suits the robot.
    pub calibrate: Option<usize>,
}

/// There is no diagnosis.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum CannotDiagnose {
    /// No nominal world.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Nominal(#[from] NoNominal),
    /// The log shows nothing.
    #[error("nothing can be said: {0}")]
    Limits(#[from] ShowsNothing),
    /// Nor to the filter.
    #[error("nothing can be said: {0}")]
    See(#[from] CannotSee),
    /// An effect that is not in the catalogue.
    #[error("there is no effect {name}{}; `list effects` shows all", meant(name))]
    NoSuchEffect {
        /// The name.
        name: String,
    },
    /// No library.
    #[error(transparent)]
    Shelve(#[from] CannotShelve),
    /// The scenario with the effect is none.
    #[error(transparent)]
    Repair(#[from] CannotRepair),
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
}

fn meant(name: &str) -> String {
    nearest(name, catalogue().iter().map(|about| about.name))
        .map_or(String::new(), |it| format!(" (did you mean {it}?)"))
}

/// All that diagnoses of one nominal world's logs need.
pub struct Ready {
    /// The nominal world.
    pub held: Held,
    /// Its library.
    pub shelved: Shelved,
    /// Kinds of effects that are thought of.
    pub variants: Vec<Variant>,
    /// Effects that are not.
    pub without: Vec<String>,
    /// Planted cases, as they are without these.
    pub cases: Vec<Left>,
    calibration: Calibration,
    /// How the robot may be driven next.
    pub courses: Played,
}

impl Ready {
    /// What a log like this needs.
    ///
    /// # Errors
    /// [`CannotDiagnose`] where there is no nominal world, or its library cannot be made.
    pub fn new(log: &Log, asked: &Asked, listener: &dyn Listener) -> Result<Self, CannotDiagnose> {
        if let Some(name) = asked.without.iter().find(|name| !catalogue().iter().any(|about| about.name == **name)) {
            return Err(CannotDiagnose::NoSuchEffect { name: name.clone() });
        }
        let held = Held::find(asked.nominal.as_deref(), log)?;
        let on: Vec<String> = held.simulation.effects.iter().map(|effect| effect.about().name.to_owned()).collect();
        let variants = Variant::all(held.simulation.robot.name(), held.simulation.field.beacons.len(), &on);
        let budget = asked.budget.unwrap_or_else(|| Budget::of(held.simulation.robot.name()));
        let shelved = if asked.real && held.simulation.robot == Robot::Car {
            Shelved::unplayed(&variants)
        } else {
            let shelf = Shelf { folder: asked.libraries.clone(), budget, listener };
            shelf.library(&held.name, &held.simulation, &variants)?
        };
        let suits = if held.simulation.robot == Robot::Plain { CASES } else { CASES_IN_RAPIER };
        // Of a real robot: its noise is none of theirs.
        let cases = if asked.real { 0 } else { asked.calibrate.unwrap_or(suits) };
        let cases = shelved.cases(&held.simulation, length_s(log), cases, listener)?;
        let cases = less(&cases, &asked.without);
        let calibration = if cases.len() < LEAST_CASES {
            if !asked.real {
                listener.says(
                    "probabilities are the evidence as it is: with --calibrate N they are calibrated on planted cases",
                );
            }
            Calibration::default()
        } else {
            Calibration::of(&cases)
        };
        let without = asked.without.clone();
        let variants = variants.into_iter().filter(|it| !without.iter().any(|name| name == it.about.name)).collect();
        let courses = Played::new(&held.simulation, length_s(log));
        Ok(Self { held, shelved, variants, without, cases, calibration, courses })
    }

    /// What a log says of each cause.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn evidence(&self, log: &Log) -> Result<Evidence, CannotSee> {
        Ok(Findings::new(&*self.shelved.library.judge(log)?, &self.variants).evidence())
    }

    /// The same of a real robot's log, by what is known beforehand, or of a real laser scanner's, with what its lasers are off by.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn diagnose_real(&self, log: &Log, prior: &Prior, search: Search) -> Result<Found, CannotSee> {
        match &self.shelved.library {
            Responses::Landmarks(library) => {
                let diagnosis = real::diagnose_among(library, &self.variants, log, prior, search)?;
                Ok(Found { diagnosis, lasers: Vec::new() })
            }
            Responses::Drives(_) | Responses::Unplayed if log.firings.is_some() => {
                scanner::diagnose(&self.variants, log)
            }
            Responses::Drives(_) | Responses::Unplayed => {
                let (simulation, variants) = (&self.held.simulation, &self.variants);
                let car = simulation.car().ok_or(CannotSee::NoPedals)?;
                let diagnosis = real::pedals::diagnose(car, &simulation.effects, variants, log)?;
                Ok(Found { diagnosis, lasers: Vec::new() })
            }
        }
    }

    /// What is known of a real robot's log beforehand: of its kin what was asked, and by its halves, where they are asked, how far it is
    /// to be believed.
    fn prior(&self, log: &Log, asked: &Asked, listener: &dyn Listener) -> Result<Prior, CannotDiagnose> {
        let prior = Prior { kin: asked.kin.clone(), ..Prior::NONE };
        if !asked.by_halves || self.held.simulation.robot == Robot::Car {
            return Ok(prior);
        }
        let [first, second] = log.halves().map(|half| {
            listener.says("reading a half of the log");
            let Limited { log, .. } = limits::of_real(&half)?;
            Ok::<_, CannotDiagnose>(self.diagnose_real(&log, &prior, asked.search)?.diagnosis)
        });
        let times = halves_differ([[&first?, &second?]]);
        listener
            .says(&format!("halves of the log differ by {times:.2} times as much as they are said to, no less than 1"));
        Ok(prior.whose_halves_differ(times))
    }

    /// Where, which and how far.
    ///
    /// # Errors
    /// [`CannotSee`] says what the log lacks.
    pub fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotSee> {
        let (library, calibration) = (&self.shelved.library, &self.calibration);
        let diagnoser = Diagnoser { library, calibration, variants: &self.variants, courses: &self.courses };
        let mut diagnosis = diagnoser.diagnose(log)?;
        diagnosis.calibrated_on = (self.calibration.cases > 0).then(|| CalibratedOn {
            scenario: self.held.name.clone(),
            cases: self.cases.len(),
            size_law: LAW.to_owned(),
        });
        Ok(diagnosis)
    }
}

/// A diagnosis, and what it was made of.
pub struct Answer {
    /// The diagnosis.
    pub diagnosis: Diagnosis,
    /// What the log cannot show.
    pub notes: Vec<String>,
    /// The text of `with_effect.toml`, where an effect was found.
    pub with_effect: Option<String>,
    /// What each laser of a real scanner is off by; empty of others, and where nothing is.
    pub lasers: Vec<Laser>,
    /// How much of the log was looked at.
    pub length_s: f64,
}

impl Answer {
    /// The diagnosis of a log.
    ///
    /// # Errors
    /// [`CannotDiagnose`] says what is missing.
    pub fn new(log: &Log, asked: &Asked, listener: &dyn Listener) -> Result<(Self, Ready), CannotDiagnose> {
        let Limited { log, mut notes } = if asked.real { limits::of_real(log)? } else { limits::limits(log)? };
        notes.extend(asked.notes.iter().cloned());
        if asked.real {
            let car = log.known.robot == Robot::Car.name();
            let by = if !car {
                BY_HALVES
            } else if log.firings.is_some() {
                BY_SCANS
            } else {
                BY_PEDALS
            };
            notes.push(by.to_owned());
            if car && asked.by_halves {
                notes.push("of a car seconds of the log, not halves, say how far it is to be believed".to_owned());
            }
            if car && asked.search == Search::BothWays {
                notes.push("effects of a car are found one after another alone".to_owned());
            }
            let robots = asked.kin.robots();
            if robots > 0 && car {
                notes.push("what other cars of its make have is not asked of a car".to_owned());
            } else if robots > 0 {
                notes.push(format!(
                    "what {robots} others of its make have is expected of it, and counts as evidence; what none has is not"
                ));
            }
        }
        notes.iter().for_each(|note| listener.says(&format!("note: {note}")));
        let ready = Ready::new(&log, asked, listener)?;
        listener.says("reading the log");
        let Found { mut diagnosis, lasers } = if asked.real {
            ready.diagnose_real(&log, &ready.prior(&log, asked, listener)?, asked.search)?
        } else {
            Found { diagnosis: ready.diagnose(&log)?, lasers: Vec::new() }
        };
        diagnosis.picture_period_s = asked.picture_period_s;
        diagnosis.command_cycle_s = asked.command_cycle_s;
        let cause = repaired::cause(&diagnosis);
        let with_effect = cause.map(|cause| repaired::whole(&ready.held.text, cause, &diagnosis)).transpose()?;
        Ok((Self { diagnosis, notes, with_effect, lasers, length_s: length_s(&log) }, ready))
    }

    /// Writes `diagnosis.json`, `report.html` and `with_effect.toml`, of a real scanner `lasers.csv` as well; the last two are removed
    /// where no effect was found.
    ///
    /// # Errors
    /// [`CannotDiagnose::Write`].
    pub fn write(&self, log: &str, ready: &Ready, out: &Path) -> Result<(), CannotDiagnose> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| CannotDiagnose::Write { path, source }
        };
        std::fs::create_dir_all(out).map_err(failed(out))?;
        let json = out.join("diagnosis.json");
        let text = serde_json::to_string_pretty(&self.diagnosis).map_err(|error| failed(&json)(error.into()))?;
        std::fs::write(&json, text + "\n").map_err(failed(&json))?;
        let lasers = (!self.lasers.is_empty()).then(|| lasers::csv(&self.lasers));
        for (name, text) in [("with_effect.toml", &self.with_effect), ("lasers.csv", &lasers)] {
            let path = out.join(name);
            match text {
                Some(text) => std::fs::write(&path, text).map_err(failed(&path))?,
                None => match std::fs::remove_file(&path) {
                    Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(failed(&path)(error)),
                    _ => {}
                },
            }
        }
        let page = out.join("report.html");
        let report = report(&self.diagnosis, &self.beside(log, ready));
        report.write(&page).map_err(|error| failed(&error.path)(error.source))
    }

    fn beside(&self, log: &str, ready: &Ready) -> Beside {
        let blake3 = |text: &str| format!("blake3:{}", blake3::hash(text.as_bytes()).to_hex());
        Beside {
            log: log.to_owned(),
            nominal: ready.held.name.clone(),
            notes: self.notes.clone(),
            without: ready.without.clone(),
            reliability: reliability::curve(&ready.cases),
            made_with: vec![
                ("nominal scenario".to_owned(), format!("{} {}", ready.held.name, blake3(&ready.held.text))),
                ("library".to_owned(), file_name(&ready.shelved.folder)),
                ("program".to_owned(), program()),
            ],
        }
    }
}

fn length_s(log: &Log) -> f64 {
    log.span_s().map_or(0.0, |(first_s, last_s)| last_s - first_s)
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
const EXAMPLE: &str = include_str!("example.json");
