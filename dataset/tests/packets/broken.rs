//! Captures that are broken.

use super::*;

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
