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
            let shortest_s = recording.windows.iter().map(|window| window.length_s).fold(f64::INFINITY, f64::min);
            recording.learned_s.unwrap_or(shortest_s)
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
        let era = era(&path, row, origin, faults);
        let most_s = origin.map_or(f64::INFINITY, |origin| longest_s(origin, era));
        let duration_s = row.duration_s.unwrap_or(most_s);
        if row.duration_s.is_some() {
            let range = (DURATION.range.0, most_s);
            faults.extend(out_of_range(&path, &Parameter { range, ..DURATION }, duration_s));
        }
        let starts = starts(&path, row, faults);
        for (learner, learner_at) in named(&path, row, faults) {
            configured(&path, row, (&learner, &learner_at), &wire.learners, faults);
            let label = row.label.clone().unwrap_or_else(|| learner.clone());
            for (start, start_at) in &starts {
                takes((&learner, &learner_at), *start, start_at.as_deref(), wire.study, faults);
                if !seen.insert((label.clone(), *start, era, duration_s.to_bits())) {
                    let message = format!(
                        "row {label} with this start and duration_s stands here twice; tell them apart by `as`"
                    );
                    fault(faults, &path, message);
                }
                let (learner, label, with) = (learner.clone(), label.clone(), row.with.clone());
                rows.push(Row { learner, label, start: *start, era, duration_s, with });
            }
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

/// A row's learners, each with its place in the file.
fn named(path: &str, row: &wire::Row, faults: &mut Vec<Fault>) -> Vec<(String, String)> {
    let is_name = |label: &str| !label.is_empty() && label.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if let Some(label) = row.label.as_deref().filter(|label| !is_name(label)) {
        let message = format!("a name in tables is letters, digits and _, not {label:?}");
        fault(faults, &format!("{path}.as"), message);
    }
    match (&row.learner, &row.learners) {
        (Some(learner), None) => vec![(learner.clone(), format!("{path}.learner"))],
        (None, Some(learners)) if !learners.is_empty() => {
            if row.label.is_some() && learners.len() > 1 {
                fault(faults, &format!("{path}.as"), "a name in tables is for a row of one learner");
            }
            let place = |(i, learner): (usize, &String)| (learner.clone(), format!("{path}.learners.{i}"));
            learners.iter().enumerate().map(place).collect()
        }
        _ => {
            fault(faults, path, "a row must have learner, or learners with at least one, not both");
            Vec::new()
        }
    }
}

/// A row's learner must be there and have the parameters that the row sets.
fn configured(
    path: &str,
    row: &wire::Row,
    (learner, learner_at): (&str, &str),
    learners: &Learners,
    faults: &mut Vec<Fault>,
) {
    let catalogue = asami_learners::catalogue();
    let Some(about) = catalogue.iter().find(|about| about.name == learner) else {
        let names: Vec<_> = catalogue.iter().map(|about| format!("`{}`", about.name)).collect();
        let message = format!("unknown learner `{learner}`, expected one of {}", names.join(", "));
        return fault(faults, learner_at, message);
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

/// What a row starts from, each with its place in the file if it has one: one row of the table for each.
fn starts(path: &str, row: &wire::Row, faults: &mut Vec<Fault>) -> Vec<(Option<Start>, Option<String>)> {
    match (&row.starts, row.start) {
        (None, None) => vec![(None, None)],
        (None, Some(start)) => vec![(Some(start), Some(format!("{path}.start")))],
        (Some(starts), start) => {
            if start.is_some() || starts.is_empty() {
                let message = "a row must have start, or starts with at least one, not both";
                fault(faults, &format!("{path}.starts"), message);
            }
            let place = |(i, start): (usize, &Start)| (Some(*start), Some(format!("{path}.starts.{i}")));
            starts.iter().enumerate().map(place).collect()
        }
    }
}

/// A learner must be for what is studied, and be given what it needs.
fn takes(
    (learner, learner_at): (&str, &str),
    start: Option<Start>,
    start_at: Option<&str>,
    study: Study,
    faults: &mut Vec<Fault>,
) {
    let catalogue = asami_learners::catalogue();
    let Some(about) = catalogue.iter().find(|about| about.name == learner) else { return };
    let is_for_it = match about.needs {
        Needs::Nothing => study != Study::Car,
        Needs::Action | Needs::Sensor => study == Study::Line,
        Needs::Both => matches!(study, Study::Plane | Study::Stride),
        Needs::Firings => study == Study::Car,
    };
    if !is_for_it {
        let takes = match (about.needs, study) {
            (Needs::Firings, _) => ": it learns from a car's laser firings",
            (_, Study::Car) => ", which learns from a car's laser firings",
            _ => "",
        };
        let message = format!("learner {} is not for study \"{}\"{takes}", about.name, study.name());
        return fault(faults, learner_at, message);
    }
    let needs = match about.needs {
        Needs::Nothing => "no start",
        Needs::Firings => "no start, or start = \"reference_car\" or \"half_car\"",
        Needs::Action => "start = \"c\", \"sgn\", \"one\" or \"reference_quartic\"",
        Needs::Sensor => "start = \"reference_cubic\"",
        Needs::Both => "start = \"published\" or another of chapter 4's",
    };
    if start.map_or(!matches!(about.needs, Needs::Nothing | Needs::Firings), |start| !start.fits(about.needs)) {
        let start = start.map_or("none", Start::name);
        fault(faults, start_at.unwrap_or(learner_at), format!("learner {} takes {needs}, not {start}", about.name));
    }
}
