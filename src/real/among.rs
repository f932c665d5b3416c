//! Robots of one make, each diagnosed again beside what the others' own logs say ([`Kin`]): an effect that others have is named by
//! less evidence, one that none of them has by more, and evidence counts as much less as halves of the others' logs differ by more than
//! they are said to. A robot's own log has no part in what is expected of it, nor has motion capture.

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Estimate};
use asami_gap::real::kin::Kin;
use asami_gap::real::prior::{Prior, halves_differ};

use super::record::{Part, Record};
use super::tables::{agreed, by_capture, effects, failed, robot};
use crate::diagnose::words;
use crate::report::{Cell, RowKind, Table};

/// So many robots are a make.
pub(super) const LEAST: usize = 3;

/// By how many times as much as they are said to halves of these records' logs differ.
fn differ(records: &[&Record]) -> f64 {
    let of = |first: &Record, part: Part| {
        let half = records.iter().find(|it| it.log == first.log && it.robot == first.robot && it.part == part);
        half.and_then(|it| it.diagnosis.as_ref())
    };
    let halves = records.iter().filter(|it| it.part == Part::FirstHalf);
    halves_differ(halves.filter_map(|it| Some([of(it, Part::FirstHalf)?, of(it, Part::SecondHalf)?])))
}

/// How far the logs of a recording are to be believed, by their halves, each of which was by itself.
#[must_use]
pub fn as_halves_differ(halves: &[Record], log: &str) -> Prior {
    let of_log: Vec<&Record> = halves.iter().filter(|it| it.log == log).collect();
    Prior::NONE.whose_halves_differ(differ(&of_log))
}

/// What the whole logs of the other robots of a recording say, and how far logs are to be believed by halves of theirs; `None` where
/// they are no make.
#[must_use]
pub fn beside_make(records: &[Record], halves: &[Record], log: &str, robot: Option<u16>) -> Option<Prior> {
    let of_make = records.iter().filter(|it| it.log == log && it.robot.is_some() && it.part == Part::Whole);
    let of_make: Vec<(Option<u16>, &Diagnosis)> =
        of_make.filter_map(|it| Some((it.robot, it.diagnosis.as_ref()?))).collect();
    let others = of_make.iter().filter(|it| it.0 != robot).map(|it| it.1);
    let theirs: Vec<&Record> = halves.iter().filter(|it| it.log == log && it.robot != robot).collect();
    let prior = |kin: Kin| Prior { kin, ..Prior::NONE }.whose_halves_differ(differ(&theirs));
    (of_make.len() >= LEAST && robot.is_some()).then(|| prior(Kin::of(others)))
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
        let cause = diagnosis.said();
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

    /// What a robot's own log and its halves say is not among what is expected of it, nor is what halves of others' logs name.
    #[test]
    fn a_robot_is_none_of_its_kin() {
        let whole = |robot: u16, effects: &[&str]| record(robot, Part::Whole, effects);
        let mut records = vec![whole(1, &["turn_slowing", "pan_offset"]), whole(2, &["turn_slowing"])];
        let mut halves: Vec<Record> =
            [1, 2, 3].iter().flat_map(|it| Part::HALVES.map(|part| record(*it, part, &["pan_offset"]))).collect();
        assert_eq!(beside_make(&records, &halves, "creates", Some(1)), None, "two are no make");
        records.push(whole(3, &["turn_slowing"]));
        let others = [&records[1], &records[2]].map(|it| it.diagnosis.as_ref().unwrap());
        let of = |halves: &[Record], robot: u16| beside_make(&records, halves, "creates", Some(robot)).unwrap();
        assert_eq!(of(&halves, 1), Prior { kin: Kin::of(others), ..Prior::NONE });
        assert_eq!(beside_make(&records, &halves, "tubes", None), None);
        // Halves of another robot that differ by 1.5, where each is said to be unsure of 1 from end to end of nine tenths; those of
        // the third do not differ.
        let cause = &mut halves[3].diagnosis.as_mut().unwrap().which[0];
        cause.parameters.get_mut("turn_slowing.loss_s2").unwrap().value += 1.5;
        let differ = (1.5 * 3.29_f64).powi(2) / 2.0;
        assert!((of(&halves, 1).halves_differ.powi(2) - differ / 2.0).abs() < 1e-9, "{differ}");
        assert_eq!(of(&halves, 2), Prior { kin: of(&halves, 2).kin, ..Prior::NONE }, "its own do not count");
        let all = as_halves_differ(&halves, "creates");
        assert!(all.kin == Kin::NONE && (all.halves_differ.powi(2) - differ / 3.0).abs() < 1e-9, "{all:?}");
        assert_eq!(as_halves_differ(&halves, "tubes"), Prior::NONE);
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
