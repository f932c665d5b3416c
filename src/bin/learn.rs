//! `cargo run --bin learn DATASET --learner X`: one learner on one data set.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::learn::{Request, learn};
use asami::scenario::Start;
use asami::verb::{self, Window};
use asami_dataset::{Models, store};
use asami_learners::Verdict;
use clap::Parser;

/// Runs one learner on a data set's log and writes the learned models as a file.
///
/// The learner is given the log alone, never the truth. How it went goes to stderr.
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:
  learn results/walk --learner canonical
  learn results/walk --learner algorithm1 --start sgn --set gamma=0.9995 -o sgn.toml
  learn results/field --learner em_best --start attempted
  list learners        every learner with its parameters"
)]
struct Arguments {
    /// The data set's folder
    dataset: PathBuf,
    /// The learner
    #[arg(long, value_name = "NAME")]
    learner: String,
    /// Starting models: chapter 3's c, sgn or one; chapter 4's published, attempted, ...
    #[arg(long, value_parser = start)]
    start: Option<Start>,
    /// Models that the learner is given, to start from or as known
    #[arg(long, value_name = "MODELS")]
    given: Option<PathBuf>,
    /// A parameter of the learner
    #[arg(long, value_name = "PARAM=VALUE", value_parser = verb::assignment)]
    set: Vec<(String, f64)>,
    #[command(flatten)]
    window: Window,
    /// Seed of the learner's own draws
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The file to write
    #[arg(short, long, value_name = "FILE", default_value = "models.toml")]
    output: PathBuf,
}

fn start(text: &str) -> Result<Start, String> {
    let starts: Vec<Start> = [Start::C, Start::Sgn, Start::One].into_iter().chain(Start::CHAPTER_4).collect();
    let names = || starts.iter().map(|start| start.name()).collect::<Vec<_>>().join(", ");
    starts.iter().copied().find(|start| start.name() == text).ok_or_else(|| format!("must be one of {}", names()))
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let log = arguments.window.of(&verb::dataset(&arguments.dataset)?.log);
        let given = match &arguments.given {
            Some(path) => store::read_models(path).map_err(verb::shown)?.1,
            None => Models::default(),
        };
        let request = Request {
            learner: arguments.learner,
            with: arguments.set.into_iter().collect(),
            given,
            start: arguments.start,
            seed: arguments.seed,
        };
        let learned = learn(&log, &request).map_err(verb::plain)?;
        learned.lacks.iter().for_each(|lack| eprintln!("lacks: {lack}"));
        match learned.verdict {
            Verdict::Converged => eprintln!("converged, as far as the learner can tell"),
            Verdict::Diverged { rule } => eprintln!("diverged: {rule}"),
        }
        store::write_models(&request.learner, &learned.models, &arguments.output).map_err(verb::plain)?;
        verb::print(&format!("{}\n", arguments.output.display()));
        Ok(verb::Ending::Done)
    })
}
