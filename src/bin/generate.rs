//! `cargo run --bin generate SCENARIO --seed S -o DIR`: a data set out of a scenario's world.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::generate::{Setting, generate};
use asami::{scenario, verb};
use asami_dataset::{Seed, store};
use clap::Parser;

/// Simulates one log of a scenario and writes it, with its truth, as a data set (format version 1).
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:
  generate scenarios/aibo_1d.toml --seed 7 -o results/walk
  generate scenarios/aibo_1d.toml --seed 7 -o results/slippery --effect ground_friction.ratio=0.4
  list effects        every effect with its parameters"
)]
struct Arguments {
    /// The scenario file
    scenario: PathBuf,
    /// The seed of every draw
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// The folder to write [default: results/SCENARIO-seed-S]; its data set, if any, is replaced
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Switches an effect on, beside the scenario's own
    #[arg(long = "effect", value_name = "NAME.PARAM=VALUE")]
    effects: Vec<Setting>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let scenario = scenario::read(&arguments.scenario)?;
        let seed = arguments.seed;
        let beside = || PathBuf::from("results").join(format!("{}-seed-{seed}", scenario.name));
        let output = arguments.output.unwrap_or_else(beside);
        let dataset = generate(&scenario, &arguments.effects, Seed(seed)).map_err(verb::plain)?;
        store::write(&dataset, &output).map_err(verb::plain)?;
        let (sightings, frames) = (dataset.log.sightings.len(), dataset.log.frames.as_ref().map_or(0, |f| f.len()));
        eprintln!("{} commands, {frames} frames, {sightings} sightings", dataset.log.commands.len());
        if dataset.truth.survey.is_none() {
            eprintln!("no survey of this very world is kept: `score` will go by the true track");
        }
        verb::print(&format!("{}\n", output.display()));
        Ok(verb::Ending::Done)
    })
}
