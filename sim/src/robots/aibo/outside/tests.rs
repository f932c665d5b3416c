use super::*;
use crate::effects::Effects;
use crate::robots::aibo::{AiboWorld, By, Start};
use crate::scenes::field::Field;
use crate::sensors::camera::CameraConfig;
use crate::world::{Record, World};
use asami_dataset::{Action, Seed};

const STANDING: Action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: 0.0, atheta_rad_per_s: 0.0 };
/// The torso 0.1 m ahead of the origin, turned by a quarter to the left.
const ANSWER: &str = r#"{"torso":[0.1,0,0.15,0.7071067811865476,0,0,0.7071067811865476],"head":[0.2,0,0.25,1,0,0,0],"angles_rad":[0,0,0,0,0,0,0,0,0,0,0,0,0,0.3,0],"feet_down":[true,true,false,true],"mass_kg":1.5}"#;

/// A world in an engine that is a script of the shell.
fn world(script: &str) -> Result<AiboWorld, BuildError> {
    world_in(&["sh", "-c", script])
}

/// A world in a program's engine.
fn world_in(program: &[&str]) -> Result<AiboWorld, BuildError> {
    let program: Vec<String> = program.iter().map(|it| (*it).to_owned()).collect();
    let (config, camera, start) = (AiboConfig::default(), CameraConfig::default(), Start::default());
    AiboWorld::in_engine(
        By::Program(&program),
        &config,
        &Field::default(),
        &camera,
        &Effects::default(),
        start,
        Seed(1),
    )
}

#[test]
fn the_body_is_where_the_engine_says() {
    let mut world = world(&format!("while read -r line; do echo '{ANSWER}'; done")).unwrap();
    world.tick(STANDING, &mut Record::default());
    assert_eq!(world.broken(), None);
    let pose = world.pose();
    // Ahead of the torso is world +y: heading 0.
    assert!((pose.x_m - 0.1).abs() < 1e-12 && pose.theta_rad.abs() < 1e-12, "{pose:?}");
    assert_eq!(world.body().feet_down(), [true, true, false, true]);
    assert!((world.body().angle_rad(13) - 0.3).abs() < 1e-12 && (world.body().mass_kg() - 1.5).abs() < 1e-12);
}

/// What is said holds what an engine needs: the first line the body, every other one set-points.
#[test]
fn the_first_line_is_the_body_and_others_are_steps() {
    let script = format!(
        r#"read -r first
        case "$first" in *'"asami_engine":1'*'fl_rotator'*) echo '{ANSWER}' ;; *) exit 3 ;; esac
        while read -r line; do
            case "$line" in '{{"aim_rad":['*'"torque_ratio":[1.0,1.0,1.0,1.0]'*) echo '{ANSWER}' ;; *) exit 4 ;; esac
        done"#
    );
    let mut world = world(&script).unwrap();
    world.tick(STANDING, &mut Record::default());
    assert_eq!(world.broken(), None);
}

#[test]
fn an_engine_that_fails_says_why_and_hangs_nothing() {
    for (script, why) in [
        ("exit 0", "stopped"),
        ("read -r line; echo no answer", "it answered \"no answer\""),
        ("read -r line; echo '{}'", "missing field"),
        (&format!("read -r line; echo '{}'", ANSWER.replace("0.15", "1e999")), "out of range"),
        (&format!("read -r line; echo '{ANSWER}'; exit 1"), "stopped"),
        ("yes y | tr -d '\\n'", "it answered"),
    ] {
        let mut world = world(script).unwrap();
        world.tick(STANDING, &mut Record::default());
        let broken = world.broken().expect(script);
        assert!(broken.contains(why), "{script}: {broken}");
    }
}

#[test]
fn an_engine_that_is_not_there_is_named() {
    let error = world_in(&["no-such-engine", "--fast"]);
    let error = error.err().expect("no such program").to_string();
    assert!(error.contains("no-such-engine --fast"), "{error}");
}

/// Whoever writes an engine has the page alone.
#[test]
fn every_key_is_on_the_page() {
    let page = include_str!("../../../../../docs/engines.md");
    let (config, blueprint) = (AiboConfig::default(), Blueprint::shipped().unwrap());
    let program = ["sh".to_owned(), "-c".to_owned(), "read -r line".to_owned()];
    let outside = Outside::new(&program, &config, &blueprint, &Isometry3::identity(), &[0.0; JOINTS]).unwrap();
    let begin = serde_json::to_value(outside.begin.as_ref().unwrap()).unwrap();
    let lines = [begin.clone(), begin["joints"][0].clone(), serde_json::to_value(&outside.step).unwrap()];
    let answer: serde_json::Value = serde_json::from_str(ANSWER).unwrap();
    for line in lines.iter().chain([&answer]) {
        for key in line.as_object().unwrap().keys() {
            assert!(page.contains(&format!("`{key}`")), "{key}");
        }
    }
    assert!(page.contains("65 536") && LONGEST == 65_536);
}
