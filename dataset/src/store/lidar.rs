//! `lidar.pcap`: what the laser scanner recorded, as its own packets.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use super::error::{ReadError, WriteError, Wrong};
use super::rows::open;
use super::{remove, replace_by};
use crate::Firings;
use crate::log::Known;
use crate::packets::{self, Order, Start, Tally};

fn path(dir: &Path) -> PathBuf {
    dir.join("lidar.pcap")
}

/// Reads `lidar.pcap` of the data set in the folder `dir`, and says what else it held and what it lacks; `None` if there
/// is no such file. Lasers are numbered as in [`Order::UPPER_ABOVE`].
///
/// # Errors
/// [`ReadError`] for the first packet that is not sound.
pub(super) fn read(dir: &Path) -> Result<Option<(Firings, Tally)>, ReadError> {
    let path = path(dir);
    let Some(file) = open(&path)? else { return Ok(None) };
    let from = BufReader::with_capacity(1 << 16, file);
    let read = packets::read(from, &Order::UPPER_ABOVE, Start::Zero);
    read.map(Some).map_err(|e| ReadError { file: path, place: None, wrong: Box::new(e.into()) })
}

/// Whether firings are of the unit that `dataset.toml` tells of, if it does.
pub(super) fn fits(dir: &Path, known: &Known, firings: Option<&Firings>) -> Result<(), ReadError> {
    let (Some(firings), Some(velodyne)) = (firings, &known.velodyne) else { return Ok(()) };
    let (lasers, found) = (firings.lasers(), velodyne.vertical_angles_rad.len());
    if lasers == found {
        return Ok(());
    }
    let expected = format!("{lasers}, as lidar.pcap has lasers,");
    let wrong = Box::new(Wrong::Length { name: "vertical_angles_rad", expected, found });
    Err(ReadError { file: dir.join("dataset.toml"), place: None, wrong })
}

/// Whether firings can be written and would be read.
pub(super) fn check(dir: &Path, known: &Known, firings: Option<&Firings>) -> Result<(), ReadError> {
    let unfit = |e: packets::Unfit| ReadError { file: path(dir), place: None, wrong: Box::new(e.into()) };
    firings.map_or(Ok(()), packets::check).map_err(unfit)?;
    fits(dir, known, firings)
}

/// Writes `lidar.pcap`, or removes it where there are no firings.
pub(super) fn write(dir: &Path, firings: Option<&Firings>) -> Result<(), WriteError> {
    match firings {
        Some(firings) => replace_by(&path(dir), |to| packets::write(firings, &Order::UPPER_ABOVE, to)),
        None => remove(path(dir)),
    }
}
