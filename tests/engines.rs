//! The Aibo in other programs' physics engines.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use asami_dataset::{Dataset, store};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(format!("{name}.toml"))
}

fn generate(scenario: &str, out: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_generate"));
    command.arg(shipped(scenario)).arg("-o").arg(out).args(more).output().expect("starts")
}

/// What ends a walk in another program's engine is said, and no data set is written.
#[test]
fn an_engine_that_fails_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("walk");
    for (scenario, engine, why) in [
        ("aibo_1d", "false", "the other engine failed: it stopped"),
        ("aibo_1d", "no-such-engine --fast", "the engine `no-such-engine --fast` does not start"),
        ("plain_2d", "cat", "--engine is for scenarios of a simulated Aibo; plain_2d has none"),
        ("aibo_1d", "cat", "it answered"),
    ] {
        let ran = generate(scenario, &out, &["--duration-s", "5", "--engine", engine]);
        // The message is wrapped to the terminal's width.
        let said = String::from_utf8_lossy(&ran.stderr).replace(['\n', '│'], " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(!ran.status.success() && said.contains(why), "{engine}: {said}");
        assert!(!out.exists(), "{engine}");
    }
}

/// In MuJoCo, where its Python package is at hand, the Aibo walks much as in Rapier.
#[test]
fn the_aibo_walks_in_mujoco() {
    let at_hand = Command::new("python3").args(["-c", "import mujoco"]).output();
    if !at_hand.is_ok_and(|it| it.status.success()) {
        eprintln!("skipped: there is no Python package mujoco");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers/mujoco_engine.py");
    let engine = format!("python3 {}", script.display());
    let walked = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let ran = generate("aibo_1d", &out, &[&["--seed", "1000", "--duration-s", "12"], more].concat());
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        store::read(&out).expect("a data set")
    };
    let (rapier, mujoco) = (walked("rapier", &[]), walked("mujoco", &["--engine", &engine]));
    assert!(rapier.provenance.is_some() && mujoco.provenance.is_none());
    // Drawn commands are the same until sightings have the robot turn round.
    assert_eq!(rapier.log.commands[..3], mujoco.log.commands[..3]);
    let way = |set: &Dataset| {
        let until = set.truth.track.partition_point(|pose| pose.t_s < rapier.log.commands[3].t_s);
        set.truth.track[until].y_m - set.truth.track[0].y_m
    };
    assert!((way(&mujoco) / way(&rapier) - 1.0).abs() < 0.25, "{} {}", way(&mujoco), way(&rapier));
}
