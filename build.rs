//! Tells the program what compiled it, for the manifests of results, and by which code responses are learned, so that
//! none of older code is believed.

use std::path::Path;
use std::process::Command;

/// Nothing that learns a response uses what is in here (tests/arrows.rs): when it changes, responses are as good as before.
const LEARNS_NOTHING: &str = "gap/src/real";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc).arg("--version").output();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default();
    println!("cargo::rustc-env=ASAMI_RUSTC={version}");
    for (ours, cargos) in [("ASAMI_TARGET", "TARGET"), ("ASAMI_PROFILE", "PROFILE")] {
        println!("cargo::rustc-env={ours}={}", std::env::var(cargos).unwrap_or_default());
    }
    println!("cargo::rerun-if-changed=gap/src");
    let mut hash = 0xcbf2_9ce4_8422_2325;
    digest(Path::new("gap/src"), &mut hash);
    println!("cargo::rustc-env=ASAMI_GAP={hash:016x}");
}

/// Fowler, Noll and Vo's hash (FNV-1a) over names and contents of all files below, in order of their names.
fn digest(path: &Path, hash: &mut u64) {
    let mut below: Vec<_> = std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    below.retain(|path| path != Path::new(LEARNS_NOTHING));
    below.sort();
    let contents = if path.is_file() { std::fs::read(path).unwrap_or_default() } else { Vec::new() };
    for byte in path.to_string_lossy().bytes().chain(contents) {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    below.iter().for_each(|path| digest(path, hash));
}
