//! What examples that peers are compared with have in common.

use std::error::Error;
use std::io::Write;
use std::path::Path;

use asami::generate::generate;
use asami::scenario::{self, Origin};
use asami_dataset::{Dataset, Seed};

/// A scenario's world over so many seconds.
pub fn simulated(scenario: &Path, seed: u64, seconds: f64) -> Result<Dataset, Box<dyn Error>> {
    let mut scenario = scenario::read(scenario).map_err(|bad| bad.to_string())?;
    if let Origin::Simulated(simulation) = &mut scenario.origin {
        simulation.duration_s = seconds;
    }
    Ok(generate(&scenario, &[], Seed(seed))?)
}

/// The processor's time that this thread has had, where the system tells; else the time of day.
pub fn thread_s() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat");
    let ran_ns = told.ok().and_then(|told| told.split_whitespace().next()?.parse::<f64>().ok());
    let day = || std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |since| since.as_secs_f64());
    ran_ns.map_or_else(day, |ran_ns| 1e-9 * ran_ns)
}

/// Writes numbers one after another.
pub fn write<const N: usize>(path: &Path, numbers: impl Iterator<Item = [u8; N]>) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    for number in numbers {
        file.write_all(&number)?;
    }
    file.flush()
}
