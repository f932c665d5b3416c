//! The rules of simulations and recordings.

use std::collections::BTreeSet;

use asami_dataset::parameters::{Fault, Parameter, Parameters, out_of_range};
use asami_sim::effects::Effects;
use asami_sim::scenes::field::Field;
use asami_sim::survey::Surveying;

use super::super::wire::{self, Wire};
use super::super::{Origin, Part, Policy, Recording, Roams, Robot, Simulation, Study, Window};
use super::{DURATION, fault, number};
use asami_sim::ride::Ride;

const SEEDS: Parameter = number("seeds", "1", (1.0, 10_000.0));
const FIRST_SEED: Parameter = number("first_seed", "1", (0.0, 9e15));
const WINDOW_LENGTH: Parameter = number("length_s", "s", (1.0, 36_000.0));
const WINDOW_START: Parameter = number("disjoint_starts_s", "s", (0.0, 360_000.0));
const LEARNED: Parameter = number("learned_s", "s", (1.0, 36_000.0));
const WINDOW_EVERY: Parameter = number("overlapping_every_s", "s", (0.1, 36_000.0));

/// Which scenarios a key is for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Recordings,
    /// Of any robot.
    Simulations,
    /// Simulations of a car.
    Car,
    /// Commands that take any value: of recordings, and of a wheeled robot.
    Commands,
    /// Simulations of a wheeled robot.
    Create,
    /// Simulations of robots with legs, or of the dissertation's own.
    Legs,
    /// Simulations of robots that see landmarks.
    Landmarks,
}

/// The keys of `wire` that are for some scenarios and not for others.
fn keys(wire: &Wire) -> Vec<(&'static str, Of)> {
    macro_rules! those_there {
        ($($of:ident { $($key:ident),* })*) => { [$($((stringify!($key), Of::$of, wire.$key.is_some())),*),*] };
    }
    let all = those_there! {
        Recordings { windows, format, depths, robots, landmarks }
        Commands { binning }
        Simulations { duration_s, seeds, first_seed, effects }
        Car { town, car, driving, velodyne, unit, applanix }
        Create { create, roam }
        Legs { aibo, plain, suite, camera, drive, explore, survey }
        Landmarks { field, start }
    };
    all.into_iter().filter(|(_, _, is_there)| *is_there).map(|(key, of, _)| (key, of)).collect()
}

/// Either a simulation or a recording: the keys of one are faults in the other.
pub(super) fn origin(wire: &Wire, faults: &mut Vec<Fault>) -> Option<Origin> {
    match (&wire.source, wire.robot) {
        (Some(source), None) => recording(wire, source, faults).map(Box::new).map(Origin::Recorded),
        (None, Some(robot)) => simulation(wire, robot, faults).map(Box::new).map(Origin::Simulated),
        (Some(_), Some(_)) => {
            fault(faults, "source", "source (a recorded log) and robot (a simulated one) exclude each other");
            None
        }
        (None, None) => {
            fault(faults, "about", "a scenario must have robot = \"...\" (simulated) or source = \"...\" (recorded)");
            None
        }
    }
}

fn recording(wire: &Wire, source: &str, faults: &mut Vec<Fault>) -> Option<Recording> {
    for (key, _) in keys(wire).into_iter().filter(|(_, of)| !matches!(of, Of::Recordings | Of::Commands)) {
        fault(faults, key, format!("{key} belongs to simulated scenarios; this one has source = \"{source}\""));
    }
    if source.trim().is_empty() {
        fault(faults, "source", "source must be the path of a recorded log, not empty");
    }
    if let Some(format) = &wire.format
        && !crate::import::catalogue().iter().any(|importer| importer.name == format)
    {
        let names: Vec<_> = crate::import::catalogue().iter().map(|importer| format!("`{}`", importer.name)).collect();
        fault(faults, "format", format!("unknown format `{format}`, expected one of {}", names.join(", ")));
    }
    let Some(windows) = &wire.windows else {
        fault(faults, "source", "a recorded log must be cut: [windows] is missing");
        return None;
    };
    faults.extend(out_of_range("windows", &WINDOW_LENGTH, windows.length_s));
    for (i, start_s) in windows.disjoint_starts_s.iter().enumerate() {
        if let Some(found) = out_of_range("windows", &WINDOW_START, *start_s) {
            fault(faults, &format!("windows.disjoint_starts_s.{i}"), found.message);
        }
    }
    if windows.disjoint_starts_s.is_empty() {
        fault(faults, "windows.disjoint_starts_s", "disjoint_starts_s must hold at least one start, not none");
    }
    for (i, pair) in windows.disjoint_starts_s.windows(2).enumerate() {
        if pair[1] < pair[0] + windows.length_s {
            let path = format!("windows.disjoint_starts_s.{}", i + 1);
            let (second, first, length) = (pair[1], pair[0], windows.length_s);
            fault(faults, &path, format!("disjoint windows must not overlap: {second} < {first} + length_s {length}"));
        }
    }
    if let Some(every_s) = windows.overlapping_every_s {
        faults.extend(out_of_range("windows", &WINDOW_EVERY, every_s));
    }
    let learned_s = windows.learned_s;
    if let Some(learned_s) = learned_s {
        let range = (LEARNED.range.0, windows.length_s);
        faults.extend(out_of_range("windows", &Parameter { range, ..LEARNED }, learned_s));
        if wire.study != Study::Car {
            fault(faults, "windows.learned_s", "learned_s belongs to study \"car\"");
        }
    }
    let parts = parts(wire, faults);
    let binning = wire.binning.clone();
    if let Some(binning) = &binning {
        binning.check("binning", faults);
    }
    let depths = wire.depths.clone();
    if let Some(depths) = &depths {
        depths.check("depths", wire.robots.as_ref().map_or(1, Vec::len), faults);
    }
    let cut = if faults.is_empty() { cut(windows) } else { Vec::new() };
    let (source, format) = (source.to_owned(), wire.format.clone());
    Some(Recording { source, format, binning, depths, parts, windows: cut, learned_s })
}

/// Every robot with every set of landmarks.
fn parts(wire: &Wire, faults: &mut Vec<Fault>) -> Vec<Part> {
    let (mut robots, mut sizes) = (BTreeSet::new(), BTreeSet::new());
    for (i, robot) in wire.robots.iter().flatten().enumerate() {
        if !robots.insert(*robot) {
            fault(faults, &format!("robots.{i}"), format!("robots must differ; {robot} stands here twice"));
        }
    }
    for (i, landmarks) in wire.landmarks.iter().flatten().enumerate() {
        let path = format!("landmarks.{i}");
        if landmarks.is_empty() || landmarks.iter().collect::<BTreeSet<_>>().len() < landmarks.len() {
            fault(faults, &path, "a set of landmarks must hold at least one, and none twice");
        }
        if !sizes.insert(landmarks.len()) {
            let size = landmarks.len();
            fault(faults, &path, format!("sets are told apart by their size; a second one of {size} landmarks is not"));
        }
    }
    for (key, is_empty) in [
        ("robots", wire.robots.as_ref().is_some_and(Vec::is_empty)),
        ("landmarks", wire.landmarks.as_ref().is_some_and(Vec::is_empty)),
    ] {
        if is_empty {
            fault(faults, key, format!("{key} must not be empty; leave it out for all"));
        }
    }
    let robots = wire.robots.as_ref().map_or(vec![None], |robots| robots.iter().copied().map(Some).collect());
    let sets = wire.landmarks.as_ref().map_or(vec![None], |sets| sets.iter().cloned().map(Some).collect());
    let with = |robot: &Option<u16>| {
        let robot = *robot;
        sets.iter().map(move |landmarks| Part { robot, landmarks: landmarks.clone() }).collect::<Vec<_>>()
    };
    robots.iter().flat_map(with).collect()
}

/// The disjoint windows, then the overlapping ones.
fn cut(windows: &wire::Windows) -> Vec<Window> {
    let length_s = windows.length_s;
    let starts_s = &windows.disjoint_starts_s;
    let mut all: Vec<Window> =
        starts_s.iter().map(|&start_s| Window { start_s, length_s, overlapping: false }).collect();
    if let (Some(every_s), Some(first_s), Some(last_s)) =
        (windows.overlapping_every_s, starts_s.first(), starts_s.last())
    {
        let mut n = 0.0;
        while first_s + n * every_s <= *last_s {
            all.push(Window { start_s: first_s + n * every_s, length_s, overlapping: true });
            n += 1.0;
        }
    }
    all
}

fn simulation(wire: &Wire, robot: Robot, faults: &mut Vec<Fault>) -> Option<Simulation> {
    for (key, _) in keys(wire).into_iter().filter(|(_, of)| *of == Of::Recordings) {
        fault(faults, key, format!("{key} belongs to recorded scenarios; this one has a robot"));
    }
    let mut required = |key: &Parameter, value: Option<f64>| {
        match value {
            Some(value) => faults.extend(out_of_range("", key, value)),
            None => fault(faults, "robot", format!("a simulated scenario must have {}", key.name)),
        }
        value
    };
    let duration_s = required(&DURATION, wire.duration_s);
    let seeds = required(&SEEDS, wire.seeds.map(|n| n as f64));
    let first_seed = wire.first_seed.unwrap_or(1);
    faults.extend(out_of_range("", &FIRST_SEED, first_seed as f64));
    of_the_robot(wire, robot, faults);
    let drive = policy(wire, robot, faults);
    let suite = wire.suite.clone().unwrap_or_default();
    suite.check("suite", faults);
    let plain = wire.plain.clone().unwrap_or_default();
    plain.check("plain", faults);
    let aibo = wire.aibo.clone().unwrap_or_default();
    aibo.check("aibo", faults);
    let camera = wire.camera.clone().unwrap_or_default();
    camera.check("camera", faults);
    let start = wire.start.clone().unwrap_or_default();
    start.check("start", faults);
    let field = wire.field.clone().unwrap_or_default();
    if robot != Robot::Car {
        field_rules(&field, faults);
    }
    let effects = wire.effects.clone().unwrap_or_default();
    effects_fit(&effects, robot, faults);
    let begins_s = effects.command_scale.as_ref().map_or(0.0, |scale| scale.from_s);
    if let Some(duration_s) = duration_s.filter(|duration_s| begins_s >= *duration_s) {
        let message = format!("from_s must be before the log ends, at duration_s {duration_s}, not {begins_s}");
        fault(faults, "effects.command_scale.from_s", message);
    }
    let survey = wire.survey.clone().unwrap_or_default();
    survey_rules(&survey, faults);
    Some(Simulation {
        robot,
        duration_s: duration_s?,
        seeds: seeds.map(|n| n as u32)?,
        first_seed: first_seed.max(0) as u64,
        aibo,
        plain,
        suite,
        camera,
        field,
        start,
        drive,
        effects,
        survey,
        engine: None,
    })
}

/// Chapter 5 has a robot and tables of its own.
fn of_the_robot(wire: &Wire, robot: Robot, faults: &mut Vec<Fault>) {
    let (name, study) = (robot.name(), wire.study.name());
    if (robot == Robot::Car) != (wire.study == Study::Car) {
        fault(
            faults,
            "robot",
            format!("robot \"car\" and study \"car\" belong together; here are \"{name}\" and \"{study}\""),
        );
        return;
    }
    if robot == Robot::Create && wire.study != Study::Plane {
        fault(faults, "robot", format!("robot \"create\" moves in the plane: study \"{study}\" is none of its"));
    }
    let foreign: &[Of] = match robot {
        Robot::Car => &[Of::Commands, Of::Create, Of::Legs, Of::Landmarks],
        Robot::Create => &[Of::Car, Of::Legs],
        Robot::Aibo | Robot::Plain => &[Of::Commands, Of::Car, Of::Create],
    };
    for (key, _) in keys(wire).into_iter().filter(|(_, of)| foreign.contains(of)) {
        fault(faults, key, format!("{key} is not for robot \"{name}\""));
    }
}

/// What is studied says how the robot is driven; the keys of another drive are faults.
fn policy(wire: &Wire, robot: Robot, faults: &mut Vec<Fault>) -> Policy {
    if robot == Robot::Create {
        let roams = Roams {
            create: wire.create.clone().unwrap_or_default(),
            roaming: wire.roam.clone().unwrap_or_default(),
            binning: wire.binning.clone(),
        };
        if let Some(binning) = &roams.binning {
            binning.check("binning", faults);
        }
        roams.create.check("create", faults);
        roams.roaming.check("roam", faults);
        return Policy::Roam(Box::new(roams));
    }
    let study = wire.study.name();
    if wire.study == Study::Car {
        let ride = Ride {
            town: wire.town.clone().unwrap_or_default(),
            car: wire.car.clone().unwrap_or_default(),
            driving: wire.driving.clone().unwrap_or_default(),
            velodyne: wire.velodyne.clone().unwrap_or_default(),
            unit: wire.unit.unwrap_or_default(),
            applanix: wire.applanix.clone().unwrap_or_default(),
        };
        ride.check(faults);
        return Policy::Route(Box::new(ride));
    }
    if wire.study == Study::Plane {
        if wire.drive.is_some() {
            fault(faults, "drive", format!("drive is the policy along a line; study \"{study}\" takes [explore]"));
        }
        let exploring = wire.explore.clone().unwrap_or_default();
        exploring.check("explore", faults);
        return Policy::Explore(exploring);
    }
    if wire.explore.is_some() {
        fault(faults, "explore", format!("explore is the policy in the plane; study \"{study}\" takes [drive]"));
    }
    let pacing = wire.drive.clone().unwrap_or_default();
    pacing.check("drive", faults);
    if pacing.far_height_px >= pacing.near_height_px {
        let (far, near) = (pacing.far_height_px, pacing.near_height_px);
        fault(faults, "drive.far_height_px", format!("far_height_px must be below near_height_px {near}, not {far}"));
    }
    match wire.study {
        Study::Stride => Policy::Stride(pacing),
        Study::Line | Study::Plane | Study::Car => Policy::Pace(pacing),
    }
}

fn survey_rules(survey: &Surveying, faults: &mut Vec<Fault>) {
    survey.check("survey", faults);
    if survey.far_m < survey.near_m {
        let (near, far) = (survey.near_m, survey.far_m);
        fault(faults, "survey.far_m", format!("far_m must not be below near_m {near}, not {far}"));
    }
    if survey.speed_step_m_per_s > survey.max_speed_m_per_s {
        let (most, step) = (survey.max_speed_m_per_s, survey.speed_step_m_per_s);
        let message = format!("speed_step_m_per_s must not exceed max_speed_m_per_s {most}, not {step}");
        fault(faults, "survey.speed_step_m_per_s", message);
    }
}

fn field_rules(field: &Field, faults: &mut Vec<Fault>) {
    field.check("field", faults);
    if field.beacons.is_empty() {
        fault(faults, "field", "the field must have at least one beacon: [[field.beacons]]");
    }
}

/// Effects must be in range, and fit the robot.
pub fn effects_fit(effects: &Effects, robot: Robot, faults: &mut Vec<Fault>) {
    effects.check("effects", faults);
    for about in effects.iter().map(asami_sim::effect::Declared::about) {
        if !about.fits.contains(&robot.name()) {
            let (name, fits, robot) = (about.name, about.fits.join(", "), robot.name());
            fault(faults, &format!("effects.{name}"), format!("{name} fits {fits}, not {robot}"));
        }
    }
}
