//! Firings as a capture.

use std::io::{self, Write};

use super::datagram::{HEADERS, frame, seal};
use super::error::Unfit;
use super::order::{LASERS, Order};
use super::payload::{PAYLOAD, fill};
use super::pcap::{file_header, packet_header};
use super::read::MOST_FIRINGS;
use super::times::stamps;
use crate::Firings;

/// Whether an HDL-64E's packets can hold these firings.
///
/// # Errors
/// [`Unfit`] if their columns do not fit together, they are not 64 lasers' or a time cannot be stamped.
pub fn check(firings: &Firings) -> Result<(), Unfit> {
    firings.check()?;
    if firings.lasers() != LASERS {
        return Err(Unfit::Lasers { found: firings.lasers() });
    }
    if firings.len() > MOST_FIRINGS {
        return Err(Unfit::TooMany { limit: MOST_FIRINGS, found: firings.len() });
    }
    let last_s = f64::from(u32::MAX);
    match firings.t_s.iter().position(|t_s| !(0.0..=last_s).contains(t_s)) {
        Some(firing) => Err(Unfit::Time { firing, t_s: firings.t_s[firing] }),
        None => Ok(()),
    }
}

/// Writes a capture of `firings`, stamped in seconds since the log began. Let `to` be buffered.
///
/// # Errors
/// What `to` says; [`Unfit`] firings are an error of kind `InvalidInput`.
pub fn write(firings: &Firings, order: &Order, mut to: impl Write) -> io::Result<()> {
    check(firings).map_err(|unfit| io::Error::new(io::ErrorKind::InvalidInput, unfit))?;
    to.write_all(&file_header())?;
    let (mut frame, mut payload) = (frame(), [0; PAYLOAD]);
    let mut first = 0;
    for stamp in stamps(&firings.t_s) {
        fill(&mut payload, firings, order, first, stamp.count, stamp.ns);
        frame[HEADERS..].copy_from_slice(&payload);
        seal(&mut frame);
        to.write_all(&packet_header(stamp.ns, frame.len()))?;
        to.write_all(&frame)?;
        first += stamp.count;
    }
    to.flush()
}
