//! `cargo run --bin score MODELS DATASET`: learned models, from any program, against a data set's truth.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::score;
use asami::verb::{self, Window};
use asami_dataset::store;
use clap::Parser;

/// Scores learned models against a data set's truth: its survey or, for what was not surveyed, the
/// true track under the log.
///
/// Chapter 4's models in the plane are scored as they are. Of chapter 3's, the action model is scored as k A(c), the sensor model as a + b S(o), with the k, a and b that fit
/// best; floors are the best polynomials of the same degree. S(o) is a place that grows as the robot
/// walks forward.
#[derive(Parser)]
#[command(version, after_help = "Example:\n  score models.toml results/walk")]
struct Arguments {
    /// The models, as written by learn or by any other program
    models: PathBuf,
    /// The data set's folder
    dataset: PathBuf,
    #[command(flatten)]
    window: Window,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let (learner, models) = store::read_models(&arguments.models).map_err(verb::shown)?;
        let dataset = verb::dataset(&arguments.dataset)?;
        let log = arguments.window.of(&dataset.log);
        verb::print(&score::table(&learner, &models, &log, &dataset).map_err(verb::plain)?);
        Ok(verb::Ending::Done)
    })
}
