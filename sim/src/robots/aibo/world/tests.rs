use asami_dataset::Dataset;

use super::*;
use crate::drives::hold::Hold;
use crate::effects::command_delay::CommandDelay;
use crate::effects::command_scale::CommandScale;
use crate::effects::ground_friction::GroundFriction;
use crate::world::run;

fn aibo(effects: &Effects, seed: u64) -> AiboWorld {
    AiboWorld::new(&AiboConfig::default(), &Field::default(), 25.0, effects, Start::default(), Seed(seed))
        .expect("the shipped body builds")
}

fn walk(effects: &Effects, seed: u64, ay_m_per_s: f64, until_s: f64) -> Dataset {
    run(&mut aibo(effects, seed), &mut Hold::forward(ay_m_per_s), until_s)
}

/// Mean forward speed from `from_s` on.
fn speed_m_per_s(walk: &Dataset, from_s: f64) -> f64 {
    let track = &walk.truth.track;
    let (Some(first), Some(last)) = (track.iter().find(|pose| pose.t_s >= from_s), track.last()) else {
        panic!("an empty track")
    };
    (last.y_m - first.y_m) / (last.t_s - first.t_s)
}

#[test]
fn engine_holds_the_mass_of_the_urdf() {
    let mut world = aibo(&Effects::default(), 1000);
    world.tick(Hold::forward(0.0).0, &mut Record::default());
    let wanted_kg = world.blueprint.mass_kg();
    assert!((wanted_kg - 1.663).abs() < 1e-3, "public models of the ERS-7 weigh 1.663 kg, not {wanted_kg}");
    assert!((world.body().mass_kg() - wanted_kg).abs() < 1e-5);
}

#[test]
fn same_seed_same_bits_other_seed_other_bits() {
    let walk = |seed| walk(&Effects::default(), seed, 0.1, 2.0);
    assert_eq!(walk(1000), walk(1000));
    assert_ne!(walk(1000).truth.track, walk(1001).truth.track);
}

#[test]
fn null_effects_change_no_bit() {
    let null = Effects {
        command_delay: Some(CommandDelay::default()),
        command_scale: Some(CommandScale::default()),
        ground_friction: Some(GroundFriction::default()),
    };
    assert_eq!(walk(&Effects::default(), 1000, 0.1, 2.0), walk(&null, 1000, 0.1, 2.0));
}

#[test]
fn delay_shifts_the_response_and_leaves_the_steady_speed() {
    let delayed = Effects { command_delay: Some(CommandDelay { delay_s: 0.48 }), ..Effects::default() };
    let (prompt, late) = (walk(&Effects::default(), 1000, 0.12, 6.0), walk(&delayed, 1000, 0.12, 6.0));
    let (v_prompt, v_late) = (speed_m_per_s(&prompt, 2.0), speed_m_per_s(&late, 2.0));
    assert!((v_prompt - v_late).abs() < 0.004, "{v_prompt} {v_late}");
    let behind_m = prompt.truth.track.last().map(|p| p.y_m).unwrap_or_default()
        - late.truth.track.last().map(|p| p.y_m).unwrap_or_default();
    let behind_s = behind_m / v_prompt;
    assert!((behind_s - 0.48).abs() < 0.15, "{behind_s} s behind");
}

#[test]
fn stands_without_creeping() {
    let stand = walk(&Effects::default(), 1000, 0.0, 10.0);
    let (Some(first), Some(last)) = (stand.truth.track.first(), stand.truth.track.last()) else { panic!("empty") };
    let drift_m_per_s = (last.x_m - first.x_m).hypot(last.y_m - first.y_m) / (last.t_s - first.t_s);
    assert!(drift_m_per_s < 1e-3, "{drift_m_per_s}");
}

#[test]
fn frames_fall_on_the_first_step_not_before_they_are_due() {
    let walk = walk(&Effects::default(), 1000, 0.1, 1.0);
    let frames = walk.log.frames.as_deref().unwrap_or_default();
    assert_eq!(frames.len(), 26);
    for (n, frame) in frames.iter().enumerate() {
        let late_s = frame.t_s - n as f64 / 25.0;
        assert!((-1e-9..0.004).contains(&late_s), "frame {n} at {}", frame.t_s);
    }
}
