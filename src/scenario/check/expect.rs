//! The rules of expected answers.

use std::collections::BTreeSet;

use asami_dataset::parameters::{Fault, out_of_range};

use super::super::{Expect, Row, Start, Study};
use super::{fault, number};

/// An expectation must be about rows that there are.
pub(super) fn expectation(i: usize, expect: &Expect, study: Study, rows: &[Row], faults: &mut Vec<Fault>) {
    let path = format!("expect.{i}");
    of_the_study(&path, expect, study, faults);
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

/// Chapter 3 has keys of its own; medians of chapters 4 and 5 are bounded under the names of their columns.
fn of_the_study(path: &str, expect: &Expect, study: Study, faults: &mut Vec<Fault>) {
    let name = study.name();
    let of_chapter_3 = [
        ("sensor_to_floor_max", expect.sensor_to_floor_max.is_some()),
        ("action_to_floor_max", expect.action_to_floor_max.is_some()),
        ("beats_unlearned", expect.beats_unlearned),
        ("beats", expect.beats.is_some()),
    ];
    for (key, _) in of_chapter_3.iter().filter(|(_, is_there)| *is_there && study != Study::Line) {
        fault(faults, &format!("{path}.{key}"), format!("{key} belongs to study \"line\"; this one's is \"{name}\""));
    }
    for (key, bounds) in [("median_max", &expect.median_max), ("median_min", &expect.median_min)] {
        if !bounds.is_empty() && study == Study::Line {
            let message = format!("{key} belongs to studies \"plane\", \"stride\" and \"car\"; this one's is \"line\"");
            fault(faults, &format!("{path}.{key}"), message);
            continue;
        }
        for (column, bound) in bounds {
            let place = format!("{path}.{key}.{column}");
            if !study.quantities().contains(&column.as_str()) {
                let names: Vec<_> = study.quantities().iter().map(|name| format!("`{name}`")).collect();
                fault(faults, &place, format!("unknown quantity `{column}`, expected one of {}", names.join(", ")));
            }
            if !bound.is_finite() || bound.abs() > 1e6 {
                fault(faults, &place, format!("{column} must lie in -1000000..=1000000, not {bound}"));
            }
        }
    }
}

/// By learner, then by start, then by era and duration: the first that no row fits is at fault.
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
            && self.era == row.era
            && self.duration_s.is_none_or(|duration_s| duration_s == row.duration_s)
    }
}
