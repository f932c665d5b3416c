//! `manifest.json`: what a folder of results was made by.

use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use serde::Serialize;

use super::cases::write_whole;
use super::{CannotSweep, Results};
use crate::scenario::Scenario;
use crate::study::Study;

/// What made the results.
#[derive(Clone, Debug, Serialize)]
pub struct Manifest {
    /// Name of the scenario.
    pub scenario: String,
    /// Hash of the checked scenario.
    pub scenario_hash: String,
    /// Version of asami.
    pub version: &'static str,
    /// Commit of the repository when the sweep began, where git is there and says so.
    pub commit: Option<String>,
    /// Whether files differed from that commit.
    pub dirty: Option<bool>,
    /// Hash of Cargo.lock.
    pub lock_hash: String,
    /// Hash of the program's file.
    pub program: String,
    /// Compiler.
    pub rustc: &'static str,
    /// What it compiled for.
    pub target: &'static str,
    /// `debug` or `release`.
    pub profile: &'static str,
    /// Cargo features that are on.
    pub features: Vec<&'static str>,
    /// Seeds of the cases, in order, each once.
    pub seeds: Vec<u64>,
    /// Number of cases.
    pub cases: usize,
    /// Number of trials.
    pub trials: usize,
}

impl Manifest {
    /// Writes `manifest.json` under `out`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, out: &Path) -> Result<(), CannotSweep> {
        let path = out.join("manifest.json");
        let text = serde_json::to_string_pretty(self).map_err(std::io::Error::other);
        write_whole(&path, (text.map_err(CannotSweep::file("serialise", &path))? + "\n").as_bytes())
    }
}

/// The repository that the program was built in, where it still is there; else the current folder.
#[must_use]
pub fn repository() -> &'static Path {
    let built_in = Path::new(env!("CARGO_MANIFEST_DIR"));
    if built_in.is_dir() { built_in } else { Path::new(".") }
}

/// The manifest of complete results.
#[must_use]
pub fn manifest<S: Study>(results: &Results<S>, program: &str) -> Manifest {
    let mut seeds: Vec<u64> = results.records.iter().map(|record| record.case.seed).collect();
    seeds.dedup();
    let Scenario { name, .. } = &results.scenario;
    let counts = (results.records.len(), results.trials().count());
    Manifest { seeds, ..of((name, results.scenario.hash()), counts, program) }
}

/// The manifest of so many cases and trials of a scenario of this name and hash, its seeds left open.
#[must_use]
pub fn of((scenario, scenario_hash): (&str, String), (cases, trials): (usize, usize), program: &str) -> Manifest {
    Manifest {
        scenario: scenario.to_owned(),
        scenario_hash,
        version: env!("CARGO_PKG_VERSION"),
        commit: checkout().commit.clone(),
        dirty: checkout().dirty,
        lock_hash: format!("blake3:{}", blake3::hash(include_bytes!("../../Cargo.lock")).to_hex()),
        program: program.to_owned(),
        rustc: env!("ASAMI_RUSTC"),
        target: env!("ASAMI_TARGET"),
        profile: env!("ASAMI_PROFILE"),
        features: Vec::new(),
        seeds: Vec::new(),
        cases,
        trials,
    }
}

/// The state of the repository.
struct Checkout {
    commit: Option<String>,
    dirty: Option<bool>,
}

/// As it was when it was first asked for: while a sweep runs for hours, somebody works on.
fn checkout() -> &'static Checkout {
    static CHECKOUT: OnceLock<Checkout> = OnceLock::new();
    CHECKOUT.get_or_init(|| Checkout {
        commit: git(&["rev-parse", "HEAD"]),
        dirty: git(&["status", "--porcelain"]).map(|changes| !changes.is_empty()),
    })
}

/// The hash of the running program's file; of what it says of itself, where that cannot be read. Notes the state of the
/// repository, too, for the manifest.
#[must_use]
pub fn program() -> String {
    checkout();
    let bytes = std::env::current_exe().and_then(std::fs::read);
    let said = [env!("CARGO_PKG_VERSION"), env!("ASAMI_RUSTC"), env!("ASAMI_PROFILE")].join(" ");
    let hash = blake3::hash(bytes.as_deref().unwrap_or(said.as_bytes()));
    format!("blake3:{}", hash.to_hex())
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).current_dir(repository()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
