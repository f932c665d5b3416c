//! What 64 lasers saw during a drive, and how adjacent ones correlate over all lags, for `benches/peers/correlation.py`.
//!
//! ```text
//! cargo run --example laser_lags -- FOLDER scenarios/car.toml 1000 200
//! ```
//!
//! Writes `signals.i16` into FOLDER (laser by laser; -32768: no return) and prints a line of JSON. Then, for every line on its standard
//! input: `correlate` correlates all adjacent pairs by Fourier transform, prints seconds of the thread's own time and writes `coefficients.f64`;
//! `direct N` sums N of the pairs, spread evenly, by the definition at every lag, prints the seconds, the pairs and how far the others
//! are off.

#[path = "beside_peers/mod.rs"]
mod beside_peers;

use std::error::Error;
use std::f64::consts::PI;
use std::io::BufRead;
use std::path::{Path, PathBuf};

use asami_learners::lidar::{Drive, Sensor, pairs};
use asami_math::correlation::{Correlogram, Overlap, correlograms, lags_to};
use serde_json::{Value, json};

use beside_peers::{simulated, thread_s, write};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, scenario, seed, seconds] = &arguments[..] else {
        return Err("laser_lags FOLDER SCENARIO SEED SECONDS".into());
    };
    let folder = PathBuf::from(folder);
    let dataset = simulated(Path::new(scenario), seed.parse()?, seconds.parse()?)?;
    let drive = Drive::try_from(&dataset.log)?;
    let shaping = Sensor::published().shaping;
    let signals: Vec<Vec<i16>> = (0..drive.lasers()).map(|laser| shaping.of(&drive, laser, 0.0)).collect();
    let slices: Vec<&[i16]> = signals.iter().map(Vec::as_slice).collect();
    let (adjacent, lags) = (pairs(drive.lasers(), 1), lags_to(drive.firings_in(PI)));
    write(&folder.join("signals.i16"), signals.iter().flatten().map(|v| v.to_le_bytes()))?;
    let about = json!({ "lasers": signals.len(), "firings": drive.firings.len(), "most_lag": lags.end() });
    println!("{about}");

    let mut found: Vec<Correlogram> = Vec::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let told = match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["direct", count] => direct(&slices, &adjacent, &found, count.parse()?),
            _ => {
                let begun_s = thread_s();
                found = correlograms(&slices, &adjacent, lags.clone());
                let seconds = thread_s() - begun_s;
                let all = found.iter().flat_map(|it| &it.coefficients);
                write(&folder.join("coefficients.f64"), all.map(|v| v.to_le_bytes()))?;
                json!({ "seconds": seconds, "pairs": adjacent.len() })
            }
        };
        println!("{told}");
    }
    Ok(())
}

fn direct(signals: &[&[i16]], pairs: &[(usize, usize)], found: &[Correlogram], count: usize) -> Value {
    let count = count.min(found.len());
    let (mut spent_s, mut off, mut miscounted, mut looked_at) = (0.0, 0.0f64, 0i64, Vec::new());
    for k in 0..count {
        let at = (found.len() - 1) * k / (count - 1).max(1);
        let ((a, b), correlogram) = (pairs[at], &found[at]);
        let lags = (0..).map(|i| correlogram.first_lag + i).take(correlogram.counts.len());
        let begun_s = thread_s();
        let sums: Vec<Overlap> = lags.map(|lag| Overlap::at(signals[a], signals[b], lag)).collect();
        spent_s += thread_s() - begun_s;
        for ((sum, count), coefficient) in sums.iter().zip(&correlogram.counts).zip(&correlogram.coefficients) {
            miscounted = miscounted.max((sum.count - count).abs());
            if let Some(exact) = sum.coefficient() {
                off = if coefficient.is_nan() { f64::INFINITY } else { off.max((exact - coefficient).abs()) };
            }
        }
        looked_at.push(at);
    }
    json!({ "seconds": spent_s, "pairs": looked_at, "off": off, "miscounted": miscounted })
}
