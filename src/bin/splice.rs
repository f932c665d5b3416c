//! `cargo run --bin splice`: puts the reference results into the README and the documents beside them.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::splice;
use clap::Parser;

/// Puts the committed reference results between the marks of the README and the documents beside them.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Writes nothing; exits with 1 if some document is stale.
    #[arg(long)]
    check: bool,
    /// The repository's root.
    #[arg(long, default_value = ".")]
    root: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let spliced = splice::documents(&arguments.root).and_then(|documents| {
        if arguments.check {
            return Ok(documents.into_iter().filter(splice::Document::is_stale).map(|stale| stale.path).collect());
        }
        splice::write(&arguments.root, &documents)
    });
    let (says, code) = if arguments.check { ("is stale: run splice", 1) } else { ("written", 0) };
    match spliced {
        Ok(stale) => {
            stale.iter().for_each(|path| println!("{} {says}", path.display()));
            ExitCode::from(if stale.is_empty() { 0 } else { code })
        }
        Err(error) => {
            eprintln!("splice: {error}");
            ExitCode::from(2)
        }
    }
}
