//! Firings as captures and back, and captures that are broken, foreign or lack packets.

use std::sync::Arc;

use asami_dataset::log::Velodyne;
use asami_dataset::packets::{self, Order, PacketError, Start, Tally};
use asami_dataset::{Dataset, Firings, Known, Log, Rng, Seed, store};
use proptest::prelude::*;
use rand::RngExt;

const FILE_HEADER: usize = 24;
/// A packet in the file: header, frame.
const PACKET: usize = 16 + 42 + 1206;

/// A turning scanner: every laser, range and intensity tells where it belongs.
fn drive(count: usize, rate_hz: f64) -> Firings {
    let step_cdeg = 10.0 * 36_000.0 / rate_hz;
    Firings {
        t_s: (0..count).map(|i| 3.0 + i as f64 / rate_hz).collect(),
        encoder_cdeg: (0..count).map(|i| ((i as f64 * step_cdeg).round() % 36_000.0) as u16).collect(),
        range_2mm: (0..64).map(|laser| (0..count).map(|i| (1000 * laser + i) as u16).collect()).collect(),
        intensity: (0..64).map(|laser| (0..count).map(|i| (3 * laser + i) as u8).collect()).collect(),
    }
}

fn capture(firings: &Firings) -> Vec<u8> {
    let mut bytes = Vec::new();
    packets::write(firings, &Order::UPPER_ABOVE, &mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<(Firings, Tally), PacketError> {
    packets::read(bytes, &Order::UPPER_ABOVE, Start::Zero)
}

/// All but the times, and how far these are off.
fn compare(a: &Firings, b: &Firings) -> f64 {
    assert_eq!(a.encoder_cdeg, b.encoder_cdeg);
    assert!(a.range_2mm == b.range_2mm && a.intensity == b.intensity);
    assert_eq!(a.len(), b.len());
    a.t_s.iter().zip(&b.t_s).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Places and values by the manual, written out by hand.
#[test]
fn a_packet_is_laid_out_as_the_unit_lays_it() {
    let firings = drive(12, 7800.0);
    let bytes = capture(&firings);
    assert_eq!(bytes.len(), FILE_HEADER + 2 * PACKET);
    assert_eq!(bytes[..8], [0x4d, 0x3c, 0xb2, 0xa1, 2, 0, 4, 0]);
    assert_eq!(bytes[20..24], [1, 0, 0, 0]);
    let record = &bytes[FILE_HEADER..FILE_HEADER + PACKET];
    assert_eq!(record[..16], [3, 0, 0, 0, 0, 0, 0, 0, 0xe0, 4, 0, 0, 0xe0, 4, 0, 0]);
    let frame = &record[16..];
    assert_eq!(frame[12..24], [8, 0, 0x45, 0, 4, 0xd2, 0, 0, 0x40, 0, 255, 17]);
    // To port 2368, 1214 bytes with UDP's header.
    assert_eq!(frame[36..40], [0x09, 0x40, 0x04, 0xbe]);
    let payload = &frame[42..];
    for block in 0..12 {
        let block_bytes = &payload[100 * block..][..100];
        let (firing, lower) = (block / 2, block % 2);
        assert_eq!(block_bytes[..2], [0xff, if lower == 1 { 0xdd } else { 0xee }]);
        assert_eq!(u16::from_le_bytes([block_bytes[2], block_bytes[3]]), firings.encoder_cdeg[firing]);
        // The lowest laser of all is number 38, the seventh of the lower bank; number 6 is the lowest of the upper.
        let lowest_of_bank = if lower == 1 { 0 } else { 32 };
        let seventh = &block_bytes[4 + 3 * 6..][..3];
        assert_eq!(u16::from_le_bytes([seventh[0], seventh[1]]), firings.range_2mm[lowest_of_bank][firing]);
        assert_eq!(seventh[2], firings.intensity[lowest_of_bank][firing]);
    }
    // 3 s past the hour.
    assert_eq!(payload[1200..1204], 3_000_000_u32.to_le_bytes());
}

#[test]
fn an_even_clock_comes_back_to_two_nanoseconds() {
    for (count, rate_hz) in [(1, 7800.0), (5, 7800.0), (6, 20_000.0), (601, 7800.0), (3000, 20_833.0), (77, 100.0)] {
        let firings = drive(count, rate_hz);
        let bytes = capture(&firings);
        let (back, tally) = read(&bytes).unwrap();
        let off_s = compare(&firings, &back);
        assert!(off_s < 2e-9, "{count} at {rate_hz} Hz: {off_s}");
        assert_eq!((tally.skipped, tally.gaps, tally.lost_packets, tally.jumps), (0, 0, 0, 0));
        // What was read is written as it was.
        assert_eq!(capture(&back), bytes);
        if count > 20 {
            assert_eq!(bytes.len(), FILE_HEADER + count.div_ceil(6) * PACKET);
        }
    }
}

#[test]
fn firings_without_intensity_and_none_at_all_come_back() {
    let firings = Firings { intensity: Vec::new(), ..drive(20, 7800.0) };
    compare(&firings, &read(&capture(&firings)).unwrap().0);
    let none = Firings { range_2mm: vec![Vec::new(); 64], ..Firings::default() };
    assert_eq!(read(&capture(&none)).unwrap(), (none, Tally::default()));
}

#[test]
fn another_units_order_is_that_of_its_banks() {
    let firings = drive(6, 7800.0);
    let mut bytes = Vec::new();
    packets::write(&firings, &Order::ART, &mut bytes).unwrap();
    compare(&firings, &packets::read(&bytes[..], &Order::ART, Start::Zero).unwrap().0);
    // Read as if the upper bank looked above, the banks have changed places.
    let (other, _) = read(&bytes).unwrap();
    assert_eq!((&other.range_2mm[..32], &other.range_2mm[32..]), (&firings.range_2mm[32..], &firings.range_2mm[..32]));
}

#[test]
fn a_log_may_begin_with_the_first_packet() {
    let mut firings = drive(60, 7800.0);
    firings.t_s.iter_mut().for_each(|t_s| *t_s += 1_317_000_000.0 - 3.0);
    let bytes = capture(&firings);
    let (back, _) = packets::read(&bytes[..], &Order::UPPER_ABOVE, Start::FirstPacket).unwrap();
    assert_eq!(back.t_s[0], 0.0);
    // As finely as a number of such size is kept.
    let off = |(i, t_s): (usize, &f64)| (t_s - i as f64 / 7800.0).abs();
    assert!(back.t_s.iter().enumerate().map(off).fold(0.0, f64::max) < 3e-7);
}

#[test]
fn what_packets_cannot_hold_is_refused() {
    let spoilt = |spoil: &dyn Fn(&mut Firings)| {
        let mut firings = drive(9, 7800.0);
        spoil(&mut firings);
        let refused = packets::write(&firings, &Order::UPPER_ABOVE, Vec::new()).unwrap_err();
        assert_eq!(packets::check(&firings).unwrap_err().to_string(), refused.to_string());
        refused.to_string()
    };
    assert_eq!(spoilt(&|f| f.t_s[0] = -0.5), "firing 0: its time must lie from 0 to 4294967295 s, unlike -0.5");
    assert!(spoilt(&|f| f.t_s[8] = 5e9).starts_with("firing 8: its time must lie"));
    assert_eq!(spoilt(&|f| f.encoder_cdeg.truncate(1)), "the encoder has 1 rows, not the 9 of the firing times");
    let few = |f: &mut Firings| {
        f.range_2mm.truncate(32);
        f.intensity.truncate(32);
    };
    assert_eq!(spoilt(&few), "an HDL-64E has 64 lasers, not 32");
}

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

/// A frame of the file's, as packet.
fn record(bytes: &[u8], number: usize) -> Vec<u8> {
    bytes[FILE_HEADER + (number - 1) * PACKET..][..PACKET].to_vec()
}

fn file(bytes: &[u8], records: &[Vec<u8>]) -> Vec<u8> {
    [&bytes[..FILE_HEADER], &records.concat()].concat()
}

/// A packet with its frame changed and its lengths right.
fn reframed(record: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut frame = record[16..].to_vec();
    change(&mut frame);
    let length = (frame.len() as u32).to_le_bytes();
    [&record[..8], &length, &length, &frame].concat()
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

/// Each with words of the error that it must give.
#[test]
fn every_broken_capture_names_its_packet() {
    let bytes = capture(&drive(60, 7800.0));
    let third = FILE_HEADER + 2 * PACKET;
    let payload = third + 16 + 42;
    let set = |at: usize, with: &[u8]| {
        let mut bytes = bytes.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        bytes
    };
    // Without a checksum, so that the block is looked at.
    let block = |at: usize, with: &[u8]| {
        let mut bytes = set(payload + at, with);
        bytes[payload - 2..payload].fill(0);
        bytes
    };
    let mut swapped: Vec<Vec<u8>> = (1..=10).map(|number| record(&bytes, number)).collect();
    swapped.swap(4, 5);
    let snapped = reframed(&record(&bytes, 3), |f| f.truncate(1000));
    let mut snapped = [bytes[..third].to_vec(), snapped].concat();
    snapped[third + 12..third + 16].copy_from_slice(&1248_u32.to_le_bytes());
    #[rustfmt::skip]
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (Vec::new(), "the file seems to have been cut short: 24 bytes must follow, not 0"),
        (bytes[..10].to_vec(), "24 bytes must follow, not 10"),
        (b"t_s,v_m_per_s\n0.0,1.0\nand so on".to_vec(), "must be a pcap file (magic a1b2c3d4 or a1b23c4d), not one that begins with 745f732c"),
        (set(0, &[0x0a, 0x0d, 0x0d, 0x0a]), "must be a classic pcap file, not pcapng"),
        (set(4, &[9, 0]), "the pcap format must be of version 2, not 9"),
        (set(20, &[113]), "frames must be Ethernet's (link type 1), not of link type 113"),
        (bytes[..third + 7].to_vec(), "packet 3: the file seems to have been cut short: 16 bytes must follow, not 7"),
        (bytes[..third + 16].to_vec(), "packet 3: the file seems to have been cut short: 1248 bytes must follow, not 0"),
        (bytes[..third + 900].to_vec(), "packet 3: the file seems to have been cut short: 1248 bytes must follow, not 884"),
        (set(third + 8, &[255, 255, 255, 255]), "packet 3: must not be longer than 262144 bytes, as 4294967295 would be"),
        (set(third + 4, &1_000_000_000_u32.to_le_bytes()), "packet 3: the stamp's fraction must be less than a second, not 1000000000 parts of 1000000000"),
        (set(third, &[2]), "packet 3: times must not decrease: 2.001538462 s follows 3.000769231 s"),
        (file(&bytes, &swapped), "packet 6: times must not decrease"),
        (snapped, "packet 3: must have been captured whole: 1000 of 1248 bytes are there"),
        (set(payload + 777, &[bytes[payload + 777] ^ 1]), "packet 3: the UDP checksum must be"),
        (block(0, &[0xff, 0xdd]), "packet 3: block 0 must begin with 0xeeff, not 0xddff"),
        (block(500, &[0, 0]), "packet 3: block 5 must begin with 0xddff, not 0x0000"),
        (block(300, &[0xff, 0xee]), "packet 3: block 2 must be followed by a lower block"),
        (block(402, &36_000_u16.to_le_bytes()), "packet 3: block 4: the encoder's angle must be less than 36000 hundredths of a degree, not 36000"),
        (block(502, &[1, 1]), "packet 3: block 5 must have the angle of the block before it, 646, not 257"),
    ];
    for (bytes, expected) in cases {
        let error = read(&bytes).expect_err(expected).to_string();
        assert!(error.contains(expected), "\nwanted: {expected}\nfound:  {error}");
    }
}

/// One random injury.
fn injure(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let at = rng.random_range(0..bytes.len().max(1));
    let span = at..(at + rng.random_range(1..3 * PACKET)).min(bytes.len());
    let packet = |rng: &mut Rng, bytes: &[u8]| {
        let packets = bytes.len().saturating_sub(FILE_HEADER) / PACKET;
        let first = FILE_HEADER + rng.random_range(0..packets.max(1)) * PACKET;
        first.min(bytes.len())..(first + PACKET).min(bytes.len())
    };
    match rng.random_range(0..8) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(span)),
        2 => {
            let copy = bytes[span].to_vec();
            bytes.splice(at..at, copy);
        }
        3 => bytes[span].iter_mut().for_each(|byte| *byte = rng.random()),
        4 => drop(bytes.drain(packet(rng, bytes))),
        5 => {
            let copy = bytes[packet(rng, bytes)].to_vec();
            let to = packet(rng, bytes).start;
            bytes.splice(to..to, copy);
        }
        6 => {
            // The headers of a packet and its frame.
            let at = packet(rng, bytes).start + rng.random_range(0..58);
            if let Some(byte) = bytes.get_mut(at) {
                *byte = rng.random();
            }
        }
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << rng.random_range(0..8);
            }
        }
    }
}

#[test]
fn injured_captures_give_an_error_with_its_packet_or_sound_firings() {
    let mut rng = Seed(3).stream("packets");
    let bytes = capture(&drive(50, 7800.0));
    let (mut refused, mut sound) = (0, 0);
    for round in 0..3000 {
        let mut injured = bytes.clone();
        (0..=round % 3).for_each(|_| injure(&mut injured, &mut rng));
        match read(&injured) {
            Err(error) => {
                refused += 1;
                assert!(error.packet <= injured.len() as u64 / 16 + 1 && error.to_string().len() < 200, "{error}");
            }
            Ok((firings, tally)) => {
                sound += 1;
                firings.check().unwrap();
                assert!(firings.len() as u64 <= 6 * tally.packets && firings.len() <= injured.len() / 200);
                // Sound is what can be written again and reads the same.
                assert!(compare(&firings, &read(&capture(&firings)).unwrap().0) < 1e-6);
            }
        }
    }
    assert!(refused >= 1000 && sound >= 300, "{refused} refused, {sound} sound");
}

/// Times that a capture can stamp: even, uneven, standing still, with gaps.
fn times() -> impl Strategy<Value = Vec<f64>> {
    let step = prop_oneof![8 => Just(1.0 / 7800.0), 1 => 0.0..2e-4, 1 => Just(0.0), 1 => 0.0..100.0];
    (0.0..1e5, proptest::collection::vec(step, 0..80)).prop_map(|(start, steps)| {
        let next = |t_s: &mut f64, step: f64| {
            *t_s += step;
            Some(*t_s)
        };
        steps.into_iter().scan(start, next).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn any_firings_come_back(t_s in times(), seed in any::<u64>(), recorded in any::<bool>()) {
        let mut rng = Seed(seed).stream("firings");
        let count = t_s.len();
        let encoder_cdeg = (0..count).map(|_| rng.random_range(0..36_000)).collect();
        let range_2mm = (0..64).map(|_| (0..count).map(|_| rng.random()).collect()).collect();
        let mut intensity = vec![vec![0; count]; if recorded && count > 0 { 64 } else { 0 }];
        for value in intensity.iter_mut().flatten() {
            *value = rng.random_range(1..=255);
        }
        let firings = Firings { t_s, encoder_cdeg, range_2mm, intensity };
        let (back, tally) = read(&capture(&firings)).unwrap();
        // 100 ns, and as finely as a number of such size is kept.
        prop_assert!(compare(&firings, &back) < 1.01e-7);
        prop_assert_eq!(tally.skipped, 0);
        back.check().unwrap();
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..3000), magic in 0..5usize) {
        const MAGICS: [[u8; 4]; 4] =
            [[0x4d, 0x3c, 0xb2, 0xa1], [0xd4, 0xc3, 0xb2, 0xa1], [0xa1, 0xb2, 0x3c, 0x4d], [0xa1, 0xb2, 0xc3, 0xd4]];
        let mut file = bytes;
        if let Some(magic) = MAGICS.get(magic) {
            let header = [&magic[..], &[2, 0, 2, 0], &[0; 12], &[1, 0, 1, 0]].concat();
            file.splice(0..0, header);
        }
        if let Ok((firings, _)) = read(&file) {
            firings.check().unwrap();
        }
    }
}

#[test]
fn a_data_set_keeps_its_firings_and_names_the_packet_that_is_broken() {
    let dir = tempfile::tempdir().unwrap();
    let set = dir.path().join("set");
    let known = Known { robot: "car".to_owned(), ..Known::default() };
    let firings = drive(100, 7800.0);
    let recorded = Some(Arc::new(firings.clone()));
    let log = Log { known: Arc::new(known), firings: recorded, ..Log::default() };
    let mut dataset = Dataset { log, ..Dataset::default() };
    store::write(&dataset, &set).unwrap();
    let first = store::read(&set).unwrap();
    assert!(compare(&firings, first.log.firings.as_ref().unwrap()) < 2e-9);
    // What was read is read again to the bit.
    store::write(&first, &set).unwrap();
    assert_eq!(store::read(&set).unwrap(), first);

    let pcap = set.join("lidar.pcap");
    let mut bytes = std::fs::read(&pcap).unwrap();
    bytes.truncate(FILE_HEADER + 2 * PACKET + 100);
    std::fs::write(&pcap, &bytes).unwrap();
    let error = store::read(&set).unwrap_err().to_string();
    assert!(error.contains("lidar.pcap: packet 3: the file seems to have been cut short"), "{error}");
    bytes.truncate(FILE_HEADER + 2 * PACKET);
    std::fs::write(&pcap, &bytes).unwrap();
    let (_, tally) = store::read_lidar(&set).unwrap().unwrap();
    assert_eq!(tally.packets, 2);

    // Unfit firings touch nothing.
    dataset.log.firings = Some(Arc::new(Firings { t_s: vec![-1.0; 100], ..firings }));
    let refused = store::write(&dataset, &set).unwrap_err().to_string();
    assert!(refused.contains("lidar.pcap: firing 0: its time must lie from 0"), "{refused}");
    assert_eq!(std::fs::read(&pcap).unwrap(), bytes);
    // Nor do firings of another unit than the data set tells of.
    let velodyne = Velodyne {
        vertical_angles_rad: vec![-0.4, 0.0],
        firing_rate_hz: 7800.0,
        turn_rate_hz: 10.0,
        sensor_height_m: 2.0,
    };
    dataset.log.firings = first.log.firings;
    dataset.log.known = Arc::new(Known { velodyne: Some(velodyne), ..(*dataset.log.known).clone() });
    let refused = store::write(&dataset, &set).unwrap_err().to_string();
    assert!(
        refused.contains("dataset.toml: vertical_angles_rad must have 64, as lidar.pcap has lasers, values, not 2")
    );
    assert_eq!(std::fs::read(&pcap).unwrap(), bytes);
    dataset.log.firings = None;
    store::write(&dataset, &set).unwrap();
    assert!(!pcap.exists());
}
