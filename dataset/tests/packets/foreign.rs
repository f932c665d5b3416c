//! Captures by other programs, and packets that are lost or not the scanner's.

use super::*;

/// The same capture as another machine would have stamped it.
fn restamped(bytes: &[u8], big_endian: bool, nano: bool) -> Vec<u8> {
    let word = |word: u32| if big_endian { word.to_be_bytes() } else { word.to_le_bytes() };
    let half = |half: u16| if big_endian { half.to_be_bytes() } else { half.to_le_bytes() };
    let mut out = word(if nano { 0xa1b2_3c4d } else { 0xa1b2_c3d4 }).to_vec();
    out.extend([half(2), half(4)].concat());
    out.extend([word(0), word(0), word(65_535), word(1)].concat());
    for record in bytes[FILE_HEADER..].chunks(PACKET) {
        let at = |i: usize| u32::from_le_bytes(record[i..i + 4].try_into().unwrap());
        out.extend([word(at(0)), word(if nano { at(4) } else { at(4) / 1000 }), word(at(8)), word(at(12))].concat());
        out.extend(&record[16..]);
    }
    out
}

#[test]
fn both_orders_of_bytes_and_both_finenesses_are_read() {
    let firings = drive(600, 7800.0);
    let bytes = capture(&firings);
    for (big_endian, nano, bound_s) in [(false, false, 1.4e-6), (true, false, 1.4e-6), (true, true, 2e-9)] {
        let off_s = compare(&firings, &read(&restamped(&bytes, big_endian, nano)).unwrap().0);
        assert!(off_s < bound_s, "{off_s}");
    }
}

#[test]
fn other_packets_are_passed_over_and_counted() {
    let firings = drive(60, 7800.0);
    let bytes = capture(&firings);
    let sound: Vec<Vec<u8>> = (1..=10).map(|number| record(&bytes, number)).collect();
    let others: [(&str, Vec<u8>); 8] = [
        ("ARP", reframed(&sound[0], |f| f[12..14].copy_from_slice(&[8, 6]))),
        ("IPv6", reframed(&sound[0], |f| f[12..14].copy_from_slice(&[0x86, 0xdd]))),
        ("TCP", reframed(&sound[0], |f| f[23] = 6)),
        ("a fragment", reframed(&sound[0], |f| f[20..22].copy_from_slice(&[0x20, 1]))),
        ("a position packet", reframed(&sound[0], |f| f[36..38].copy_from_slice(&8308_u16.to_be_bytes()))),
        ("another length", reframed(&sound[0], |f| f[38..40].copy_from_slice(&1256_u16.to_be_bytes()))),
        ("nothing", reframed(&sound[0], |f| f.clear())),
        ("half a header", reframed(&sound[0], |f| f.truncate(37))),
    ];
    for (name, other) in &others {
        let mut records = sound.clone();
        records.insert(4, other.clone());
        records.insert(0, other.clone());
        let (back, tally) = read(&file(&bytes, &records)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(compare(&firings, &back) < 2e-9, "{name}");
        assert_eq!(tally, Tally { packets: 10, skipped: 2, ..Tally::default() }, "{name}");
    }
    // A tag of a virtual network and a trailer are no matter.
    let dressed = |record: &Vec<u8>| {
        reframed(record, |f| {
            f.splice(12..12, [0x81, 0, 0, 7]);
            f.extend([1, 2, 3, 4]);
        })
    };
    let (back, tally) = read(&file(&bytes, &sound.iter().map(dressed).collect::<Vec<_>>())).unwrap();
    assert!(compare(&firings, &back) < 2e-9 && tally.packets == 10);
    // Nor is a datagram without a checksum.
    let unsealed = |record: &Vec<u8>| reframed(record, |f| f[40..42].fill(0));
    let (back, _) = read(&file(&bytes, &sound.iter().map(unsealed).collect::<Vec<_>>())).unwrap();
    assert!(compare(&firings, &back) < 2e-9);
}

#[test]
fn lost_packets_are_counted_and_leave_the_others_their_times() {
    let firings = drive(6000, 7800.0);
    let bytes = capture(&firings);
    let lost = [5..8, 300..301, 700..820];
    let kept: Vec<usize> = (0..1000).filter(|i| !lost.iter().any(|lost| lost.contains(i))).collect();
    let records: Vec<Vec<u8>> = kept.iter().map(|i| record(&bytes, i + 1)).collect();
    let (back, tally) = read(&file(&bytes, &records)).unwrap();
    assert_eq!(tally, Tally { packets: 876, skipped: 0, gaps: 3, lost_packets: 124, jumps: 0 });
    for (packet, i) in kept.iter().enumerate() {
        for j in 0..6 {
            assert!((back.t_s[6 * packet + j] - firings.t_s[6 * i + j]).abs() < 2e-9);
        }
    }
    // Firings with such gaps can be written.
    assert!(compare(&back, &read(&capture(&back)).unwrap().0) < 1e-7);
}

#[test]
fn an_encoder_that_jumps_is_counted() {
    let mut firings = drive(600, 7800.0);
    firings.encoder_cdeg[400..].iter_mut().for_each(|angle| *angle = (*angle + 5000) % 36_000);
    assert_eq!(read(&capture(&firings)).unwrap().1.jumps, 1);
}
