//! Robots of one make, each diagnosed again beside what the others' own logs say ([`Kin`]): an effect that others have is named by
//! less evidence, one that none of them has by more, and evidence counts as much less as halves of the others' logs differ by more than
//! they are said to. A robot's own log has no part in what is expected of it, nor has motion capture.

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Estimate};
use asami_gap::real::kin::Kin;

use super::make::wider;
use super::tables::{agreed, by_capture, effects, failed, robot, said};
use super::walk::{Part, Record};
use crate::diagnose::words;
use crate::report::{Cell, RowKind, Table};

/// So many robots are a make.
pub(super) const LEAST: usize = 3;

/// What the whole logs of the other robots of a recording say; `None` where they are no make.
#[must_use]
pub fn kin(records: &[Record], log: &str, robot: Option<u16>) -> Option<Kin> {
    let of_make = records.iter().filter(|it| it.log == log && it.robot.is_some() && it.part == Part::Whole);
    let of_make: Vec<(Option<u16>, &Diagnosis)> =
        of_make.filter_map(|it| Some((it.robot, it.diagnosis.as_ref()?))).collect();
    let others = of_make.iter().filter(|it| it.0 != robot).map(|it| it.1);
    let theirs: Vec<&Record> =
        records.iter().filter(|it| it.log == log && it.robot.is_some() && it.robot != robot).collect();
    (of_make.len() >= LEAST && robot.is_some()).then(|| Kin::of(others).whose_halves_differ(wider(&theirs)))
}

/// Of what is named, that which explains most of what motion is off by motion capture, and its size.
fn main<'a>(record: &Record, cause: &'a Cause) -> Option<(&'static str, &'a Estimate)> {
    let brings_about = |(name, _): &(String, f64)| match name.as_str() {
        "scale" => Some("command_scale.y_ratio"),
        "slowing" => Some("turn_slowing.loss_s2"),
        "slight turns" => Some("slight_turns.gain_share"),
        "bend" => Some("unequal_wheels.ratio"),
        "delay" => Some("command_delay.delay_s"),
        "lag" => Some("wheel_lag.lag_s"),
        _ => None,
    };
    let named = |name: &'static str| Some((name, cause.parameters.get(name)?));
    record.shares.iter().filter_map(brings_about).find_map(named)
}

/// A row for each robot; and of what parts it most from the nominal world by motion capture, how large it is.
#[must_use]
pub fn table(records: &[Record]) -> Table {
    let heads = [
        "log",
        "robot",
        "verdict",
        "effects",
        "closed",
        "halves agree",
        "off most",
        "found",
        "90 % interval",
        "motion capture",
    ];
    let mut table = Table::new("Real robots among their make", &heads).caption(
        "The same logs, each robot's beside what the whole logs of the others say: beforehand an effect is as probable as it is \
         common among them (a beta distribution; by itself ten to one are against it, which counts as much as one robot), and what a \
         log says counts as much less as halves of the others' differ by more than they are said to. In \
         brackets: small parts that are not settled. Off most: of the effects of motion that are named that which motion \
         capture says explains most by itself.",
    );
    for record in records.iter().filter(|it| it.part == Part::Whole) {
        let Some(diagnosis) = &record.diagnosis else {
            table = table.row(RowKind::Ours, failed(record, heads.len()));
            continue;
        };
        let cause = said(diagnosis);
        let main = cause.and_then(|cause| main(record, cause));
        let size = |(name, _): (&str, &Estimate), value: f64| words::size(name, value);
        let shown =
            |value: Option<f64>| main.zip(value).map_or_else(Cell::default, |(main, value)| size(main, value).into());
        let interval = main.map_or_else(String::new, |main| {
            let [low, high] = main.1.interval.map(|end| size(main, end));
            format!("{low} to {high}")
        });
        table = table.row(
            RowKind::Ours,
            [
                record.log.clone().into(),
                robot(record),
                diagnosis.verdict.name().into(),
                cause.map_or_else(String::new, |it| effects(diagnosis, it)).into(),
                diagnosis.how_far.closed.map_or_else(Cell::default, |closed| Cell::number(closed, 2)),
                agreed(records, record),
                main.map_or_else(String::new, |(name, _)| name.to_owned()).into(),
                shown(main.map(|(_, it)| it.value)),
                interval.into(),
                main.map_or_else(String::new, |(name, _)| by_capture(record, name)).into(),
            ],
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::sweep::Timing;

    /// Robot `robot` of which these are named, slowing by 2.5.
    fn record(robot: u16, part: Part, effects: &[&str]) -> Record {
        let nothing = Diagnosis::flat(&[]);
        let estimate = Estimate { value: 2.5, interval: [2.0, 3.0], at_end: false };
        let named = Cause {
            effects: effects.iter().map(|it| (*it).to_owned()).collect(),
            parameters: BTreeMap::from([("turn_slowing.loss_s2".to_owned(), estimate)]),
            probability: 1.0,
            ..nothing.which[0].clone()
        };
        Record {
            log: "creates".to_owned(),
            robot: Some(robot),
            part,
            among: true,
            diagnosis: Some(Diagnosis { which: vec![named], ..nothing }),
            capture: BTreeMap::from([("turn_slowing.loss_s2".to_owned(), 2.8)]),
            capture_errors: BTreeMap::from([("turn_slowing.loss_s2".to_owned(), 0.0456)]),
            shares: vec![("lag".to_owned(), 0.6), ("slowing".to_owned(), 0.5)],
            checked: None,
            error: String::new(),
            timing: Timing::default(),
        }
    }

    /// What a robot's own log says, and what halves of the others' do, is not among what is expected of it.
    #[test]
    fn a_robot_is_none_of_its_kin() {
        let mut records = vec![
            record(1, Part::Whole, &["turn_slowing", "pan_offset"]),
            record(1, Part::FirstHalf, &["turn_slowing"]),
            record(2, Part::Whole, &["turn_slowing"]),
            record(2, Part::FirstHalf, &["turn_slowing", "pan_offset"]),
        ];
        assert_eq!(kin(&records, "creates", Some(1)), None, "two are no make");
        records.push(record(3, Part::Whole, &["turn_slowing"]));
        let others = [&records[2], &records[4]].map(|it| it.diagnosis.as_ref().unwrap());
        assert_eq!(kin(&records, "creates", Some(1)), Some(Kin::of(others)));
        assert_eq!(kin(&records, "tubes", None), None);
        assert_eq!(kin(&records, "creates", Some(1)).map(|it| it.counts()), Some(1.0));
        // Halves of another robot that differ by 1.5, where each is said to be unsure of 1 from end to end of nine tenths.
        records.push(record(2, Part::SecondHalf, &["turn_slowing"]));
        let estimate = |record: &mut Record| {
            let cause = &mut record.diagnosis.as_mut().unwrap().which[0];
            cause.parameters.get_mut("turn_slowing.loss_s2").unwrap().value += 1.5;
        };
        estimate(records.last_mut().unwrap());
        let counts = kin(&records, "creates", Some(1)).map(|it| it.counts()).unwrap();
        assert!((counts - 2.0 / (1.5 * 3.29_f64).powi(2)).abs() < 1e-9, "{counts}");
        assert_eq!(kin(&records, "creates", Some(2)).map(|it| it.counts()), Some(1.0), "its own do not count");
    }

    /// Of what is named the effect that capture says explains most: slowing, where no lag is named.
    #[test]
    fn each_robot_has_a_row_with_what_it_is_off_most_by() {
        let (named, capture) = (&["turn_slowing"][..], "2.80 ± 0.0456");
        let records = [Part::Whole, Part::FirstHalf, Part::SecondHalf].map(|part| record(4, part, named));
        let text = table(&records).markdown();
        let row = text.lines().last().unwrap();
        assert_eq!(text.lines().filter(|line| line.contains("creates")).count(), 1, "{text}");
        assert!(row.contains("| yes | turn_slowing.loss_s2 | 2.50 | 2.00 to 3.00 |") && row.contains(capture), "{row}");
        let broken = Record { diagnosis: None, error: "too short".to_owned(), ..records[0].clone() };
        let text = table(&[broken]).markdown();
        assert!(text.lines().last().is_some_and(|row| row.contains("| 4 | error | too short |")), "{text}");
    }
}
