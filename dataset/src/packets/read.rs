//! A capture as firings.

use std::io::Read;

use super::datagram::{Content, content};
use super::error::{PacketError, WrongPacket};
use super::order::Order;
use super::payload::{FIRINGS, columns, take};
use super::pcap::Packets;
use super::times::{Stamp, is_gap, period_ns, times_s};
use crate::Firings;
use crate::firings::ENCODER_STEPS;

/// More firings than this are refused.
pub(super) const MOST_FIRINGS: usize = 20_000_000;
/// The encoder jumps if it is farther off than this from where it was to be, in hundredths of a degree.
const JUMP_CDEG: f64 = 100.0;

/// When the log of a capture began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Stamps count from the beginning of the log, as in a data set.
    Zero,
    /// With the first data packet, as of a capture stamped by the calendar.
    FirstPacket,
}

/// What a capture held, and what it seems to lack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Data packets.
    pub packets: u64,
    /// Packets passed over: other protocols, ports and lengths.
    pub skipped: u64,
    /// Times that data packets are missing.
    pub gaps: u64,
    /// Data packets missing in the gaps, by the time that they last.
    pub lost_packets: u64,
    /// Firings, no gap before them, at which the encoder is more than a degree from where it was to be.
    pub jumps: u64,
}

/// Reads a capture's firings. Let `from` be buffered. Beyond the firings themselves, memory for one packet and the
/// stamps is taken.
///
/// # Errors
/// [`PacketError`] for the first thing found that a sound capture does not hold.
pub fn read(from: impl Read, order: &Order, start: Start) -> Result<(Firings, Tally), PacketError> {
    let mut packets = Packets::new(from)?;
    let (mut firings, mut stamps) = (columns(), Vec::<Stamp>::new());
    let mut tally = Tally::default();
    loop {
        let packet = packets.number() + 1;
        let wrong = |wrong| PacketError { packet, wrong };
        let Some(captured) = packets.next()? else { break };
        match content(captured.frame).map_err(wrong)? {
            Content::Data(payload) => {
                tally.packets += 1;
                let ns = captured.stamp_ns;
                if let Some(previous) = stamps.last().filter(|previous| ns < previous.ns) {
                    let (t_s, previous_s) = (ns as f64 / 1e9, previous.ns as f64 / 1e9);
                    return Err(wrong(WrongPacket::TimeGoesBack { t_s, previous_s }));
                }
                let count = take(payload, order, &mut firings).map_err(wrong)?;
                if firings.encoder_cdeg.len() > MOST_FIRINGS {
                    return Err(wrong(WrongPacket::TooMany { limit: MOST_FIRINGS }));
                }
                if count > 0 {
                    stamps.push(Stamp { ns, count });
                }
            }
            Content::Partial => {
                let (expected, found) = (captured.length, captured.frame.len() as u32);
                return Err(wrong(WrongPacket::Snapped { expected, found }));
            }
            Content::Other => tally.skipped += 1,
        }
    }
    let first_ns = stamps.first().map_or(0, |stamp| stamp.ns);
    firings.t_s = times_s(&stamps, if start == Start::Zero { 0 } else { first_ns });
    if firings.intensity.iter().flatten().all(|intensity| *intensity == 0) {
        firings.intensity = Vec::new();
    }
    count_gaps(&stamps, &mut tally);
    tally.jumps = jumps(&firings, period_ns(&stamps));
    Ok((firings, tally))
}

fn count_gaps(stamps: &[Stamp], tally: &mut Tally) {
    let period_ns = period_ns(stamps);
    if period_ns <= 0.0 {
        return;
    }
    for pair in stamps.windows(2).filter(|pair| pair[0].count == FIRINGS && is_gap(pair, period_ns)) {
        let firings = (pair[1].ns - pair[0].ns) as f64 / period_ns - pair[0].count as f64;
        tally.gaps += 1;
        tally.lost_packets = tally.lost_packets.saturating_add((firings / FIRINGS as f64).round() as u64);
    }
}

/// Firings that follow the one before them in time but not in angle.
fn jumps(firings: &Firings, period_ns: f64) -> u64 {
    let turn = u32::from(ENCODER_STEPS);
    let step = |pair: &[u16]| (u32::from(pair[1]) + turn - u32::from(pair[0])) % turn;
    let mut steps: Vec<u32> = firings.encoder_cdeg.windows(2).map(step).collect();
    let middle = steps.len() / 2;
    let Some((_, usual, _)) = (!steps.is_empty()).then(|| steps.select_nth_unstable(middle)) else { return 0 };
    let usual = f64::from(*usual);
    let (half, turn) = (f64::from(turn) / 2.0, f64::from(turn));
    let jumps = |(angles, times): &(&[u16], &[f64])| {
        let periods = (times[1] - times[0]) * 1e9 / period_ns;
        let off = (f64::from(step(angles)) - usual * periods + half).rem_euclid(turn) - half;
        periods <= 1.5 && off.abs() > JUMP_CDEG
    };
    firings.encoder_cdeg.windows(2).zip(firings.t_s.windows(2)).filter(jumps).count() as u64
}
