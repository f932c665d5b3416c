//! Tells the program what compiled it, for the manifests of results.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc).arg("--version").output();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default();
    println!("cargo::rustc-env=ASAMI_RUSTC={version}");
    for (ours, cargos) in [("ASAMI_TARGET", "TARGET"), ("ASAMI_PROFILE", "PROFILE")] {
        println!("cargo::rustc-env={ours}={}", std::env::var(cargos).unwrap_or_default());
    }
}
