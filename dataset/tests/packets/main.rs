//! Firings as captures and back, and captures that are broken, foreign or lack packets.

mod broken;
mod foreign;
mod round_trip;
mod stored;

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
