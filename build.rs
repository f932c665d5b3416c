//! Tells the program what compiled it, for the manifests of results, and by which code responses are learned, so that
//! none of older code is believed.

use std::path::Path;
use std::process::Command;

/// Nothing that learns a response uses what is in these (tests/arrows.rs): when they change, responses are as good as before.
const LEARN_NOTHING: [&str; 3] = ["gap/src/answer", "gap/src/real", WEIGHS];
/// Nor does what learns a response of a robot among landmarks use what is in this (tests/arrows.rs).
const FOLLOWS_CARS: &str = "gap/src/drive";
/// What that reads scans by.
const READS_SCANS: &str = "scans/src";
/// What planted cases are weighed by, beside responses.
const WEIGHS: &str = "gap/src/weigh";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc).arg("--version").output();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default();
    println!("cargo::rustc-env=ASAMI_RUSTC={version}");
    for (ours, cargos) in [("ASAMI_TARGET", "TARGET"), ("ASAMI_PROFILE", "PROFILE")] {
        println!("cargo::rustc-env={ours}={}", std::env::var(cargos).unwrap_or_default());
    }
    let nor_cars = [&LEARN_NOTHING[..], &[FOLLOWS_CARS]].concat();
    for (ours, folders, but) in [
        ("ASAMI_LEARNS", &["gap/src"][..], &nor_cars[..]),
        ("ASAMI_LEARNS_CARS", &["gap/src", READS_SCANS], &LEARN_NOTHING),
        ("ASAMI_WEIGHS", &[WEIGHS], &[]),
    ] {
        let mut hash = 0xcbf2_9ce4_8422_2325;
        for folder in folders {
            println!("cargo::rerun-if-changed={folder}");
            digest(Path::new(folder), but, &mut hash);
        }
        println!("cargo::rustc-env={ours}={hash:016x}");
    }
}

/// Fowler, Noll and Vo's hash (FNV-1a) over names and contents of all files below, in order of their names, but those in some folders.
fn digest(path: &Path, but: &[&str], hash: &mut u64) {
    let mut below: Vec<_> = std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    below.retain(|path| !but.iter().any(|folder| path == Path::new(folder)));
    below.sort();
    let contents = if path.is_file() { std::fs::read(path).unwrap_or_default() } else { Vec::new() };
    for byte in path.to_string_lossy().bytes().chain(contents) {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    below.iter().for_each(|path| digest(path, but, hash));
}
