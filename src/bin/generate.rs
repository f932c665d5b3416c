//! `cargo run --bin generate SCENARIO --seed S -o DIR`: a data set out of a scenario's world, or many whose
//! effects nobody is told.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use asami::blind::{Mix, Planting, withhold};
use asami::generate::{Setting, generate, replay};
use asami::scenario::{Origin, Robot, Scenario};
use asami::{scenario, verb};
use asami_dataset::{Command, Log, Seed, store};
use clap::Parser;

/// Simulates one log of a scenario and writes it, with its truth, as a data set (format version 1).
///
/// With --withhold, many logs: none, one or two effects are drawn into each, and what is in them is kept apart from
/// them.
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:
  generate scenarios/aibo_1d.toml --seed 7 -o results/walk
  generate scenarios/plain_2d.toml --duration-s 150 -o results/short
  generate scenarios/aibo_1d.toml --seed 7 -o results/slippery --effect ground_friction.ratio=0.4
  generate scenarios/aibo_1d.toml --withhold --salt 1000 --cases 20 -o results/blind
  generate scenarios/aibo_1d.toml --withhold --salt 1000 --cases 20 -o results/foreign_aibo \\
      --engine 'python3 benches/peers/mujoco_engine.py'
  generate results/gap/with_effect.toml --commands-of results/robot3 -o results/stand_in
  list effects        every effect with its parameters"
)]
struct Arguments {
    /// The scenario file
    scenario: PathBuf,
    /// The seed of every draw [default: 1]
    #[arg(long, value_name = "S", conflicts_with = "withhold")]
    seed: Option<u64>,
    /// The folder to write [default: results/SCENARIO-seed-S, or results/SCENARIO-withheld]; a data set that stands
    /// there is replaced
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Switches an effect on, beside the scenario's own
    #[arg(long = "effect", value_name = "NAME.PARAM=VALUE", conflicts_with = "withhold")]
    effects: Vec<Setting>,
    /// Writes cases/NNN, plain data sets without truth, and keys/NNN, what was planted in them
    #[arg(long, requires = "salt", requires = "cases")]
    withhold: bool,
    /// What every draw of withheld cases follows from; it is written to keys alone
    #[arg(long, value_name = "TEXT", requires = "withhold")]
    salt: Option<String>,
    /// How many withheld cases
    #[arg(long, value_name = "N", requires = "withhold", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    cases: Option<u32>,
    /// The log's length [default: the scenario's]
    #[arg(long, value_name = "S", value_parser = duration)]
    duration_s: Option<f64>,
    /// Tells a robot on wheels what was told in this data set, for as long as that lasts
    #[arg(long, value_name = "DATASET", conflicts_with_all = ["withhold", "engine"])]
    commands_of: Option<PathBuf>,
    /// Puts the Aibo into another program's physics engine, which is told and asked line by line (docs/engines.md)
    #[arg(long, value_name = "COMMAND")]
    engine: Option<String>,
}

fn duration(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (1.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "must lie in 1..=3600 s".to_owned())
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let mut scenario = scenario::read(&arguments.scenario)?;
        let told = arguments.commands_of.as_ref().map(|dir| store::read(dir).map_err(verb::plain)).transpose()?;
        let (commands, told_s) = told.map_or((Vec::new(), None), |it| (it.log.commands.to_vec(), length_s(&it.log)));
        if let (Some(dir), true) = (&arguments.commands_of, commands.is_empty()) {
            miette::bail!("{} has no commands", dir.display());
        }
        if let (Origin::Simulated(simulation), Some(duration_s)) =
            (&mut scenario.origin, arguments.duration_s.or(told_s))
        {
            simulation.duration_s = duration_s;
        }
        if let Some(command) = &arguments.engine {
            put_into(command, &mut scenario)?;
        }
        match (&arguments.salt, arguments.cases) {
            (Some(salt), Some(cases)) => many(&scenario, salt, cases as usize, &arguments),
            _ => one(&scenario, commands, &arguments),
        }
    })
}

/// How long it lasts from its first command on.
fn length_s(log: &Log) -> Option<f64> {
    let (first, (_, end_s)) = (log.commands.first()?, log.span_s()?);
    Some((end_s - first.t_s).max(1.0))
}

/// Has the scenario's robot move in another program's engine.
fn put_into(command: &str, scenario: &mut Scenario) -> Result<(), miette::Report> {
    match &mut scenario.origin {
        Origin::Simulated(simulation) if simulation.robot == Robot::Aibo => {
            simulation.engine = Some(command.split_whitespace().map(str::to_owned).collect());
            Ok(())
        }
        _ => miette::bail!("--engine is for scenarios of a simulated Aibo; {} has none", scenario.name),
    }
}

fn one(scenario: &Scenario, commands: Vec<Command>, arguments: &Arguments) -> Result<verb::Ending, miette::Report> {
    let seed = arguments.seed.unwrap_or(1);
    let beside = || PathBuf::from("results").join(format!("{}-seed-{seed}", scenario.name));
    let output = arguments.output.clone().unwrap_or_else(beside);
    let made = match arguments.commands_of {
        Some(_) => replay(scenario, &arguments.effects, commands, Seed(seed)),
        None => generate(scenario, &arguments.effects, Seed(seed)),
    };
    let dataset = made.map_err(verb::plain)?;
    store::write(&dataset, &output).map_err(verb::plain)?;
    let (sightings, frames) = (dataset.log.sightings.len(), dataset.log.frames.as_ref().map_or(0, |f| f.len()));
    eprintln!("{} commands, {frames} frames, {sightings} sightings", dataset.log.commands.len());
    if dataset.truth.survey.is_none() {
        eprintln!("no survey of this very world is kept: `score` will go by the true track");
    }
    said(&output)
}

fn many(scenario: &Scenario, salt: &str, cases: usize, arguments: &Arguments) -> Result<verb::Ending, miette::Report> {
    let Origin::Simulated(nominal) = &scenario.origin else {
        miette::bail!("scenario {} is about a recorded log, into which nothing can be planted", scenario.name);
    };
    let planting =
        Planting { nominal: (**nominal).clone(), salt: salt.to_owned(), mix: Mix::default(), places: Vec::new() };
    let output = arguments.output.clone();
    let output = output.unwrap_or_else(|| PathBuf::from("results").join(format!("{}-withheld", scenario.name)));
    let heard = |done| {
        if done == cases || done % 10 == 0 {
            eprintln!("{done} of {cases} done");
        }
    };
    withhold::withhold(&planting, &scenario.name, cases, &output, &heard).map_err(verb::plain)?;
    eprintln!("logs in {}, what is in them in {}", withhold::CASES, withhold::KEYS);
    said(&output)
}

fn said(output: &Path) -> Result<verb::Ending, miette::Report> {
    verb::print(&format!("{}\n", output.display()));
    Ok(verb::Ending::Done)
}
