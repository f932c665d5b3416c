//! What robots of one make have in common: whoever has logs of several knows of each more than its own log says.
//!
//! A size that is named of three and more is believed to be normally distributed over the make ([`random_effects`]). How unsure
//! each is by its own log is what the diagnosis says of it. Motion capture has no part in it.

use std::collections::BTreeMap;

use asami_dataset::store::number;
use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::Estimate;
use asami_gap::real::prior::error;
use asami_math::random_effects::{Believed, RandomEffects, random_effects};

use super::record::{Part, Record};
use super::walk::Results;
use crate::diagnose::words;
use crate::report::{Cell, RowKind, Table};
use crate::sweep::rows::{optional, push};

/// Columns of `make.csv`; the row without a robot is of the make.
pub const MAKE: &str = "scenario,log,parameter,robot,found,error,of_make,low,high,scatter,capture";

/// A size that is named of several robots of one make.
#[derive(Clone, Debug, PartialEq)]
pub struct Common {
    /// The log's name in the scenario.
    pub log: String,
    /// `NAME.PARAM`.
    pub parameter: String,
    /// What is believed of the make, and of each robot.
    pub believed: RandomEffects,
    /// The robots.
    pub robots: Vec<Of>,
}

/// One robot's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Of {
    /// Which.
    pub robot: u16,
    /// As its own log has it.
    pub found: f64,
    /// How unsure that is, as a standard deviation.
    pub error: f64,
    /// What motion capture shows.
    pub capture: Option<f64>,
}

/// Sizes of a part of a log; wheels do not go sideways.
fn sizes(record: &Record) -> BTreeMap<&str, &Estimate> {
    let named = record.diagnosis.as_ref().and_then(Diagnosis::said).map(|cause| &cause.parameters);
    let named = named.into_iter().flatten().filter(|(name, _)| *name != "command_scale.x_ratio");
    named.map(|(name, estimate)| (name.as_str(), estimate)).collect()
}

/// Of each recording of several robots what those have in common.
#[must_use]
pub fn common(results: &Results) -> Vec<Common> {
    results.real.asked.logs.iter().flat_map(|source| of_one_make(&source.name, &results.records)).collect()
}

fn of_one_make(log: &str, records: &[Record]) -> Vec<Common> {
    let records: Vec<&Record> = records.iter().filter(|it| it.log == log && it.robot.is_some()).collect();
    let mut named: BTreeMap<&str, Vec<Of>> = BTreeMap::new();
    for record in records.iter().filter(|it| it.part == Part::Whole) {
        for (name, estimate) in sizes(record) {
            named.entry(name).or_default().extend(record.robot.map(|robot| Of {
                robot,
                found: estimate.value,
                error: error(estimate),
                capture: record.capture.get(name).copied(),
            }));
        }
    }
    let believed = |(name, robots): (&str, Vec<Of>)| {
        let values: Vec<f64> = robots.iter().map(|it| it.found).collect();
        let errors: Vec<f64> = robots.iter().map(|it| it.error).collect();
        let believed = random_effects(&values, &errors)?;
        Some(Common { log: log.to_owned(), parameter: name.to_owned(), believed, robots })
    };
    named.into_iter().filter_map(believed).collect()
}

/// `make.csv`.
#[must_use]
pub fn csv(scenario: &str, all: &[Common]) -> String {
    let mut text = format!("{MAKE}\n");
    for it in all {
        let head = |robot: String| vec![scenario.to_owned(), it.log.clone(), it.parameter.clone(), robot];
        let ends = |of: &Believed| [of.mean, of.interval[0], of.interval[1]].map(number);
        let mut row = head(String::new());
        row.extend([String::new(), String::new()]);
        row.extend(ends(&it.believed.mean));
        row.extend([number(it.believed.scatter), String::new()]);
        push(&mut text, &row);
        for (of, believed) in it.robots.iter().zip(&it.believed.each) {
            let mut row = head(of.robot.to_string());
            row.extend([number(of.found), number(of.error)]);
            row.extend(ends(believed));
            row.extend([String::new(), optional(of.capture)]);
            push(&mut text, &row);
        }
    }
    text
}

/// A row for each robot, and one for the make.
#[must_use]
pub fn table(all: &[Common]) -> Table {
    let heads =
        ["log", "parameter", "unit", "robot", "by its own log", "among its make", "90 % interval", "motion capture"];
    let mut table = Table::new("Robots of one make", &heads).caption(
        "A size that is named of three robots of one make and more is believed to be normally distributed over the make, whose mean \
         and scatter are unknown beforehand; how unsure each is by its own log is what its diagnosis says. The make's row has its mean, and what robots scatter by besides errors. \
         Motion capture has no part in it.",
    );
    for it in all {
        let size = |value: f64| words::size(&it.parameter, value);
        let row = |robot: Cell, own: String, of: &Believed, capture: Option<f64>| -> [Cell; 8] {
            let [low, high] = of.interval.map(size);
            [
                it.log.clone().into(),
                it.parameter.clone().into(),
                words::unit(&it.parameter).unwrap_or_default().into(),
                robot,
                own.into(),
                size(of.mean).into(),
                format!("{low} to {high}").into(),
                capture.map_or_else(Cell::default, |it| size(it).into()),
            ]
        };
        for (of, believed) in it.robots.iter().zip(&it.believed.each) {
            let own = format!("{} ± {}", size(of.found), words::digits(of.error));
            table = table.row(RowKind::Ours, row(Cell::number(f64::from(of.robot), 0), own, believed, of.capture));
        }
        let scatter = format!("± {}", words::digits(it.believed.scatter));
        table = table.row(RowKind::Ours, row("all".into(), scatter, &it.believed.mean, None));
    }
    table
}

#[cfg(test)]
mod tests {
    use asami_gap::answer::diagnosis::Cause;

    use super::*;
    use crate::sweep::Timing;

    fn record(robot: u16, part: Part, value: f64, error: f64) -> Record {
        // From end to end of its middle 90 % a Gaussian has 3.29 standard deviations.
        let half = 0.5 * 3.29 * error;
        let estimate = Estimate { value, interval: [value - half, value + half], at_end: false };
        let parameters = BTreeMap::from([("turn_slowing.loss_s2".to_owned(), estimate)]);
        let named =
            Cause { effects: vec!["turn_slowing".to_owned()], parameters, ..Diagnosis::flat(&[]).which[0].clone() };
        Record {
            log: "creates".to_owned(),
            robot: Some(robot),
            part,
            among: false,
            diagnosis: Some(Diagnosis { which: vec![named], ..Diagnosis::flat(&[]) }),
            capture: BTreeMap::from([("turn_slowing.loss_s2".to_owned(), 2.8)]),
            capture_errors: BTreeMap::new(),
            shares: Vec::new(),
            checked: None,
            error: String::new(),
            timing: Timing::default(),
        }
    }

    fn robots(values: &[f64], error: f64) -> Vec<Record> {
        let of = |(i, value): (usize, &f64)| record(i as u16 + 1, Part::Whole, *value, error);
        values.iter().enumerate().map(of).collect()
    }

    /// Robots that differ by less than each is unsure are of one size; those that differ by ten times as much each have their own.
    #[test]
    fn robots_are_drawn_to_their_make_as_far_as_their_logs_are_unsure() {
        let found = of_one_make("creates", &robots(&[2.4, 2.8, 3.0, 2.9], 0.4));
        let [it] = &found[..] else { panic!("one parameter, not {found:?}") };
        let [first, .., last] = &it.believed.each[..] else { panic!("four robots") };
        assert!((2.55..2.8).contains(&first.mean) && (2.8..2.9).contains(&last.mean), "{first:?} {last:?}");
        assert!(first.interval[1] - first.interval[0] < 0.8 * 3.29 * 0.4, "{first:?}");
        let found = of_one_make("creates", &robots(&[1.0, 2.8, 5.0, 3.9], 0.1));
        assert!((found[0].believed.each[0].mean - 1.0).abs() < 0.02, "{found:?}");
        // Of two nobody knows how a make scatters.
        assert!(of_one_make("creates", &robots(&[2.4, 2.8], 0.4)).is_empty());
        assert!(of_one_make("others", &robots(&[2.4, 2.8, 3.0], 0.4)).is_empty());
    }

    /// The make's row, and one for each robot, with as many columns.
    #[test]
    fn a_row_each_is_written() {
        let found = of_one_make("creates", &robots(&[2.4, 2.8, 3.0], 0.1));
        assert!(found[0].robots.iter().all(|it| (it.error - 0.1).abs() < 1e-9), "{found:?}");
        let text = csv("real", &found);
        assert_eq!(text.lines().count(), 1 + 1 + 3);
        let columns = MAKE.split(',').count();
        assert!(text.lines().all(|line| line.split(',').count() == columns), "{text}");
    }
}
