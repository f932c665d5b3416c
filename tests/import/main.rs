//! Importers: small sources made here, and the real logs where they are at hand.

mod barfoot_1d;
mod barfoot_2d;
mod mrclam;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the verb.
fn import(format: &str, source: &Path, robot: Option<u16>, out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_import"));
    command.arg(format).arg(source).arg("-o").arg(out);
    if let Some(robot) = robot {
        command.arg("--robot").arg(robot.to_string());
    }
    command.output().unwrap()
}

/// What a verb said on stderr, without blanks: reports wrap long lines.
fn said(run: &Output) -> String {
    unspaced(&String::from_utf8_lossy(&run.stderr))
}

fn unspaced(text: &str) -> String {
    text.split_whitespace().filter(|word| *word != "│").collect()
}

/// A folder of real data beside the project; `None`, saying so, where it is absent.
fn real(name: &str) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if !source.exists() {
        eprintln!("skipped: {} is absent", source.display());
    }
    source.exists().then_some(source)
}
