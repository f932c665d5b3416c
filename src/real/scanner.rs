//! What is said of a real scanner, checked: how thick surfaces are, and how far scan matching errs against inertial navigation, with the
//! table as it was and as it is corrected; wherever there are two halves, on the half that it was not corrected by.

use asami_dataset::{Log, TruePose};
use asami_gap::real::scanner::agrees::Agreement;
use asami_gap::real::scanner::corrected;
use asami_gap::real::scanner::lasers::Laser;
use serde::{Deserialize, Serialize};

use super::record::{Part, Record};
use super::walk::Results;
use crate::report::{Cell, RowKind, Table};
use crate::scorer::car::moved;

/// A scanner's measures with one table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Median thickness of what lies flat.
    pub flat_m: f64,
    /// And of what stands upright.
    pub upright_m: f64,
    /// Scan matching's residual: how far a turn lies off the planes of the one before, in the median.
    pub off_planes_m: f64,
    /// Root mean square error of the speed against the truth.
    pub speed_m_per_s: f64,
    /// And of the turning rate.
    pub turning_rad_per_s: f64,
}

/// A scanner's measures before and after its table is corrected.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checked {
    /// As it was.
    pub before: Measures,
    /// As it is corrected.
    pub after: Measures,
}

/// The part on which a table that was found in a part is checked.
#[must_use]
pub fn on(part: Part) -> Part {
    match part {
        Part::Whole => Part::Whole,
        Part::FirstHalf => Part::SecondHalf,
        Part::SecondHalf => Part::FirstHalf,
    }
}

/// A log's measures before and after; `None` where nothing was found, or its scans say nothing.
#[must_use]
pub fn checked(log: &Log, lasers: &[Laser], truth: &[TruePose]) -> Option<Checked> {
    if lasers.is_empty() {
        return None;
    }
    Some(Checked { before: measures(log, truth)?, after: measures(&corrected(log, lasers), truth)? })
}

fn measures(log: &Log, truth: &[TruePose]) -> Option<Measures> {
    let Agreement { thickness, off_planes_m, steps } = Agreement::of(log).ok()?;
    let (thickness, off_planes_m) = (thickness?, off_planes_m?);
    let off = steps.iter().filter_map(|step| {
        let [v_m_per_s, omega_rad_per_s] = moved(truth, step.t_s, step.dt_s)?;
        Some([step.v_m_per_s - v_m_per_s, step.omega_rad_per_s - omega_rad_per_s])
    });
    let off: Vec<[f64; 2]> = off.collect();
    let rms = |k: usize| (off.iter().fold(0.0, |sum, it| sum + it[k] * it[k]) / off.len().max(1) as f64).sqrt();
    let (speed_m_per_s, turning_rad_per_s) = (rms(0), rms(1));
    let (flat_m, upright_m) = (thickness.flat_m, thickness.upright_m);
    Some(Measures { flat_m, upright_m, off_planes_m, speed_m_per_s, turning_rad_per_s })
}

/// One row for each part of each scanner's log.
#[must_use]
pub fn table(results: &Results) -> Option<Table> {
    let heads = [
        "log",
        "table found in",
        "checked on",
        "flat, before (mm)",
        "after",
        "upright, before (mm)",
        "after",
        "matching, before (mm)",
        "after",
        "speed, before (m/s)",
        "after",
        "turning, before (rad/s)",
        "after",
    ];
    let mut table = Table::new("Real scanners' tables, corrected", &heads).caption(
        "How thick surfaces are (the median over cubes of half a metre of the standard deviation across the plane through a turn's \
         points), how far a turn lies off the planes of the one before (scan matching's residual, in the median), and how far \
         matching errs against inertial navigation, with the lasers' table as their maker has it, and corrected by what was found. \
         Nothing was made best by any of these; what is found in one half is checked on the other.",
    );
    let mut any = false;
    for (record, checked) in results.records.iter().filter_map(|it: &Record| Some((it, it.checked?))) {
        let mut cells: Vec<Cell> =
            vec![record.log.clone().into(), words(record.part).into(), words(on(record.part)).into()];
        let shown = |it: &Measures| {
            let [flat, upright, off] = [it.flat_m, it.upright_m, it.off_planes_m].map(|m| Cell::number(1e3 * m, 1));
            [flat, upright, off, Cell::number(it.speed_m_per_s, 3), Cell::number(it.turning_rad_per_s, 4)]
        };
        let pairs = shown(&checked.before).into_iter().zip(shown(&checked.after));
        cells.extend(pairs.flat_map(|(before, after)| [before, after]));
        table = table.row(RowKind::Ours, cells);
        any = true;
    }
    any.then_some(table)
}

fn words(part: Part) -> &'static str {
    match part {
        Part::Whole => "all",
        Part::FirstHalf => "first half",
        Part::SecondHalf => "second half",
    }
}
