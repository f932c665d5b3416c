//! The catalogue: everything that has a name, with parameters, units, ranges and sources.

use std::fmt::Write;
use std::path::Path;

use asami_dataset::parameters::{Parameter, Parameters};
use asami_sim::drives::driver::Driving;
use asami_sim::drives::explore::Exploring;
use asami_sim::drives::pace::Pacing;
use asami_sim::drives::roam::Roaming;
use asami_sim::drives::suite::Suite;
use asami_sim::robots::aibo::config::AiboConfig;
use asami_sim::robots::car::CarConfig;
use asami_sim::robots::create::CreateConfig;
use asami_sim::robots::plain::PlainConfig;
use asami_sim::scenes::town::TownConfig;
use asami_sim::sensors::applanix::Applanix;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::sensors::velodyne::VelodyneConfig;
use asami_sim::survey::Surveying;

use crate::blind;
use crate::import;
use crate::real;
use crate::scenario::{self, Origin, Placement, Robot, Starting};

/// A kind of thing that can be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// What a nominal world leaves out
    Effects,
    /// Algorithms
    Learners,
    /// Scenario files
    Scenarios,
    /// Robots
    Robots,
    /// Log formats that `import` reads
    Importers,
}

impl Kind {
    /// All of them, in the order of listing.
    pub const ALL: [Kind; 5] = [Kind::Effects, Kind::Learners, Kind::Scenarios, Kind::Robots, Kind::Importers];

    /// Its part of the catalogue; scenario files are looked for in the folder `scenarios`.
    #[must_use]
    pub fn text(self, scenarios: &Path) -> String {
        match self {
            Kind::Effects => effects(),
            Kind::Learners => learners(),
            Kind::Scenarios => scenario_files(scenarios),
            Kind::Robots => robots(),
            Kind::Importers => importers(),
        }
    }
}

fn effects() -> String {
    let mut text = String::from(
        "EFFECTS, off at their defaults ([effects.NAME] in a scenario, generate --effect NAME.PARAM=VALUE)\n",
    );
    for about in asami_sim::effects::catalogue() {
        let place = format!("{}, shows in {}", words(about.place), words(about.block));
        let fits = about.fits.join(", ");
        entry(&mut text, about.name, about.what, &[("place", &place), ("fits", &fits), ("source", about.source)]);
        parameters(&mut text, about.parameters);
    }
    text
}

fn learners() -> String {
    let mut text = String::from("LEARNERS ([learners.NAME] in a scenario, learn --learner NAME --set PARAM=VALUE)\n");
    for about in asami_learners::catalogue() {
        let needs = words(about.needs);
        entry(&mut text, about.name, about.what, &[("given", &needs), ("source", about.source)]);
        parameters(&mut text, about.parameters);
    }
    text.push_str("\nStarting models of chapter 4\n  [starting]\n");
    parameters(&mut text, Starting::table());
    text
}

fn scenario_files(folder: &Path) -> String {
    let mut text = format!("SCENARIOS in {}\n", folder.display());
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    for path in files {
        let path_shown = path.display().to_string();
        if let Ok(Some(blind)) = blind::scenario::read(&path) {
            let logs =
                format!("{}, {} withheld cases of {} s", blind.nominal, blind.asked.cases, blind.asked.duration_s);
            let diagnosers = blind.asked.diagnosers.join(", ");
            entry(&mut text, &path_shown, &blind.about, &[("logs", &logs), ("diagnosers", &diagnosers)]);
            continue;
        }
        if let Ok(Some(pool)) = blind::pool::read(&path) {
            entry(&mut text, &path_shown, &pool.asked.about, &[("pools", &pool.asked.of.join(", "))]);
            continue;
        }
        if let Ok(Some(real)) = real::scenario::read(&path) {
            let logs: Vec<&str> = real.asked.logs.iter().map(|log| log.name.as_str()).collect();
            entry(&mut text, &path_shown, &real.asked.about, &[("logs", &logs.join(", "))]);
            continue;
        }
        match scenario::read(&path) {
            Ok(scenario) => {
                let origin = match &scenario.origin {
                    Origin::Simulated(s) => format!("{}, {} logs of {} s", s.robot.name(), s.seeds, s.duration_s),
                    Origin::Recorded(r) => format!("{}, {} windows", r.source, r.windows.len()),
                };
                let rows = format!("{} of learner, start and duration", scenario.rows.len());
                entry(&mut text, &path_shown, &scenario.about, &[("logs", &origin), ("rows", &rows)]);
            }
            Err(bad) => entry(&mut text, &path_shown, &format!("cannot be used: {bad}"), &[]),
        }
    }
    text
}

fn robots() -> String {
    let mut text = String::from("ROBOTS\n");
    let what = "Sony's ERS-7, walking in Rapier: multibody joints, servos, a virtual-wheel trot, a camera on its head";
    entry(&mut text, Robot::Aibo.name(), what, &[]);
    for (name, table) in AiboConfig::tables() {
        let _ = writeln!(text, "  [aibo.{name}]");
        parameters(&mut text, table);
    }
    let what = "The dissertation's own simulator (section 4.4.2): kinematics and Gaussian noise, truth exact";
    entry(&mut text, Robot::Plain.name(), what, &[]);
    for (name, table) in PlainConfig::tables() {
        let _ = writeln!(text, "  [plain.{name}]");
        parameters(&mut text, table);
    }
    let what =
        "An iRobot Create among landmarks in Rapier: two driven wheels, a caster, a sensor of ranges and bearings";
    entry(&mut text, Robot::Create.name(), what, &[]);
    for (name, table) in CreateConfig::tables() {
        let _ = writeln!(text, "  [create.{name}]");
        parameters(&mut text, table);
    }
    let _ = writeln!(text, "  [roam]");
    parameters(&mut text, Roaming::table());
    let what = "A car driven through a town in Rapier, with a Velodyne HDL-64E on its roof: a 1999 Isuzu VehiCross (chapter 5), \
         or with body = \"av21\" under [car] a driverless race car";
    entry(&mut text, Robot::Car.name(), what, &[]);
    for (name, table) in CarConfig::tables() {
        let _ = writeln!(text, "  [car.{name}]");
        parameters(&mut text, table);
    }
    let tables = [
        ("town", TownConfig::table()),
        ("driving", Driving::table()),
        ("velodyne", VelodyneConfig::table()),
        ("applanix", Applanix::table()),
    ];
    for (name, table) in tables {
        let _ = writeln!(text, "  [{name}]");
        parameters(&mut text, table);
    }
    let tables = [
        ("camera", CameraConfig::table()),
        ("drive", Pacing::table()),
        ("explore", Exploring::table()),
        ("suite", Suite::table()),
        ("start", Placement::table()),
        ("survey", Surveying::table()),
    ];
    text.push_str("\nTables of the others\n");
    for (name, table) in tables {
        let _ = writeln!(text, "  [{name}]");
        parameters(&mut text, table);
    }
    text
}

fn importers() -> String {
    let mut text = String::from("IMPORTERS (import NAME SOURCE -o DIR)\n");
    for importer in import::catalogue() {
        let robots: Vec<String> = importer.robots().iter().map(u16::to_string).collect();
        let robots = if robots.is_empty() { "one".to_owned() } else { format!("--robot {}", robots.join(", ")) };
        entry(&mut text, importer.name, importer.what, &[("robots", &robots), ("source", importer.source)]);
    }
    text
}

/// `StaticMotion` as "static motion".
fn words(variant: impl std::fmt::Debug) -> String {
    let mut words = String::new();
    for c in format!("{variant:?}").chars() {
        if c.is_ascii_uppercase() && !words.is_empty() {
            words.push(' ');
        }
        words.push(c.to_ascii_lowercase());
    }
    words
}

fn entry(text: &mut String, name: &str, what: &str, facts: &[(&str, &str)]) {
    let _ = writeln!(text, "\n{name}\n  {what}");
    for (key, value) in facts {
        let _ = writeln!(text, "  {key}: {value}");
    }
}

fn parameters(text: &mut String, parameters: &[Parameter]) {
    for parameter in parameters {
        let (least, greatest) = parameter.range;
        let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
        let values = format!("{} ({least} to {greatest}){unit}", parameter.default);
        let _ = writeln!(text, "    {:<26} {values:<34} {}", parameter.name, parameter.about.trim());
    }
}
