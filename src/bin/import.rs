//! `cargo run --bin import FORMAT SOURCE -o DIR`: a public log becomes a data set.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::{import, verb};
use asami_dataset::store;
use clap::Parser;
use clap::builder::PossibleValuesParser;

/// Reads a public log format and writes it as a data set (format version 1).
///
/// What was assumed and found goes to stderr.
#[derive(Parser)]
#[command(
    version,
    after_help = "Example:\n  import barfoot-1d ../shared/data/barfoot_1d -o results/barfoot_1d_log\n  import mrclam ../shared/data/mrclam6 --robot 3 -o results/mrclam_3_log"
)]
struct Arguments {
    /// The format of the source
    #[arg(value_parser = PossibleValuesParser::new(import::catalogue().iter().map(|importer| importer.name)))]
    format: String,
    /// The log: a file, or the folder that holds it
    source: PathBuf,
    /// Whose log, where the source holds those of several robots
    #[arg(long, value_name = "NUMBER")]
    robot: Option<u16>,
    /// The folder to write; its data set, if any, is replaced
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let importer = import::catalogue().into_iter().find(|importer| importer.name == arguments.format);
        let importer = importer.ok_or_else(|| miette::miette!("there is no importer {}", arguments.format))?;
        let imported = importer.import(&arguments.source, arguments.robot).map_err(verb::plain)?;
        imported.notes.iter().for_each(|note| eprintln!("{note}"));
        store::write(&imported.dataset, &arguments.output).map_err(verb::plain)?;
        verb::print(&format!("{}\n", arguments.output.display()));
        Ok(verb::Ending::Done)
    })
}
