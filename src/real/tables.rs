//! What is written of real logs: `trials.csv`, `parameters.csv`, the table `real`, diagnoses, the report.

use std::path::Path;

use asami_dataset::store::number;
use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::{Cause, Unsettled};

use super::among;
use super::foretold;
use super::make;
use super::record::{Part, Record};
use super::scanner;
use super::walk::Results;
use crate::diagnose::words;
use crate::report::sweep::made_with;
use crate::report::{Cell, Report, RowKind, Section, Table};
use crate::sweep::cases::write_whole;
use crate::sweep::rows::{optional, push};
use crate::sweep::{CannotSweep, Finished, manifest};

/// Columns of `trials.csv`.
pub const TRIALS: &str = "scenario,log,robot,part,verdict,effects_named,probability,unknown,unknown_block,excess_before,\
                          excess_after,closed,closed_low,closed_high,halves_agree,main_of_motion,error,unsettled,\
                          halves_differ";

/// Columns of `parameters.csv`.
pub const PARAMETERS: &str = "scenario,log,robot,part,parameter,value,low,high,capture,capture_error";

/// Writes every file under `out`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(results: &Results, program: &str, out: &Path) -> Result<Finished, CannotSweep> {
    let write = |name: &str, text: &str| write_whole(&out.join(name), text.as_bytes());
    write("trials.csv", &trials(results, &results.records))?;
    write("parameters.csv", &parameters(results, &results.records))?;
    write("timings.csv", &timings(results))?;
    let records = &results.records;
    let mut tables = vec![("real", logs(records)), ("real_parameters", held(records))];
    if !results.among.is_empty() {
        write("among.csv", &trials(results, &results.among))?;
        write("among_parameters.csv", &parameters(results, &results.among))?;
        tables.push(("real_among", among::table(&results.among)));
    }
    let common = make::common(results);
    if !common.is_empty() {
        write("make.csv", &make::csv(&results.real.name, &common))?;
        tables.push(("real_make", make::table(&common)));
    }
    let foretold = foretold::foretold(&results.lessons);
    if !foretold.is_empty() {
        write("learning.csv", &foretold::csv(&results.real.name, &foretold))?;
        tables.push(("real_learning", foretold::table(&foretold)));
    }
    tables.extend(scanner::table(results).map(|table| ("real_scanners", table)));
    for (name, table) in &tables {
        write(&format!("{name}.csv"), &table.csv())?;
        write(&format!("{name}.md"), &table.markdown())?;
    }
    let folder = out.join("diagnoses");
    std::fs::create_dir_all(&folder).map_err(CannotSweep::file("make", &folder))?;
    let all: Vec<&Record> = records.iter().chain(&results.among).collect();
    for (record, diagnosis) in all.iter().filter_map(|it| Some((it, it.diagnosis.as_ref()?))) {
        let path = folder.join(format!("{}.json", record.name()));
        let text = serde_json::to_string_pretty(diagnosis).map_err(std::io::Error::other);
        write_whole(&path, (text.map_err(CannotSweep::file("serialise", &path))? + "\n").as_bytes())?;
    }
    let (name, about) = (&results.real.name, &results.real.asked.about);
    let counts = (all.len(), all.len());
    let manifest = manifest::of((name, results.real.hash()), counts, program);
    manifest.write(out)?;
    let mut report = Report::new(name, about);
    for (_, table) in &tables {
        report = report.section(Section::new(&table.name).table(table.clone()));
    }
    for record in &all {
        let said = record.diagnosis.as_ref().map_or_else(|| record.error.clone(), words::text);
        report = report.section(Section::new(&record.name()).folded().lines(said));
    }
    made_with(report, &manifest)
        .write(&out.join("report.html"))
        .map_err(|error| CannotSweep::file("write", &error.path)(error.source))?;
    let shown: String = tables.iter().map(|(_, table)| format!("\n{}", table.markdown())).collect();
    let broken = all.iter().filter(|record| !record.error.is_empty());
    let errors: String = broken.map(|record| format!("\nERROR: {}: {}", record.name(), record.error)).collect();
    Ok(Finished { text: format!("{about}\n{shown}{errors}\n"), has_errors: !errors.is_empty() })
}

fn unknown(diagnosis: &Diagnosis) -> Option<&Cause> {
    diagnosis.which.iter().find(|cause| cause.effects.iter().any(|it| it == "unknown"))
}

/// The record of a part of the log that a record is of.
fn of_part<'a>(records: &'a [Record], record: &Record, part: Part) -> Option<&'a Record> {
    records.iter().find(|it| it.log == record.log && it.robot == record.robot && it.part == part)
}

/// The same verdict in both halves, with the same first effect.
fn halves_agree(records: &[Record], record: &Record) -> Option<bool> {
    let half = |part: Part| {
        let found = of_part(records, record, part)?.diagnosis.as_ref()?;
        Some((found.verdict, found.said().and_then(|cause| cause.effects.first())))
    };
    (record.part == Part::Whole).then_some(())?;
    Some(half(Part::FirstHalf)? == half(Part::SecondHalf)?)
}

fn head(results: &Results, record: &Record) -> Vec<String> {
    let robot = record.robot.map_or_else(String::new, |robot| robot.to_string());
    vec![results.real.name.clone(), record.log.clone(), robot, record.part.name().to_owned()]
}

fn trials(results: &Results, records: &[Record]) -> String {
    let mut text = format!("{TRIALS}\n");
    for record in records {
        let diagnosis = record.diagnosis.as_ref();
        let cause = diagnosis.and_then(Diagnosis::said);
        let rest = diagnosis.and_then(unknown);
        let far = diagnosis.map(|it| &it.how_far);
        let interval = far.and_then(|it| it.interval);
        let mut row = head(results, record);
        row.extend([
            diagnosis.map_or_else(String::new, |it| it.verdict.name().to_owned()),
            cause.map_or_else(String::new, |it| it.effects.join("+")),
            optional(cause.map(|it| it.probability)),
            optional(rest.map(|it| it.probability)),
            rest.and_then(|it| it.block.clone()).unwrap_or_default(),
            optional(far.map(|it| it.excess_before)),
            optional(far.map(|it| it.excess_after)),
            optional(far.and_then(|it| it.closed)),
            optional(interval.map(|it| it[0])),
            optional(interval.map(|it| it[1])),
            halves_agree(records, record).map_or_else(String::new, |it| it.to_string()),
            record.shares.first().map_or_else(String::new, |(name, _)| name.clone()),
            record.error.clone(),
            diagnosis.map(|it| unsettled(it, "|").join("+")).unwrap_or_default(),
            optional(diagnosis.and_then(|it| it.halves_differ)),
        ]);
        push(&mut text, &row);
    }
    text
}

/// Small parts of the gap of which it is not settled what they are, each as what it may be.
fn unsettled(diagnosis: &Diagnosis, or: &str) -> Vec<String> {
    let one_of = |it: &Unsettled| it.one_of.iter().map(|it| it.effect.as_str()).collect::<Vec<_>>().join(or);
    diagnosis.unsettled.iter().map(one_of).collect()
}

/// What is named, and in brackets what is not settled.
pub(super) fn effects(diagnosis: &Diagnosis, cause: &Cause) -> String {
    let small = unsettled(diagnosis, " or ").into_iter().map(|it| format!("({it})"));
    cause.effects.iter().cloned().chain(small).collect::<Vec<_>>().join(", ")
}

fn parameters(results: &Results, records: &[Record]) -> String {
    let mut text = format!("{PARAMETERS}\n");
    for record in records {
        let named = record.diagnosis.as_ref().and_then(Diagnosis::said).map(|cause| &cause.parameters);
        for (parameter, estimate) in named.into_iter().flatten() {
            let [low, high] = estimate.interval;
            let mut row = head(results, record);
            row.extend([parameter.clone(), number(estimate.value), number(low), number(high)]);
            row.extend([&record.capture, &record.capture_errors].map(|of| optional(of.get(parameter).copied())));
            push(&mut text, &row);
        }
    }
    text
}

fn timings(results: &Results) -> String {
    let mut text = String::from("scenario,log,robot,part,diagnosis_s\n");
    for record in &results.records {
        let mut row = head(results, record);
        row.push(number(record.timing.trials_s.iter().sum()));
        push(&mut text, &row);
    }
    text
}

pub(super) fn robot(record: &Record) -> Cell {
    record.robot.map_or_else(Cell::default, |robot| Cell::number(f64::from(robot), 0))
}

/// What motion capture shows of a parameter, and how far off that may be; empty where it does not.
pub(super) fn by_capture(record: &Record, parameter: &str) -> String {
    let Some(value) = record.capture.get(parameter) else { return String::new() };
    let error = record.capture_errors.get(parameter).map(|it| format!(" ± {}", words::digits(*it)));
    format!("{}{}", words::size(parameter, *value), error.unwrap_or_default())
}

/// Whether halves agree.
pub(super) fn agreed(records: &[Record], record: &Record) -> Cell {
    halves_agree(records, record).map_or("", |it| if it { "yes" } else { "no" }).into()
}

/// A row of so many cells, of a log of which nothing can be said.
pub(super) fn failed(record: &Record, cells: usize) -> Vec<Cell> {
    let mut row = vec![record.log.clone().into(), robot(record), "error".into(), record.error.clone().into()];
    row.resize_with(cells, Cell::default);
    row
}

/// One row for each log, with what is named and how far it goes.
fn logs(records: &[Record]) -> Table {
    let heads = [
        "log",
        "robot",
        "verdict",
        "effects",
        "closed",
        "95 % interval",
        "unknown",
        "halves agree",
        "off most by capture",
        "halves differ",
    ];
    let mut table = Table::new("Real logs", &heads).caption(
        "Effects in the order in which they are named, the most evident first; in brackets a small part of the gap of which the log \
         does not settle which of these it is. Closed: the share of the gap, on held-out blocks, \
         that they close; unknown: the share that remains, and the flexible block that it shows in. By motion capture, or of a car by \
         inertial navigation: the discrepancy of motion that by itself explains most (scale of speeds, slowing in turns, speed won in slight \
         ones, bend of straight lines, delay, lag; offset, ratio and lag of a steering), and its share. \
         Halves agree that have the same verdict and the same most evident effect. Halves differ: by how many times as much as they are \
         said to sizes differ between halves of the recording's logs, no less than 1, where each half is diagnosed by itself and as it \
         speaks; what a whole log says counts as much less as the square of that is more (a \
         variance inflation factor; Burnham and Anderson 2002).",
    );
    for record in records.iter().filter(|record| record.part == Part::Whole) {
        let Some(diagnosis) = &record.diagnosis else {
            table = table.row(RowKind::Ours, failed(record, heads.len()));
            continue;
        };
        let far = &diagnosis.how_far;
        let interval = far.interval.map_or_else(String::new, |[low, high]| format!("{low:.2} to {high:.2}"));
        let rest = unknown(diagnosis);
        let remains = rest.map_or_else(String::new, |it| {
            let block = it.block.as_deref().unwrap_or_default().replace('_', " ");
            if it.probability < 0.005 { "0".to_owned() } else { format!("{:.2}, {block}", it.probability) }
        });
        let main = record.shares.first().map_or_else(String::new, |(name, share)| format!("{name} ({share:.2})"));
        table = table.row(
            RowKind::Ours,
            [
                record.log.clone().into(),
                robot(record),
                diagnosis.verdict.name().into(),
                diagnosis.said().map_or_else(String::new, |it| effects(diagnosis, it)).into(),
                far.closed.map_or_else(Cell::default, |closed| Cell::number(closed, 2)),
                interval.into(),
                remains.into(),
                agreed(records, record),
                main.into(),
                diagnosis.halves_differ.map_or_else(Cell::default, |it| Cell::number(it, 2)),
            ],
        );
    }
    table
}

/// Every parameter that was found beside what motion capture shows.
fn held(records: &[Record]) -> Table {
    let heads =
        ["log", "robot", "parameter", "unit", "found", "90 % interval", "motion capture", "first half", "second half"];
    let mut table = Table::new("Sizes found in real logs, beside motion capture", &heads).caption(
        "Motion capture's numbers are of all discrepancies together, but where of a delay and a lag, or of a focal length and a lens, \
         one is named that one alone, and where no scale of commands is named, what is lost in turns is of a robot without one; a scale of \
         commands is one of turns, too, and a wheel base beside it what that leaves of them; a lag is on top of the nominal robot's own, a \
         scale of ranges beside a focal length what that leaves of it. Capture has a clock and a heading of its own: what a camera is late, or turned \
         against the way that the robot goes, a log alone cannot tell from motors that are late, or from nothing; what ranges and a scanner's \
         angles are off is counted beside what they are late. What wheels do in proportion to what they are told is of stretches in which the same \
         is told for long, any slight turns for one, where there are enough: what is told for less than a robot's own clock lasts as long as that has it; late starts are of single \
         rests, by commands as they were given. ±: standard errors, by leaving a tenth of the time out in turn.",
    );
    for record in records.iter().filter(|record| record.part == Part::Whole) {
        let Some(cause) = record.diagnosis.as_ref().and_then(Diagnosis::said) else { continue };
        // Wheels do not go sideways.
        for (parameter, estimate) in cause.parameters.iter().filter(|(name, _)| *name != "command_scale.x_ratio") {
            let half = |part: Part| {
                let cause = of_part(records, record, part)?.diagnosis.as_ref().and_then(Diagnosis::said)?;
                cause.parameters.get(parameter).map(|it| it.value)
            };
            let shown =
                |value: Option<f64>| value.map_or_else(Cell::default, |value| words::size(parameter, value).into());
            let [low, high] = estimate.interval;
            table = table.row(
                RowKind::Ours,
                [
                    record.log.clone().into(),
                    robot(record),
                    parameter.clone().into(),
                    words::unit(parameter).unwrap_or_default().into(),
                    words::size(parameter, estimate.value).into(),
                    format!("{} to {}", words::size(parameter, low), words::size(parameter, high)).into(),
                    by_capture(record, parameter).into(),
                    shown(half(Part::FirstHalf)),
                    shown(half(Part::SecondHalf)),
                ],
            );
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use asami_gap::answer::diagnosis::Suspect;

    use super::*;

    /// What is not settled stands in brackets after what is named, and is nothing that is named.
    #[test]
    fn what_is_not_settled_is_in_brackets() {
        let suspect = |effect: &str| Suspect { effect: effect.to_owned(), probability: 0.45 };
        let one_of = ["wheel_base", "unequal_wheels"].map(suspect).to_vec();
        let mut diagnosis = Diagnosis::flat(&[]);
        diagnosis.which[0].effects = vec!["turn_slowing".to_owned(), "wheel_lag".to_owned()];
        let shown = |diagnosis: &Diagnosis| effects(diagnosis, &diagnosis.which[0]);
        assert_eq!(shown(&diagnosis), "turn_slowing, wheel_lag");
        diagnosis.unsettled = vec![Unsettled { one_of, share: 0.004 }];
        assert_eq!(shown(&diagnosis), "turn_slowing, wheel_lag, (wheel_base or unequal_wheels)");
        assert_eq!(unsettled(&diagnosis, "|"), ["wheel_base|unequal_wheels"]);
    }
}
