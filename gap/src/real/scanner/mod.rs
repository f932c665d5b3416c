//! The diagnosis of a real laser scanner's log: which of its lasers see elsewhere than its maker's table says, without a map, a
//! command, or a simulated town.
//!
//! Every laser sees the road under the car, and neighbouring lasers the same walls. Where the table is right they agree, whatever
//! the street looks like; what they disagree by, the same from second to second while the street goes by, is the scanner's. So a
//! street that nobody modelled need not be: its shape is free, how much it scatters is taken from the log itself ([`seen`]), and
//! what each laser is off by is learned as the log goes on ([`lasers`]), as far as a hypothesis lets it be off.
//!
//! Of the catalogue those effects are thought of that this shows: vertical angles, ranges, and where lasers stand. How the scanner's
//! base leans cannot be told from how the car stands on its springs, nor a clock from a street.

pub mod agrees;
pub mod judge;
pub mod lasers;
pub mod seen;

use std::sync::Arc;

use asami_dataset::firings::RANGE_STEP_M;
use asami_dataset::log::Velodyne;
use asami_dataset::{Firings, Known, Log};

use super::assembled;
use super::kin::Kin;
use super::layers::{Layer, Least, layers, planted, reconsidered};
use crate::answer::diagnosis::Diagnosis;
use crate::judge::Judge;
use crate::plant::Variant;
use crate::view::CannotSee;
use judge::Table;
use lasers::Laser;
use seen::Seen;

/// What is less evident, or adds less, may as well be the street's.
const LEAST: Least = Least { nats: 10.0, share: 0.01, share_together: 0.01, late_once: false, kin: Kin::NONE };
/// How loud chance is hangs on what is put into the table, and that on how loud it is.
const ROUNDS: usize = 2;

/// A scanner's log, diagnosed, and its lasers as they are found to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Where, which and how far.
    pub diagnosis: Diagnosis,
    /// Of each laser, what the table is to be corrected by; nothing where no effect was found.
    pub lasers: Vec<Laser>,
}

/// Diagnoses a log by its scans alone.
///
/// # Errors
/// [`CannotSee`] says what the log lacks.
pub fn diagnose(variants: &[Variant], log: &Log) -> Result<Found, CannotSee> {
    let mut table = Table::new(Seen::read(log)?);
    let variants: Vec<Variant> = variants.iter().filter(|it| table.knows(it)).cloned().collect();
    let named = |table: &Table| reconsidered(table, &variants, layers(table, &variants, &LEAST), &LEAST);
    let mut found: Vec<Layer> = named(&table);
    for _ in 1..ROUNDS {
        table.listen(&planted(&found));
        found = named(&table);
    }
    let lasers = if found.is_empty() { Vec::new() } else { table.lasers(&planted(&found)) };
    // Banks that stand apart show whatever else does: of what comes in sizes the least is asked for.
    let sized: Vec<Variant> =
        variants.into_iter().filter(|it| it.choices.iter().all(|(_, value)| *value == 0.0)).collect();
    Ok(Found { diagnosis: shown(assembled(&table, &sized, &found, &planted(&found)), &sized), lasers })
}

/// The diagnosis without parameters that do not show: what all lasers are off by alike is the street's shape as well.
fn shown(mut diagnosis: Diagnosis, variants: &[Variant]) -> Diagnosis {
    let shows =
        |path: &str| path.split_once('.').is_some_and(|(effect, parameter)| judge::shows(effect, parameter).is_some());
    for cause in &mut diagnosis.which {
        cause.parameters.retain(|path, _| shows(path));
    }
    let named = |(path, size): (String, f64)| {
        let about = variants.iter().map(|it| it.about).find(|about| path.starts_with(&format!("{}.", about.name)));
        let mut moves =
            about.into_iter().flat_map(|about| about.law.iter().map(|(name, _)| format!("{}.{name}", about.name)));
        (moves.find(|path| shows(path)).unwrap_or(path), size)
    };
    diagnosis.smallest_visible = diagnosis.smallest_visible.into_iter().map(named).collect();
    diagnosis
}

/// A log as the scanner would have recorded it, were its table right: vertical angles and places corrected in what is known, ranges
/// in the firings.
#[must_use]
pub fn corrected(log: &Log, lasers: &[Laser]) -> Log {
    let (Some(firings), Some(known)) = (log.firings.as_deref(), log.known.velodyne.as_ref()) else {
        return log.clone();
    };
    if lasers.len() != firings.lasers() {
        return log.clone();
    }
    let range = |(ranges, laser): (&Vec<u16>, &Laser)| {
        let steps = laser.range_m / RANGE_STEP_M;
        let shift = |range: &u16| match *range {
            0 => 0,
            range => (f64::from(range) - steps).round().clamp(1.0, f64::from(u16::MAX)) as u16,
        };
        ranges.iter().map(shift).collect()
    };
    // What was known of places is kept: lasers are off by so much more.
    let added = |known: &[f64], more: fn(&Laser) -> f64| {
        let so_far = known.iter().copied().chain(std::iter::repeat(0.0));
        lasers.iter().zip(so_far).map(|(laser, known)| known + more(laser)).collect()
    };
    let velodyne = Velodyne {
        vertical_angles_rad: added(&known.vertical_angles_rad, |laser| laser.vertical_rad),
        left_m: added(&known.left_m, |laser| laser.left_m),
        up_m: added(&known.up_m, |laser| laser.up_m),
        ..known.clone()
    };
    let range_2mm = firings.range_2mm.iter().zip(lasers).map(range).collect();
    Log {
        known: Arc::new(Known { velodyne: Some(velodyne), ..(*log.known).clone() }),
        firings: Some(Arc::new(Firings { range_2mm, ..firings.clone() })),
        ..log.clone()
    }
}
