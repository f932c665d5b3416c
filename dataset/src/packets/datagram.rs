//! Ethernet, IPv4 and UDP around a data packet.

use super::error::WrongPacket;
use super::payload::PAYLOAD;

/// Bytes ahead of the payload.
pub(super) const HEADERS: usize = ETHERNET + IP + UDP;
const ETHERNET: usize = 14;
const IP: usize = 20;
const UDP: usize = 8;
const TAG: usize = 4;
const IPV4: u16 = 0x0800;
const VLAN: u16 = 0x8100;
const UDP_PROTOCOL: u8 = 17;
/// Where data packets go.
const PORT: u16 = 2368;
/// The sensor's port.
const FROM_PORT: u16 = 443;

/// A data packet's frame, its payload still empty: from the unit's factory address to everybody.
pub(super) fn frame() -> [u8; HEADERS + PAYLOAD] {
    let mut frame = [0; HEADERS + PAYLOAD];
    frame[..6].fill(0xff);
    frame[6..12].copy_from_slice(&[0x60, 0x76, 0x88, 0, 0, 0]);
    frame[12..14].copy_from_slice(&IPV4.to_be_bytes());
    let ip = &mut frame[ETHERNET..ETHERNET + IP];
    ip[0] = 0x45;
    ip[2..4].copy_from_slice(&((IP + UDP + PAYLOAD) as u16).to_be_bytes());
    // Not to be fragmented.
    ip[6] = 0x40;
    ip[8] = 255;
    ip[9] = UDP_PROTOCOL;
    ip[12..16].copy_from_slice(&[192, 168, 1, 201]);
    ip[16..20].fill(255);
    let checksum = !folded(sum(ip));
    ip[10..12].copy_from_slice(&checksum.to_be_bytes());
    let udp = &mut frame[ETHERNET + IP..HEADERS];
    udp[0..2].copy_from_slice(&FROM_PORT.to_be_bytes());
    udp[2..4].copy_from_slice(&PORT.to_be_bytes());
    udp[4..6].copy_from_slice(&((UDP + PAYLOAD) as u16).to_be_bytes());
    frame
}

/// Puts the checksum of the payload's datagram in its place.
pub(super) fn seal(frame: &mut [u8; HEADERS + PAYLOAD]) {
    let (ip, datagram) = frame[ETHERNET..].split_at_mut(IP);
    let checksum = checksum(ip, datagram);
    datagram[6..8].copy_from_slice(&checksum.to_be_bytes());
}

/// What a captured frame is.
pub(super) enum Content<'a> {
    /// A data packet.
    Data(&'a [u8; PAYLOAD]),
    /// A data packet of which not all was captured.
    Partial,
    /// Something else.
    Other,
}

/// Looks into a frame of which `frame` was captured.
pub(super) fn content(frame: &[u8]) -> Result<Content<'_>, WrongPacket> {
    let Some((ip, rest)) = headers(frame) else { return Ok(Content::Other) };
    let Some((udp, _)) = rest.split_at_checked(UDP) else { return Ok(Content::Other) };
    if word(udp, 2) != PORT || usize::from(word(udp, 4)) != UDP + PAYLOAD {
        return Ok(Content::Other);
    }
    // A frame may be longer than what is in it: Ethernet's least length, a trailing checksum.
    let Some(datagram) = rest.get(..UDP + PAYLOAD) else { return Ok(Content::Partial) };
    // A datagram without a checksum has 0 in its place.
    let (found, expected) = (word(datagram, 6), checksum(ip, datagram));
    if found != 0 && found != expected {
        return Err(WrongPacket::Checksum { expected, found });
    }
    let payload = datagram.get(UDP..).and_then(|payload| payload.first_chunk());
    Ok(payload.map_or(Content::Partial, Content::Data))
}

/// The IPv4 header of an unfragmented UDP datagram, and what comes after it.
fn headers(frame: &[u8]) -> Option<(&[u8], &[u8])> {
    let tagged = word(frame.get(..ETHERNET)?, 12) == VLAN;
    let (link, rest) = frame.split_at_checked(ETHERNET + if tagged { TAG } else { 0 })?;
    if word(link, link.len() - 2) != IPV4 {
        return None;
    }
    let first = *rest.first()?;
    let length = 4 * usize::from(first & 0x0f);
    let (ip, rest) = rest.split_at_checked(length.max(IP))?;
    // The last flag and the offset tell fragments.
    let whole = word(ip, 6) & 0x3fff == 0;
    (first >> 4 == 4 && length >= IP && ip[9] == UDP_PROTOCOL && whole).then_some((ip, rest))
}

/// UDP's checksum (RFC 768): over a header of addresses, protocol and length, and the datagram less its checksum.
fn checksum(ip: &[u8], datagram: &[u8]) -> u16 {
    let (udp, payload) = datagram.split_at(UDP);
    let header = u32::from(UDP_PROTOCOL) + datagram.len() as u32;
    let checksum = !folded(sum(&ip[12..20]) + header + sum(&udp[..6]) + sum(payload));
    if checksum == 0 { 0xffff } else { checksum }
}

fn sum(bytes: &[u8]) -> u32 {
    bytes.chunks_exact(2).map(|pair| u32::from(u16::from_be_bytes([pair[0], pair[1]]))).sum()
}

fn folded(sum: u32) -> u16 {
    let once = (sum & 0xffff) + (sum >> 16);
    ((once & 0xffff) + (once >> 16)) as u16
}

fn word(bytes: &[u8], at: usize) -> u16 {
    u16::from_be_bytes([bytes[at], bytes[at + 1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The header and its checksum of RFC 1071's best-known worked example.
    #[test]
    fn the_internet_checksum_is_the_published_one() {
        let header = [0x45, 0, 0, 0x73, 0, 0, 0x40, 0, 0x40, 0x11, 0, 0, 0xc0, 0xa8, 0, 1, 0xc0, 0xa8, 0, 0xc7];
        assert_eq!(!folded(sum(&header)), 0xb861);
    }

    /// Whoever adds up a sealed header or datagram, checksum included, gets all ones.
    #[test]
    fn sealed_sums_are_all_ones() {
        let mut frame = frame();
        frame[HEADERS..].iter_mut().enumerate().for_each(|(i, byte)| *byte = (i * i) as u8);
        seal(&mut frame);
        let (ip, datagram) = frame[ETHERNET..].split_at(IP);
        assert_eq!(folded(sum(ip)), 0xffff);
        assert_eq!(folded(sum(&ip[12..]) + 17 + datagram.len() as u32 + sum(datagram)), 0xffff);
    }
}
