//! Firings come back as they were.

use super::*;

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
