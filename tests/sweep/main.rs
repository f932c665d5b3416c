//! Sweeps: what they write is what was agreed, the same bytes however they are run, and says what the trials say.

mod car;
mod line;
mod plane;
mod verb;

use std::collections::BTreeMap;
use std::path::Path;

use asami::scenario;
use asami::sweep::verb::{Asked, carry_out, plan};
use asami::sweep::{Finished, Options, Silent};

fn options(out: &Path, jobs: usize) -> Options {
    Options { out: out.to_owned(), jobs: Some(jobs), program: "test".into() }
}

/// Sweeps a scenario of this text.
fn sweep(text: &str, out: &Path, jobs: usize) -> Finished {
    let scenario = scenario::parse("test", "test.toml", text).expect("sound");
    let plan = plan(scenario, &Asked { out: out.to_owned(), ..Asked::default() }).expect("no data are needed");
    carry_out(&plan, &options(out, jobs), &Silent).expect("files can be written")
}

/// The rows of a table, by column.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(path).expect("there").deserialize().collect::<Result<_, _>>().expect("a table")
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}
