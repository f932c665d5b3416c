//! `cargo run --bin list [effects|learners|scenarios|robots|importers]`: the catalogue.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::list::Kind;
use asami::verb;
use clap::Parser;

/// Prints what there is: names, parameters with defaults, ranges and units, sources.
#[derive(Parser)]
#[command(version, after_help = "Examples:\n  list\n  list effects")]
struct Arguments {
    /// What to list [default: everything]
    kind: Option<Kind>,
    /// Where scenario files are
    #[arg(long, value_name = "DIR", default_value = "scenarios")]
    scenarios: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let kinds = arguments.kind.map_or(Kind::ALL.to_vec(), |kind| vec![kind]);
        let texts: Vec<String> = kinds.into_iter().map(|kind| kind.text(&arguments.scenarios)).collect();
        verb::print(&texts.join("\n"));
        Ok(verb::Ending::Done)
    })
}
