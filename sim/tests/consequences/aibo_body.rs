//! What ails the Aibo's motors, legs and floor.

use asami_dataset::{Action, Dataset, Seed};
use asami_sim::drives::hold::Hold;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, Start};
use asami_sim::scenes::field::Field;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::{World, run};

/// The same floor under every step, and nothing to turn to.
fn undisturbed() -> AiboConfig {
    let mut config = AiboConfig::default();
    config.disturbance.friction_log_sd = 0.0;
    config
}

pub fn effects(settings: &[(&str, &str, f64)]) -> Effects {
    let mut effects = Effects::default();
    for (name, parameter, value) in settings {
        assert!(effects.set(name, parameter, *value), "{name}.{parameter}");
    }
    effects
}

fn aibo(config: &AiboConfig, effects: &Effects, start: Start) -> AiboWorld {
    // Small frames: there is nothing to see.
    let camera = CameraConfig { width_px: 32, height_px: 32, ..CameraConfig::default() };
    AiboWorld::new(config, &Field::default(), &camera, effects, start, Seed(1000)).expect("the shipped robot")
}

fn walk(config: &AiboConfig, effects: &Effects, start: Start, [right, forward, turn]: [f64; 3], s: f64) -> Dataset {
    let action = Action::Legs { id: None, ax_m_per_s: right, ay_m_per_s: forward, atheta_rad_per_s: turn };
    run(&mut aibo(config, effects, start), &mut Hold(action), s)
}

/// Where the torso is, and where its forward and leftward axes point, after standing for a second.
fn stance(effects: &Effects) -> (f64, nalgebra::Vector3<f64>, nalgebra::Vector3<f64>) {
    let mut world = aibo(&undisturbed(), effects, Start::default());
    run(&mut world, &mut Hold::forward(0.0), 1.0);
    let torso = world.body().world_from_torso();
    (torso.translation.z, torso * nalgebra::Vector3::x(), torso * nalgebra::Vector3::y())
}

/// Mean speed between two times, along a path that may bend, in chords of half a second.
fn speed_m_per_s(walk: &Dataset, from_s: f64, to_s: f64) -> f64 {
    let poses = walk.truth.track.iter().filter(|pose| (from_s..=to_s).contains(&pose.t_s)).step_by(10);
    let poses: Vec<_> = poses.collect();
    let path_m: f64 = poses.windows(2).map(|pair| (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m)).sum();
    let time_s = poses.last().zip(poses.first()).map_or(f64::NAN, |(last, first)| last.t_s - first.t_s);
    path_m / time_s
}

fn forward(effects: &Effects, ay_m_per_s: f64, until_s: f64) -> f64 {
    let walk = walk(&undisturbed(), effects, Start::default(), [0.0, ay_m_per_s, 0.0], until_s);
    speed_m_per_s(&walk, 1.0, until_s)
}

/// How far the robot has turned.
fn turned_rad(config: &AiboConfig, effects: &Effects, gait_phase: f64) -> f64 {
    let start = Start { gait_phase, ..Start::default() };
    let walk = walk(config, effects, start, [0.0, 0.2, 0.0], 4.0);
    walk.truth.track.last().map(|pose| pose.theta_rad).unwrap_or_default()
}

/// A stroll asks for less speed than slow servos have; a run does not.
#[test]
fn slow_servos_spoil_a_run_more_than_a_stroll() {
    let slow = effects(&[("servo_speed_limit", "ratio", 0.65)]);
    let share = |ay_m_per_s| forward(&slow, ay_m_per_s, 4.0) / forward(&Effects::default(), ay_m_per_s, 4.0);
    let (stroll, run) = (share(0.08), share(0.3));
    assert!(run < 0.9 * stroll, "{stroll} of the speed of a stroll, {run} of a run's");
}

/// Set-points a whole stride late are those of a command that is a stride late: the gait repeats itself.
#[test]
fn servos_late_by_a_stride_walk_as_if_the_command_had_been() {
    let mut config = undisturbed();
    config.gait.period_s = 0.48;
    let track = |effects: &Effects| walk(&config, effects, Start::default(), [0.0, 0.15, 0.3], 3.0).truth.track;
    let servos = track(&effects(&[("servo_latency", "latency_s", 0.48)]));
    let command = track(&effects(&[("command_delay", "delay_s", 0.48)]));
    let prompt = track(&Effects::default());
    let apart = |a: &[asami_dataset::TruePose], b: &[asami_dataset::TruePose]| {
        a.last().zip(b.last()).map_or(f64::NAN, |(a, b)| (a.x_m - b.x_m).hypot(a.y_m - b.y_m))
    };
    let (to_command_m, to_prompt_m) = (apart(&servos, &command), apart(&servos, &prompt));
    // Rounding alone parts two walks by millimetres in a few strides.
    assert!(4.0 * to_command_m < to_prompt_m, "{to_command_m} m apart, {to_prompt_m} m from a prompt robot");
}

/// Between two flanks a joint stands still: strides fall short, whatever their length.
#[test]
fn play_shortens_strides() {
    let loose = effects(&[("joint_backlash", "play_rad", 0.08)]);
    let share = |ay_m_per_s| forward(&loose, ay_m_per_s, 4.0) / forward(&Effects::default(), ay_m_per_s, 4.0);
    let shares = [0.05, 0.15, 0.25].map(share);
    assert!(shares.iter().all(|share| (0.5..0.95).contains(share)), "{shares:?} of the speeds");
}

#[test]
fn weak_motors_stand_lower_and_lower_yet_under_a_load() {
    let height_m = |settings: &[(&str, &str, f64)]| stance(&effects(settings)).0;
    let (strong, weak) = (height_m(&[]), height_m(&[("motor_weakness", "ratio", 0.5)]));
    let loaded = height_m(&[("motor_weakness", "ratio", 0.5), ("payload", "mass_kg", 0.5)]);
    assert!(strong - weak > 5e-4 && weak - loaded > 5e-4, "{strong} m, weak {weak} m, loaded {loaded} m");
}

/// The mirror image of a weak left leg is a weak right one.
#[test]
fn one_weak_leg_turns_the_robot_and_its_mirror_image_the_other_way() {
    let turned = |leg: f64, gait_phase| {
        turned_rad(&undisturbed(), &effects(&[("weak_leg", "ratio", 0.35), ("weak_leg", "leg", leg)]), gait_phase)
    };
    let straight = turned_rad(&undisturbed(), &Effects::default(), 0.0);
    let (left, right) = (turned(0.0, 0.0), turned(1.0, 0.5));
    assert!((left - straight).abs() > 0.1, "{left} rad against {straight}");
    assert!((left + right).abs() < 0.1 * left.abs(), "{left} rad for a weak left leg, {right} for a right one");
}

#[test]
fn a_sagging_battery_slows_the_second_half_of_a_log() {
    let walk = |effects: &Effects| walk(&undisturbed(), effects, Start::default(), [0.0, 0.25, 0.0], 12.0);
    let fresh = walk(&Effects::default());
    let flat = walk(&effects(&[("battery_sag", "lost_per_s", 0.01)]));
    let halves = |walk: &Dataset| [speed_m_per_s(walk, 1.0, 6.0), speed_m_per_s(walk, 7.0, 12.0)];
    let ([before, after], [flat_before, flat_after]) = (halves(&fresh), halves(&flat));
    assert!((after / before - 1.0).abs() < 0.01, "{before} and {after} m/s on a fresh battery");
    assert!(flat_after < 0.98 * flat_before, "{flat_before} and {flat_after} m/s");
}

#[test]
fn slower_up_the_slope_and_faster_down() {
    let speed = |pitch_rad| forward(&effects(&[("slope", "pitch_rad", pitch_rad)]), 0.2, 4.0);
    let (up, level, down) = (speed(0.08), speed(0.0), speed(-0.08));
    assert!(up < 0.98 * level && 1.02 * level < down, "{up} m/s up, {level} on the level, {down} down");
}

/// On ice even a gentle slope is too steep to stand on: `tan(0.14) = 0.141` against 0.8 x 0.1.
#[test]
fn a_robot_slides_down_an_icy_slope_and_holds_on_a_dry_one() {
    let slid_m = |friction: f64| {
        let settings = [("slope", "pitch_rad", 0.14), ("ground_friction", "ratio", friction)];
        let walk = walk(&undisturbed(), &effects(&settings), Start::default(), [0.0; 3], 2.0);
        walk.truth.track.last().map(|pose| -pose.y_m).unwrap_or_default()
    };
    let (dry_m, icy_m) = (slid_m(1.0), slid_m(0.1));
    // Friction is nominal until the log begins; then g (sin - mu cos) t^2 / 2 in 2 s.
    let fallen_m = 0.5 * 9.81 * (0.14_f64.sin() - 0.08 * 0.14_f64.cos()) * 4.0;
    assert!(dry_m < 0.01, "{dry_m} m down the dry slope");
    assert!((icy_m / fallen_m - 1.0).abs() < 0.1, "{icy_m} m down the icy slope, not {fallen_m}");
}

#[test]
fn a_load_ahead_pitches_the_body_down_and_one_behind_up() {
    let pitch = |ahead_m| stance(&effects(&[("payload", "mass_kg", 0.4), ("payload", "ahead_m", ahead_m)])).1.z;
    let (behind, level, ahead) = (pitch(-0.08), stance(&Effects::default()).1.z, pitch(0.08));
    assert!(ahead < level - 1e-3 && level + 1e-3 < behind, "{ahead} ahead, {level} without, {behind} behind");
}

#[test]
fn a_load_weighs_what_it_is_said_to() {
    let mass_kg = |effects: &Effects| {
        let mut world = aibo(&undisturbed(), effects, Start::default());
        run(&mut world as &mut dyn World, &mut Hold::forward(0.0), 0.1);
        world.body().mass_kg()
    };
    let more_kg = mass_kg(&effects(&[("payload", "mass_kg", 0.25)])) - mass_kg(&Effects::default());
    assert!((more_kg - 0.25).abs() < 1e-5, "{more_kg}");
}

/// Three feet stay put; the body tips about the diagonal or stands on all four, lower where the leg is short.
#[test]
fn the_body_leans_towards_a_short_leg() {
    let (_, level_ahead, level_left) = stance(&Effects::default());
    for (leg, ahead, left) in [(0.0, 1.0, 1.0), (1.0, 1.0, -1.0), (2.0, -1.0, 1.0), (3.0, -1.0, -1.0)] {
        let (_, nose, side) = stance(&effects(&[("short_leg", "missing_m", 0.01), ("short_leg", "leg", leg)]));
        let down = -ahead * (nose.z - level_ahead.z) - left * (side.z - level_left.z);
        assert!(down > 5e-3, "leg {leg}: towards it the body drops by {down}");
    }
}
