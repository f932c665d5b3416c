//! What a scenario's world writes, for examples that peers are compared with.

use std::error::Error;
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
