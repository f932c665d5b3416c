//! The rules of rows.

use std::collections::BTreeSet;

use asami_dataset::parameters::{Fault, Parameter, out_of_range};
use asami_learners::{Learners, Needs};

use super::super::wire::{self, Wire};
use super::super::{Era, Origin, Row, Start, Study};
use super::{DURATION, fault};

/// The longest part of a log that a row can be given.
fn longest_s(origin: &Origin, era: Era) -> f64 {
    match origin {
        Origin::Simulated(simulation) => match (simulation.change_s(), era) {
            (None, _) => simulation.duration_s,
            (Some(change_s), Era::Before) => change_s,
            (Some(change_s), Era::After) => simulation.duration_s - change_s,
        },
        Origin::Recorded(recording) => {
            recording.windows.iter().map(|window| window.length_s).fold(f64::INFINITY, f64::min)
        }
    }
}

pub(super) fn rows(wire: &Wire, origin: Option<&Origin>, faults: &mut Vec<Fault>) -> Vec<Row> {
    if wire.rows.is_empty() {
        fault(faults, "rows", "a scenario must have at least one [[rows]]");
    }
    let mut seen = BTreeSet::new();
    let mut rows = Vec::new();
    for (i, row) in wire.rows.iter().enumerate() {
        let path = format!("rows.{i}");
        learner(&path, row, &wire.learners, faults);
        let era = era(&path, row, origin, faults);
        let most_s = origin.map_or(f64::INFINITY, |origin| longest_s(origin, era));
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
        for (start, place) in starts(&path, row, faults) {
            takes(&path, row, start, &place, wire.study, faults);
            if !seen.insert((label.clone(), start, era, duration_s.to_bits())) {
                let message =
                    format!("row {label} with this start and duration_s stands here twice; tell them apart by `as`");
                fault(faults, &path, message);
            }
            let (learner, label, with) = (row.learner.clone(), label.clone(), row.with.clone());
            rows.push(Row { learner, label, start, era, duration_s, with });
        }
    }
    rows
}

/// Only a robot that changes has an era after.
fn era(path: &str, row: &wire::Row, origin: Option<&Origin>, faults: &mut Vec<Fault>) -> Era {
    let era = row.era.unwrap_or_default();
    let changes = matches!(origin, Some(Origin::Simulated(simulation)) if simulation.change_s().is_some());
    if era == Era::After && !changes && origin.is_some() {
        fault(
            faults,
            &format!("{path}.era"),
            "there is no era \"after\": the robot does not change ([effects.command_scale] from_s)",
        );
    }
    era
}

/// A row's learner must be there and have the parameters that the row sets.
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
}

/// What a row starts from, each with its place in the file: one row of the table for each.
fn starts(path: &str, row: &wire::Row, faults: &mut Vec<Fault>) -> Vec<(Option<Start>, String)> {
    match (&row.starts, row.start) {
        (None, None) => vec![(None, format!("{path}.learner"))],
        (None, Some(start)) => vec![(Some(start), format!("{path}.start"))],
        (Some(starts), start) => {
            if start.is_some() || starts.is_empty() {
                let message = "a row must have start, or starts with at least one, not both";
                fault(faults, &format!("{path}.starts"), message);
            }
            let place = |(i, start): (usize, &Start)| (Some(*start), format!("{path}.starts.{i}"));
            starts.iter().enumerate().map(place).collect()
        }
    }
}

/// A learner must be for what is studied, and be given what it needs.
fn takes(path: &str, row: &wire::Row, start: Option<Start>, place: &str, study: Study, faults: &mut Vec<Fault>) {
    let catalogue = asami_learners::catalogue();
    let Some(about) = catalogue.iter().find(|about| about.name == row.learner) else { return };
    if (about.needs == Needs::Both) != (study != Study::Line) && about.needs != Needs::Nothing {
        let message = format!("learner {} is not for study \"{}\"", about.name, study.name());
        return fault(faults, &format!("{path}.learner"), message);
    }
    let needs = match about.needs {
        Needs::Nothing => "no start",
        Needs::Action => "start = \"c\", \"sgn\", \"one\" or \"reference_quartic\"",
        Needs::Sensor => "start = \"reference_cubic\"",
        Needs::Both => "start = \"published\" or another of chapter 4's",
    };
    if start.map_or(about.needs != Needs::Nothing, |start| !start.fits(about.needs)) {
        let start = start.map_or("none", Start::name);
        fault(faults, place, format!("learner {} takes {needs}, not {start}", about.name));
    }
}
