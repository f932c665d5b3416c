//! The classic format of captures: a header of 24 bytes, then packets with headers of 16.

use std::io::{ErrorKind, Read};

use super::error::{PacketError, WrongPacket};

const MICRO: u32 = 0xa1b2_c3d4;
const NANO: u32 = 0xa1b2_3c4d;
const NG: u32 = 0x0a0d_0d0a;
const ETHERNET: u32 = 1;
/// The longest frame that captures hold.
const LONGEST: u32 = 262_144;
const NANOS: u64 = 1_000_000_000;

/// The header of a file of Ethernet frames, little endian, stamped to the nanosecond.
pub(super) fn file_header() -> [u8; 24] {
    let mut header = [0; 24];
    header[..4].copy_from_slice(&NANO.to_le_bytes());
    header[4..6].copy_from_slice(&2_u16.to_le_bytes());
    header[6..8].copy_from_slice(&4_u16.to_le_bytes());
    header[16..20].copy_from_slice(&LONGEST.to_le_bytes());
    header[20..].copy_from_slice(&ETHERNET.to_le_bytes());
    header
}

/// The header of a packet captured whole.
pub(super) fn packet_header(stamp_ns: u64, length: usize) -> [u8; 16] {
    let words = [(stamp_ns / NANOS) as u32, (stamp_ns % NANOS) as u32, length as u32, length as u32];
    let mut header = [0; 16];
    for (place, word) in header.chunks_exact_mut(4).zip(words) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    header
}

/// A capture, packet by packet; it keeps one at a time.
pub(super) struct Packets<R> {
    from: R,
    word: fn([u8; 4]) -> u32,
    parts: u32,
    number: u64,
    frame: Vec<u8>,
}

/// A packet as captured.
pub(super) struct Captured<'a> {
    pub stamp_ns: u64,
    /// Bytes on the wire.
    pub length: u32,
    pub frame: &'a [u8],
}

impl<R: Read> Packets<R> {
    pub fn new(mut from: R) -> Result<Self, PacketError> {
        let whole = |wrong| PacketError { packet: 0, wrong };
        let mut header = [0; 24];
        let found = fill(&mut from, &mut header).map_err(whole)?;
        let [a, b, c, d, ..] = header;
        let magic = [a, b, c, d];
        let (little, big) = (u32::from_le_bytes(magic), u32::from_be_bytes(magic));
        let (word, parts): (fn([u8; 4]) -> u32, _) = match (little, big) {
            (MICRO, _) => (u32::from_le_bytes, 1_000_000),
            (NANO, _) => (u32::from_le_bytes, 1_000_000_000),
            (_, MICRO) => (u32::from_be_bytes, 1_000_000),
            (_, NANO) => (u32::from_be_bytes, 1_000_000_000),
            (NG, _) => return Err(whole(WrongPacket::PcapNg)),
            _ if found < 4 => return Err(whole(WrongPacket::CutShort { expected: header.len(), found })),
            _ => return Err(whole(WrongPacket::Magic { found: big })),
        };
        if found < header.len() {
            return Err(whole(WrongPacket::CutShort { expected: header.len(), found }));
        }
        let at = |i: usize| word([header[i], header[i + 1], header[i + 2], header[i + 3]]);
        // Two half words: their order follows that of the bytes.
        let version = if little == MICRO || little == NANO { at(4) & 0xffff } else { at(4) >> 16 } as u16;
        if version != 2 {
            return Err(whole(WrongPacket::Version { found: version }));
        }
        // The upper half of the word tells of trailing checksums.
        let link = at(20) & 0xffff;
        if link != ETHERNET {
            return Err(whole(WrongPacket::Link { found: link }));
        }
        Ok(Self { from, word, parts, number: 0, frame: Vec::new() })
    }

    /// The number of the packet read last, from 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The next packet; `None` after the last.
    pub fn next(&mut self) -> Result<Option<Captured<'_>>, PacketError> {
        let packet = self.number + 1;
        let wrong = |wrong| PacketError { packet, wrong };
        let mut header = [0; 16];
        match fill(&mut self.from, &mut header).map_err(wrong)? {
            0 => return Ok(None),
            found if found < header.len() => {
                return Err(wrong(WrongPacket::CutShort { expected: header.len(), found }));
            }
            _ => self.number = packet,
        }
        let at = |i: usize| (self.word)([header[i], header[i + 1], header[i + 2], header[i + 3]]);
        let (seconds, fraction, captured, length) = (at(0), at(4), at(8), at(12));
        if captured > LONGEST {
            return Err(wrong(WrongPacket::TooLong { limit_bytes: LONGEST, found: captured }));
        }
        if fraction >= self.parts {
            return Err(wrong(WrongPacket::Fraction { found: fraction, parts: self.parts }));
        }
        let expected = captured as usize;
        self.frame.resize(expected, 0);
        let found = fill(&mut self.from, &mut self.frame).map_err(wrong)?;
        if found < expected {
            return Err(wrong(WrongPacket::CutShort { expected, found }));
        }
        let stamp_ns = u64::from(seconds) * NANOS + u64::from(fraction) * (NANOS / u64::from(self.parts));
        Ok(Some(Captured { stamp_ns, length, frame: &self.frame }))
    }
}

/// Reads until `bytes` is full or nothing more comes, and says how many came.
fn fill(from: &mut impl Read, bytes: &mut [u8]) -> Result<usize, WrongPacket> {
    let mut found = 0;
    while found < bytes.len() {
        match from.read(&mut bytes[found..]) {
            Ok(0) => break,
            Ok(more) => found += more,
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) => return Err(WrongPacket::Unreadable(e)),
        }
    }
    Ok(found)
}
