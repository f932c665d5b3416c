//! `cargo run --bin sweep SCENARIO`: all trials of a scenario, as the dissertation's table.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::sweep::progress::Progress;
use asami::sweep::verb::{Asked, carry_out, plan};
use asami::sweep::{Options, manifest};
use asami::{blind, diagnose, real, report, scenario, verb};
use clap::Parser;

/// Runs every trial of a scenario: logs across seeds, learners, starting models.
///
/// Of a blind scenario (study = "blind"): plants effects in its nominal world, lets diagnosers see each log alone, and
/// scores them. Of a pool (study = "pooled"): scores finished blind sweeps together. Of real logs (study = "real"): diagnoses
/// each, and holds what is found against motion capture.
///
/// A stopped sweep goes on where it was. The table goes to stdout, everything else to stderr and DIR.
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:\n  sweep scenarios/aibo_1d.toml --seeds 3 -o results/try\n  \
                  sweep scenarios/blind_plain_2d.toml --seeds 20 -o results/blind_try\n\n\
                  Exit status: 0 done, 1 our bug, 2 bad scenario or missing data, 3 some trial errored."
)]
struct Arguments {
    /// The scenario file
    scenario: PathBuf,
    /// Where results go [default: results/SCENARIO]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// How many seeds, of a blind scenario cases, instead of the scenario's number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: Option<u32>,
    /// Only the rows, of real logs the logs, of this name, as tables have it; may be given again
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// The recorded data, instead of the scenario's `source`; of a blind scenario another program's cases, instead of its
    /// `cases_from`; of a pool where the sweeps' results lie [default: results]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        if let Some(blind) = blind::scenario::read(&arguments.scenario)? {
            return in_the_dark(blind, arguments);
        }
        if let Some(pool) = blind::pool::read(&arguments.scenario)? {
            return in_one_pool(&pool, arguments);
        }
        if let Some(real) = real::scenario::read(&arguments.scenario)? {
            return of_real_robots(real, arguments);
        }
        let scenario = scenario::read(&arguments.scenario)?;
        let out = arguments.output.unwrap_or_else(|| PathBuf::from("results").join(&scenario.name));
        let jobs = arguments.jobs.map(usize::from);
        let asked =
            Asked { seeds: arguments.seeds, data: arguments.data, only: arguments.only, out: out.clone(), jobs };
        let plan = plan(scenario, &asked)?;
        let options = Options { out, jobs, program: manifest::program() };
        let outcome = carry_out(&plan, &options, &Progress::of("learning")).map_err(verb::plain)?;
        verb::print(&outcome.text);
        eprintln!("written to {}", options.out.display());
        Ok(if outcome.has_errors { verb::Ending::TrialErred } else { verb::Ending::Done })
    })
}

/// A blind scenario: of the options, all but that on rows.
fn in_the_dark(mut blind: blind::scenario::Blind, arguments: Arguments) -> Result<verb::Ending, miette::Report> {
    if !arguments.only.is_empty() {
        miette::bail!("--only is not for blind scenarios");
    }
    match (&mut blind.asked.cases_from, arguments.data) {
        (Some(folder), Some(data)) => *folder = data.display().to_string(),
        (None, Some(_)) => miette::bail!("--data is for scenarios of recorded logs, or of another program's cases"),
        _ => {}
    }
    if let Some(cases) = arguments.seeds {
        blind.asked.cases = cases as usize;
    }
    // What is missing is said before minutes go into a library.
    blind::folder::Folder::of(&blind).map_err(verb::plain)?;
    let out = arguments.output.unwrap_or_else(|| PathBuf::from("results").join(&blind.name));
    let options = Options { out, jobs: arguments.jobs.map(usize::from), program: manifest::program() };
    let libraries = PathBuf::from("results/library");
    let listener = diagnose::progress::Progress::default();
    let field = blind::field::Field::new(&blind, &libraries, &listener).map_err(verb::plain)?;
    let results = blind::walk::run(&blind, &field, &options, &Progress::of("diagnosing")).map_err(verb::plain)?;
    let outcome = report::blind::write(&results, &options.program, &options.out).map_err(verb::plain)?;
    verb::print(&outcome.text);
    eprintln!("written to {}", options.out.display());
    Ok(if outcome.has_errors { verb::Ending::TrialErred } else { verb::Ending::Done })
}

/// Finished blind sweeps together: of the options, where they lie and where results go.
fn in_one_pool(pool: &blind::pool::Pool, arguments: Arguments) -> Result<verb::Ending, miette::Report> {
    if arguments.seeds.is_some() || !arguments.only.is_empty() {
        miette::bail!("--seeds and --only are for the scenarios that {} pools", pool.name);
    }
    let swept = arguments.data.unwrap_or_else(|| PathBuf::from("results"));
    let results = pool.gathered(&swept).map_err(verb::plain)?;
    let out = arguments.output.unwrap_or_else(|| PathBuf::from("results").join(&pool.name));
    let outcome = report::blind::write(&results, &manifest::program(), &out).map_err(verb::plain)?;
    verb::print(&outcome.text);
    eprintln!("written to {}", out.display());
    Ok(if outcome.has_errors { verb::Ending::TrialErred } else { verb::Ending::Done })
}

/// Real logs: of the options, all but the number of seeds.
fn of_real_robots(mut real: real::scenario::Real, arguments: Arguments) -> Result<verb::Ending, miette::Report> {
    if arguments.seeds.is_some() {
        miette::bail!("--seeds is for simulated scenarios; {} is about recordings", real.name);
    }
    if let Some(unknown) = arguments.only.iter().find(|name| !real.asked.logs.iter().any(|log| log.name == **name)) {
        miette::bail!("{} has no log called {unknown}", real.name);
    }
    if !arguments.only.is_empty() {
        real.asked.logs.retain(|log| arguments.only.contains(&log.name));
    }
    if arguments.data.is_some() && real.asked.logs.len() > 1 {
        miette::bail!("--data is the place of one log: say which with --only NAME");
    }
    let out = arguments.output.unwrap_or_else(|| PathBuf::from("results").join(&real.name));
    let options = Options { out, jobs: arguments.jobs.map(usize::from), program: manifest::program() };
    let hears = (&Progress::of("diagnosing") as &_, &diagnose::progress::Progress::default() as &_);
    let libraries = PathBuf::from("results/library");
    let results = real::walk::run(&real, arguments.data.as_deref(), &libraries, &options, hears)?;
    let outcome = real::tables::write(&results, &options.program, &options.out).map_err(verb::plain)?;
    verb::print(&outcome.text);
    eprintln!("written to {}", options.out.display());
    Ok(if outcome.has_errors { verb::Ending::TrialErred } else { verb::Ending::Done })
}
