//! `sweep SCENARIO`: all trials of a scenario, as the dissertation's table.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use asami::scenario;
use asami::sweep::progress::Progress;
use asami::sweep::verb::{self, Asked};
use asami::sweep::{Options, manifest};
use clap::Parser;

/// Runs every trial of a scenario: logs across seeds, learners, starting models.
#[derive(Parser)]
#[command(
    version,
    after_help = "Exit status: 0 done, 1 our bug, 2 bad scenario or missing data, 3 some trial errored."
)]
struct Cli {
    /// The scenario file.
    scenario: PathBuf,
    /// Where results go [default: results/<scenario>]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// How many seeds, instead of the scenario's number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: Option<u32>,
    /// The recorded data, instead of the scenario's `source`
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match sweep(cli) {
        Ok(code) => code,
        Err(Failure::Users(report)) => {
            eprintln!("{report:?}");
            ExitCode::from(2)
        }
        Err(Failure::Ours(report)) => {
            eprintln!("{report:?}");
            ExitCode::from(1)
        }
    }
}

/// Whose it is to mend.
enum Failure {
    Users(miette::Report),
    Ours(miette::Report),
}

fn sweep(cli: Cli) -> Result<ExitCode, Failure> {
    let scenario = scenario::read(&cli.scenario).map_err(|bad| Failure::Users(bad.into()))?;
    let out = cli.out.unwrap_or_else(|| PathBuf::from("results").join(&scenario.name));
    let asked = Asked { seeds: cli.seeds, data: cli.data };
    let plan = verb::plan(scenario, &asked).map_err(|error| Failure::Users(miette::miette!("{error}")))?;
    let options = Options { out, jobs: cli.jobs.map(usize::from), program: manifest::program() };
    let outcome = verb::carry_out(&plan, &options, &Progress::default())
        .map_err(|error| Failure::Ours(miette::miette!("{error}")))?;
    // A closed pipe is the reader's wish, not a failure.
    let _ = std::io::stdout().write_all(outcome.text().as_bytes());
    eprintln!("written to {}", options.out.display());
    Ok(if outcome.results.has_errors() { ExitCode::from(3) } else { ExitCode::SUCCESS })
}
