//! A capture of a scanner's packets.

use std::fs::{self, File};

use asami::import::ImportError;
use asami::import::hdl64e::read;
use asami_dataset::Firings;
use asami_dataset::packets::{self, Order};

use crate::{import, said, unspaced};

/// Two turns of 600 firings, ten turns a second.
fn firings() -> Firings {
    let n = 1200;
    Firings {
        t_s: (0..n).map(|i| f64::from(i) / 6000.0).collect(),
        encoder_cdeg: (0..n).map(|i| (i % 600 * 60) as u16).collect(),
        range_2mm: (0..64).map(|laser| (0..n).map(|i| (1000 + 100 * laser + i) as u16).collect()).collect(),
        intensity: Vec::new(),
    }
}

#[test]
fn a_capture_becomes_firings_and_its_tally_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("capture.pcap");
    packets::write(&firings(), &Order::UPPER_ABOVE, File::create(&file).unwrap()).unwrap();
    let found = read(dir.path()).unwrap().dataset.log;
    let (made, read) = (firings(), found.firings.unwrap());
    assert_eq!((&read.range_2mm, &read.encoder_cdeg), (&made.range_2mm, &made.encoder_cdeg));
    let unit = found.known.velodyne.clone().unwrap();
    assert!((unit.turn_rate_hz - 10.0).abs() < 0.05 && (unit.firing_rate_hz / 6000.0 - 1.0).abs() < 0.005, "{unit:?}");
    assert_eq!(unit.vertical_angles_rad.len(), 64);
    let run = import("hdl64e-pcap", &file, None, &dir.path().join("set"));
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    for part in
        ["data packets, 0 others passed over", "0 data packets missing in 0 gaps", "assumed: lasers are numbered"]
    {
        assert!(said(&run).contains(&unspaced(part)), "{part}: {}", said(&run));
    }
}

#[test]
fn what_is_no_capture_is_refused_with_the_packet() {
    let dir = tempfile::tempdir().unwrap();
    assert!(matches!(read(dir.path()), Err(ImportError::Absent { .. })));
    let file = dir.path().join("capture.pcap");
    packets::write(&firings(), &Order::UPPER_ABOVE, File::create(&file).unwrap()).unwrap();
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let said = read(&file).unwrap_err().to_string();
    assert!(said.contains("packet "), "{said}");
    fs::write(&file, "no capture at all, but long enough for a header").unwrap();
    assert!(matches!(read(&file), Err(ImportError::Unreadable { .. })));
    fs::write(&file, &bytes[..24]).unwrap();
    assert!(matches!(read(&file), Err(ImportError::TooShort { found: 0, .. })));
}
