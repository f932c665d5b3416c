//! The 1206 bytes of a data packet.

use super::error::WrongPacket;
use super::order::{LASERS, Order};
use crate::Firings;
use crate::firings::ENCODER_STEPS;

/// Bytes of a data packet.
pub(super) const PAYLOAD: usize = 1206;
/// Firings of a data packet.
pub(super) const FIRINGS: usize = 6;
const BLOCK: usize = 100;
const BANK: usize = 32;
const UPPER: u16 = 0xEEFF;
const LOWER: u16 = 0xDDFF;
/// Status: the firmware's version comes next, and it is 0.
const STATUS: [u8; 2] = [b'V', 0];

/// Where a laser's three bytes begin within the two blocks of a firing.
fn place(number: u8) -> usize {
    let number = usize::from(number);
    number / BANK * BLOCK + 4 + number % BANK * 3
}

/// Lays the firings from `first` on, `count` of them, into a packet of that time.
pub(super) fn fill(
    payload: &mut [u8; PAYLOAD],
    firings: &Firings,
    order: &Order,
    first: usize,
    count: usize,
    stamp_ns: u64,
) {
    const HOUR_US: u64 = 3_600_000_000;
    payload.fill(0);
    for slot in 0..FIRINGS {
        let (at, full) = (2 * BLOCK * slot, slot < count);
        let encoder = firings.encoder_cdeg[first + slot.min(count - 1)].to_le_bytes();
        for (block, mark) in [(at, UPPER), (at + BLOCK, if full { LOWER } else { UPPER })] {
            payload[block..block + 2].copy_from_slice(&mark.to_le_bytes());
            payload[block + 2..block + 4].copy_from_slice(&encoder);
        }
    }
    for (laser, number) in order.numbers().iter().enumerate() {
        let place = place(*number);
        for (slot, range) in firings.range_2mm[laser][first..first + count].iter().enumerate() {
            payload[2 * BLOCK * slot + place..][..2].copy_from_slice(&range.to_le_bytes());
        }
        if let Some(intensity) = firings.intensity.get(laser) {
            for (slot, intensity) in intensity[first..first + count].iter().enumerate() {
                payload[2 * BLOCK * slot + place + 2] = *intensity;
            }
        }
    }
    payload[12 * BLOCK..][..4].copy_from_slice(&((stamp_ns / 1000 % HOUR_US) as u32).to_le_bytes());
    payload[12 * BLOCK + 4..].copy_from_slice(&STATUS);
}

/// Appends a packet's firings, all but their times, and says how many they are.
pub(super) fn take(payload: &[u8; PAYLOAD], order: &Order, firings: &mut Firings) -> Result<usize, WrongPacket> {
    let count = firings_in(payload)?;
    for slot in 0..count {
        firings.encoder_cdeg.push(number(payload, 2 * BLOCK * slot + 2));
    }
    let columns = firings.range_2mm.iter_mut().zip(&mut firings.intensity);
    for (number_of, (ranges, intensities)) in order.numbers().iter().zip(columns) {
        let place = place(*number_of);
        let at = |slot: usize| 2 * BLOCK * slot + place;
        let range: [u16; FIRINGS] = std::array::from_fn(|slot| number(payload, at(slot)));
        let intensity: [u8; FIRINGS] = std::array::from_fn(|slot| payload[at(slot) + 2]);
        ranges.extend_from_slice(&range[..count]);
        intensities.extend_from_slice(&intensity[..count]);
    }
    Ok(count)
}

/// How many firings a sound packet has; fillers come last.
fn firings_in(payload: &[u8; PAYLOAD]) -> Result<usize, WrongPacket> {
    let mut count = None;
    for slot in 0..FIRINGS {
        let (block, at) = (2 * slot, 2 * BLOCK * slot);
        let marks = [number(payload, at), number(payload, at + BLOCK)];
        let encoder = [number(payload, at + 2), number(payload, at + BLOCK + 2)];
        if marks[0] != UPPER {
            return Err(WrongPacket::Header { block, expected: UPPER, found: marks[0] });
        }
        if encoder[0] >= ENCODER_STEPS {
            return Err(WrongPacket::Encoder { block, found: encoder[0] });
        }
        if encoder[1] != encoder[0] {
            return Err(WrongPacket::TwoAngles { block: block + 1, expected: encoder[0], found: encoder[1] });
        }
        // After a filler there are fillers only.
        if marks[1] != LOWER && marks[1] != UPPER || marks[1] == LOWER && count.is_some() {
            let expected = if count.is_some() { UPPER } else { LOWER };
            return Err(WrongPacket::Header { block: block + 1, expected, found: marks[1] });
        }
        if marks[1] == UPPER {
            let empty = |block: usize| payload[block + 4..block + BLOCK].iter().all(|byte| *byte == 0);
            if !empty(at) || !empty(at + BLOCK) {
                return Err(WrongPacket::Unpaired { block });
            }
            count.get_or_insert(slot);
        }
    }
    Ok(count.unwrap_or(FIRINGS))
}

/// Columns for a unit's firings.
pub(super) fn columns() -> Firings {
    Firings { range_2mm: vec![Vec::new(); LASERS], intensity: vec![Vec::new(); LASERS], ..Firings::default() }
}

fn number(bytes: &[u8; PAYLOAD], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}
