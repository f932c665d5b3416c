//! Importers: small sources made here, and the real logs where they are at hand.

mod av21;
mod barfoot_1d;
mod barfoot_2d;
mod hdl64e;
mod kitti;
mod mapped;
mod mrclam;

use std::collections::BTreeMap;
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

/// The files of a source that was made here, by name.
type Source = BTreeMap<&'static str, String>;

fn write(files: &Source, dir: &Path) {
    for (name, text) in files {
        std::fs::write(dir.join(name), text).unwrap();
    }
}

/// Whether the verb refuses `source` in these words.
fn refused(format: &str, source: &Path, robot: Option<u16>, expected: &str) {
    let run = import(format, source, robot, &source.join("set"));
    assert_eq!(run.status.code(), Some(2));
    assert!(said(&run).contains(&unspaced(expected)), "\nwanted: {expected}\nfound:  {}", said(&run));
}

/// Whether the verb refuses `source` once it is broken: in which file, from what, to what, in which words.
fn refused_when_broken(format: &str, source: &Source, robot: Option<u16>, cases: &[[&'static str; 4]]) {
    let dir = tempfile::tempdir().unwrap();
    for [file, from, to, expected] in cases {
        let mut files = source.clone();
        let text = &files[file];
        assert!(text.contains(from), "{file}: {from:?} in {}", &text[..200.min(text.len())]);
        files.insert(file, text.replacen(from, to, 1));
        write(&files, dir.path());
        refused(format, dir.path(), robot, expected);
    }
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
