//! From the file's values to a scenario that can be run: every rule in one place, every fault at once.

use std::collections::BTreeSet;

use asami_dataset::parameters::{Fault, Parameter, Parameters, out_of_range};
use asami_learners::{Learners, Needs};
use asami_sim::effects::Effects;
use asami_sim::scenes::field::Field;
use asami_sim::survey::Surveying;

use super::wire::{self, Wire};
use super::{Expect, Origin, Recording, Robot, Row, Scenario, Simulation, Start, Window};

const fn number(name: &'static str, unit: &'static str, range: (f64, f64)) -> Parameter {
    Parameter { name, unit, default: 0.0, range, about: "" }
}

/// An hour: longer logs do not fit the house's memory.
const DURATION: Parameter = number("duration_s", "s", (1.0, 3600.0));
const SEEDS: Parameter = number("seeds", "1", (1.0, 10_000.0));
const FIRST_SEED: Parameter = number("first_seed", "1", (0.0, 9e15));
const WINDOW_LENGTH: Parameter = number("length_s", "s", (1.0, 36_000.0));
const WINDOW_START: Parameter = number("disjoint_starts_s", "s", (0.0, 360_000.0));
const WINDOW_EVERY: Parameter = number("overlapping_every_s", "s", (0.1, 36_000.0));

/// Checks everything; `None` only with at least one fault.
pub fn scenario(name: &str, wire: Wire, faults: &mut Vec<Fault>) -> Option<Scenario> {
    if wire.about.trim().is_empty() {
        fault(faults, "about", "about must state the question that the scenario asks, not nothing");
    }
    wire.divergence.check("divergence", faults);
    let origin = origin(&wire, faults);
    let most_s = origin.as_ref().map_or(f64::INFINITY, longest_s);
    wire.learners.check("learners", faults);
    let rows = rows(&wire, most_s, faults);
    for (i, expect) in wire.expect.iter().enumerate() {
        expectation(i, expect, &rows, faults);
    }
    let Wire { about, learners, divergence, expect, .. } = wire;
    Some(Scenario { name: name.to_owned(), about, origin: origin?, rows, learners, divergence, expect })
}

fn fault(faults: &mut Vec<Fault>, path: &str, message: impl Into<String>) {
    faults.push(Fault { path: path.to_owned(), message: message.into() });
}

/// Either a simulation or a recording: the keys of one are faults in the other.
fn origin(wire: &Wire, faults: &mut Vec<Fault>) -> Option<Origin> {
    match (&wire.source, wire.robot) {
        (Some(source), None) => recording(wire, source, faults).map(Origin::Recorded),
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
    let simulated = [
        ("duration_s", wire.duration_s.is_some()),
        ("seeds", wire.seeds.is_some()),
        ("first_seed", wire.first_seed.is_some()),
        ("aibo", wire.aibo.is_some()),
        ("camera", wire.camera.is_some()),
        ("field", wire.field.is_some()),
        ("start", wire.start.is_some()),
        ("drive", wire.drive.is_some()),
        ("effects", wire.effects.is_some()),
        ("survey", wire.survey.is_some()),
    ];
    for (key, _) in simulated.into_iter().filter(|(_, is_there)| *is_there) {
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
    let cut = if faults.is_empty() { cut(windows) } else { Vec::new() };
    Some(Recording { source: source.to_owned(), format: wire.format.clone(), windows: cut })
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
    for (key, is_there) in [("windows", wire.windows.is_some()), ("format", wire.format.is_some())] {
        if is_there {
            fault(faults, key, format!("{key} belongs to recorded scenarios; this one has a robot"));
        }
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
    let drive = wire.drive.clone().unwrap_or_default();
    drive.check("drive", faults);
    if drive.far_height_px >= drive.near_height_px {
        let (far, near) = (drive.far_height_px, drive.near_height_px);
        fault(faults, "drive.far_height_px", format!("far_height_px must be below near_height_px {near}, not {far}"));
    }
    let aibo = wire.aibo.clone().unwrap_or_default();
    aibo.check("aibo", faults);
    let camera = wire.camera.clone().unwrap_or_default();
    camera.check("camera", faults);
    let start = wire.start.clone().unwrap_or_default();
    start.check("start", faults);
    let field = wire.field.clone().unwrap_or_default();
    field_rules(&field, faults);
    let effects = wire.effects.clone().unwrap_or_default();
    effects_fit(&effects, robot, faults);
    let survey = wire.survey.clone().unwrap_or_default();
    survey_rules(&survey, faults);
    Some(Simulation {
        robot,
        duration_s: duration_s?,
        seeds: seeds.map(|n| n as u32)?,
        first_seed: first_seed.max(0) as u64,
        aibo,
        camera,
        field,
        start,
        drive,
        effects,
        survey,
    })
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
    for about in effects.iter().map(asami_sim::effect::Effect::about) {
        if !about.fits.contains(&robot.name()) {
            let (name, fits, robot) = (about.name, about.fits.join(", "), robot.name());
            fault(faults, &format!("effects.{name}"), format!("{name} fits {fits}, not {robot}"));
        }
    }
}

/// The longest log that a row can be given.
fn longest_s(origin: &Origin) -> f64 {
    match origin {
        Origin::Simulated(simulation) => simulation.duration_s,
        Origin::Recorded(recording) => {
            recording.windows.iter().map(|window| window.length_s).fold(f64::INFINITY, f64::min)
        }
    }
}

fn rows(wire: &Wire, most_s: f64, faults: &mut Vec<Fault>) -> Vec<Row> {
    if wire.rows.is_empty() {
        fault(faults, "rows", "a scenario must have at least one [[rows]]");
    }
    let mut seen = BTreeSet::new();
    let mut rows = Vec::new();
    for (i, row) in wire.rows.iter().enumerate() {
        let path = format!("rows.{i}");
        learner(&path, row, &wire.learners, faults);
        let label = row.label.clone().unwrap_or_else(|| row.learner.clone());
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if row.label.is_some() && (label.is_empty() || !label.chars().all(is_name)) {
            let message = format!("a name in tables is letters, digits and _, not {label:?}");
            fault(faults, &format!("{path}.as"), message);
        }
        let duration_s = row.duration_s.unwrap_or(most_s);
        if row.duration_s.is_some() {
            let range = (DURATION.range.0, most_s);
            faults.extend(out_of_range(&path, &Parameter { range, ..DURATION }, duration_s));
        }
        if !seen.insert((label.clone(), row.start, duration_s.to_bits())) {
            let message =
                format!("row {label} with this start and duration_s stands here twice; tell them apart by `as`");
            fault(faults, &path, message);
        }
        rows.push(Row { learner: row.learner.clone(), label, start: row.start, duration_s, with: row.with.clone() });
    }
    rows
}

/// A row's learner must be there, have the parameters that the row sets, and be given what it needs.
fn learner(path: &str, row: &wire::Row, learners: &Learners, faults: &mut Vec<Fault>) {
    let catalogue = asami_learners::catalogue();
    let Some(about) = catalogue.iter().find(|about| about.name == row.learner) else {
        let names: Vec<_> = catalogue.iter().map(|about| format!("`{}`", about.name)).collect();
        let message = format!("unknown learner `{}`, expected one of {}", row.learner, names.join(", "));
        return fault(faults, &format!("{path}.learner"), message);
    };
    let mut known = row.with.clone();
    for name in row.with.keys().filter(|name| !about.parameters.iter().any(|parameter| parameter.name == **name)) {
        known.remove(name);
        let names: Vec<_> = about.parameters.iter().map(|parameter| format!("`{}`", parameter.name)).collect();
        let message = format!("unknown parameter `{name}` of {}, expected one of {}", about.name, names.join(", "));
        fault(faults, &format!("{path}.with.{name}"), message);
    }
    // Faults of the table itself have been found already: only what this row sets is its own fault.
    if let Err(found) = learners.configured(about.name, &known) {
        let own = found.into_iter().filter(|fault| known.keys().any(|name| fault.path.ends_with(&format!(".{name}"))));
        let place = format!("learners.{}", about.name);
        faults
            .extend(own.map(|fault| Fault { path: fault.path.replacen(&place, &format!("{path}.with"), 1), ..fault }));
    }
    let start = row.start.map_or("none", Start::name);
    let (fits, needs) = match about.needs {
        Needs::Nothing => (row.start.is_none(), "no start"),
        Needs::Action => {
            (row.start.is_some_and(Start::is_action_model), "start = \"c\", \"sgn\", \"one\" or \"reference_quartic\"")
        }
        Needs::Sensor => (row.start == Some(Start::ReferenceCubic), "start = \"reference_cubic\""),
        Needs::Both => (false, "starting models of both kinds"),
    };
    if !fits {
        let message = format!("learner {} takes {needs}, not {start}", about.name);
        fault(faults, &format!("{path}.{}", if row.start.is_some() { "start" } else { "learner" }), message);
    }
}

/// An expectation must be about rows that there are.
fn expectation(i: usize, expect: &Expect, rows: &[Row], faults: &mut Vec<Fault>) {
    let path = format!("expect.{i}");
    about_one_row(&path, expect, rows, faults);
    let shares =
        [("converged_share_min", expect.converged_share_min), ("converged_share_max", expect.converged_share_max)];
    for (name, share) in shares {
        if let Some(share) = share {
            faults.extend(out_of_range(&path, &number(name, "1", (0.0, 1.0)), share));
        }
    }
    let ratios =
        [("sensor_to_floor_max", expect.sensor_to_floor_max), ("action_to_floor_max", expect.action_to_floor_max)];
    for (name, ratio) in ratios {
        if let Some(ratio) = ratio {
            faults.extend(out_of_range(&path, &number(name, "1", (1.0, 1000.0)), ratio));
        }
    }
    if let Some(beaten) = &expect.beats
        && !rows.iter().any(|row| row.label == *beaten)
    {
        fault(faults, &format!("{path}.beats"), format!("no row is called {beaten:?}"));
    }
}

/// By learner, then by start, then by duration: the first that no row fits is at fault.
fn about_one_row(path: &str, expect: &Expect, rows: &[Row], faults: &mut Vec<Fault>) {
    let name = |start: Option<Start>| start.map_or("no start", Start::name);
    let called: Vec<&Row> = rows.iter().filter(|row| row.label == expect.learner).collect();
    let started: Vec<&Row> = called.iter().copied().filter(|row| row.start == expect.start).collect();
    let lasting = started.iter().filter(|row| expect.is_about(row)).count();
    let (key, message) = if called.is_empty() {
        let names: BTreeSet<String> = rows.iter().map(|row| format!("`{}`", row.label)).collect();
        let names = names.into_iter().collect::<Vec<_>>().join(", ");
        ("learner", format!("unknown row `{}`, expected one of {names}", expect.learner))
    } else if started.is_empty() {
        let starts: Vec<_> = called.iter().map(|row| name(row.start)).collect();
        let (start, starts) = (name(expect.start), starts.join(", "));
        let key = if expect.start.is_some() { "start" } else { "learner" };
        (key, format!("start must be that of a row called {} ({starts}), not {start}", expect.learner))
    } else if lasting != 1 {
        let durations: Vec<_> = started.iter().map(|row| row.duration_s.to_string()).collect();
        let durations = durations.join(", ");
        let found = expect.duration_s.map_or_else(|| "left out".to_owned(), |duration_s| duration_s.to_string());
        let key = if expect.duration_s.is_some() { "duration_s" } else { "learner" };
        (key, format!("duration_s must be that of one such row ({durations} s), not {found}"))
    } else {
        return;
    };
    fault(faults, &format!("{path}.{key}"), message);
}

impl Expect {
    /// Whether it is about `row`.
    #[must_use]
    pub fn is_about(&self, row: &Row) -> bool {
        self.learner == row.label
            && self.start == row.start
            && self.duration_s.is_none_or(|duration_s| duration_s == row.duration_s)
    }
}
