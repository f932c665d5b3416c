use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, Size};

use super::*;
use crate::drives::explore::{Explore, Exploring};
use crate::drives::hold::Hold;
use crate::drives::pace::{Pace, Pacing};
use crate::drives::suite::Suite;
use crate::effects::command_delay::CommandDelay;
use crate::effects::command_scale::CommandScale;
use crate::effects::ground_friction::GroundFriction;
use crate::robots::aibo::config::{Joints, Physics};
use crate::scenes::field::{Colour, Cylinder, Landmark};
use crate::world::run;

fn aibo(effects: &Effects, seed: u64) -> AiboWorld {
    AiboWorld::new(
        &AiboConfig::default(),
        &Field::default(),
        &CameraConfig::default(),
        effects,
        Start::default(),
        Seed(seed),
    )
    .expect("the shipped body builds")
}

fn walk(effects: &Effects, seed: u64, ay_m_per_s: f64, until_s: f64) -> Dataset {
    run(&mut aibo(effects, seed), &mut Hold::forward(ay_m_per_s), until_s)
}

/// The same floor under every step.
fn undisturbed() -> AiboConfig {
    let mut config = AiboConfig::default();
    config.disturbance.friction_log_sd = 0.0;
    config.servo.set_point_jitter_rad = 0.0;
    config
}

fn undisturbed_walk(config: &AiboConfig, effects: &Effects, start: Start, action: Action, until_s: f64) -> Dataset {
    let (field, camera) = (Field::default(), CameraConfig::default());
    let mut world =
        AiboWorld::new(config, &field, &camera, effects, start, Seed(1000)).expect("the shipped body builds");
    run(&mut world, &mut Hold(action), until_s)
}

/// A beacon 3.3 m ahead of the start, as the robot would have it in chapter 3.
fn before_a_beacon() -> Field {
    let body = Cylinder {
        x_m: 0.0,
        y_m: 3.3,
        radius_m: 0.05,
        base_m: 0.1,
        height_m: 0.2,
        bands: [Colour::Pink, Colour::Yellow],
    };
    Field { beacons: vec![Landmark { id: 0, body }], clutter: vec![] }
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

/// A delay of a whole stride repeats the walk a stride later.
#[test]
fn delay_shifts_the_response_and_leaves_the_steady_speed() {
    let mut config = undisturbed();
    config.gait.period_s = 0.48;
    let delayed = Effects { command_delay: Some(CommandDelay { delay_s: 0.48 }), ..Effects::default() };
    let walk = |effects| undisturbed_walk(&config, effects, Start::default(), Hold::forward(0.12).0, 6.0);
    let (prompt, late) = (walk(&Effects::default()), walk(&delayed));
    let (v_prompt, v_late) = (speed_m_per_s(&prompt, 2.0), speed_m_per_s(&late, 2.0));
    assert!((v_prompt - v_late).abs() < 0.004, "{v_prompt} {v_late}");
    let last_m = |walk: &Dataset| walk.truth.track.last().map(|pose| pose.y_m).unwrap_or_default();
    let behind_s = (last_m(&prompt) - last_m(&late)) / v_prompt;
    assert!((behind_s - 0.48).abs() < 0.05, "{behind_s} s behind");
}

/// At the servos' limit three quarters of the command still give most of the speed.
#[test]
fn scaling_a_saturated_command_costs_less_than_its_share() {
    let scaled = Effects {
        command_scale: Some(CommandScale { y_ratio: 0.75, ..CommandScale::default() }),
        ..Effects::default()
    };
    let full = speed_m_per_s(&walk(&Effects::default(), 1000, 0.3, 6.0), 1.5);
    let three_quarters = speed_m_per_s(&walk(&scaled, 1000, 0.3, 6.0), 1.5);
    assert!(three_quarters > 0.85 * full, "{three_quarters} of {full}");
}

/// The friction's formula knows of no speed: contact makes the difference.
#[test]
fn ice_changes_the_speed() {
    let ice = Effects { ground_friction: Some(GroundFriction { ratio: 0.1 }), ..Effects::default() };
    let grip = speed_m_per_s(&walk(&Effects::default(), 1000, 0.15, 6.0), 1.5);
    let slip = speed_m_per_s(&walk(&ice, 1000, 0.15, 6.0), 1.5);
    assert!((slip - grip).abs() > 0.01, "{slip} on ice, {grip} on the floor");
}

/// Turning right from the other half of the stride is the mirror image of turning left.
#[test]
fn left_and_right_are_mirror_images() {
    let turned = |atheta_rad_per_s: f64, gait_phase: f64| {
        let start = Start { gait_phase, ..Start::default() };
        let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: 0.05, atheta_rad_per_s };
        let walk = undisturbed_walk(&undisturbed(), &Effects::default(), start, action, 4.0);
        walk.truth.track.last().map(|pose| pose.theta_rad).unwrap_or_default()
    };
    let (left, right) = (turned(0.3, 0.0), turned(-0.3, 0.5));
    assert!(left > 0.5, "{left}");
    assert!((left + right).abs() < 0.05 * left, "{left} to the left, {right} to the right");
}

/// Four times finer steps, and the other kind of joints, walk the same walk to a few per cent.
#[test]
fn speed_does_not_hang_on_the_solver() {
    let speed = |joints: Joints, time_step_s: f64, steps_per_tick: u32, solver_iterations: u32| {
        let mut config = undisturbed();
        config.joints = joints;
        config.physics = Physics { time_step_s, steps_per_tick, solver_iterations, ..config.physics };
        let action = Hold::forward(0.16).0;
        let walk = undisturbed_walk(&config, &Effects::default(), Start::default(), action, 4.0);
        speed_m_per_s(&walk, 1.0)
    };
    let nominal = speed(Joints::Multibody, 0.004, 2, 1);
    let finer = speed(Joints::Multibody, 0.002, 4, 2);
    let impulse = speed(Joints::Impulse, 0.002, 4, 8);
    assert!((nominal - finer).abs() < 0.05 * nominal, "{nominal} or {finer} m/s");
    assert!((nominal - impulse).abs() < 0.15 * nominal, "{nominal} or {impulse} m/s");
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
    // That of 1 s is not complete yet.
    assert_eq!(frames.len(), 20);
    for (n, frame) in frames.iter().enumerate() {
        let late_s = frame.t_s - n as f64 / 20.0;
        assert!((-1e-9..0.004).contains(&late_s), "frame {n} at {}", frame.t_s);
    }
}

/// A robot that turns sees a beacon where it is at the frame's time: a frame dated a half of its 25 ms late would be off
/// by 12.5 ms times the turning rate.
#[test]
fn bearings_are_those_of_the_frames_time() {
    let (field, mut config) = (before_a_beacon(), undisturbed());
    config.heading_hold.gain_per_s = 0.0;
    let lag_s = |atheta_rad_per_s: f64| {
        let start = Start { y_m: 1.0, theta_rad: -0.3 * atheta_rad_per_s.signum(), ..Start::default() };
        let camera = CameraConfig::default();
        let mut world = AiboWorld::new(&config, &field, &camera, &Effects::default(), start, Seed(1000))
            .expect("the shipped body builds");
        let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: 0.0, atheta_rad_per_s };
        let Dataset { log, truth, .. } = run(&mut world, &mut Hold(action), 1.2);
        let late = log.sightings.iter().filter(|sighting| sighting.t_s > 0.3).filter_map(|sighting| {
            let pose = pose_at(&truth.track, sighting.t_s)?;
            let true_rad = wrap_rad(atan2(pose.x_m, 3.3 - pose.y_m) - pose.theta_rad);
            Some(wrap_rad(sighting.bearing_rad - true_rad))
        });
        let late: Vec<f64> = late.collect();
        let (Some(first), Some(last)) = (truth.track.first(), truth.track.last()) else { panic!("empty") };
        let rate_rad_per_s = wrap_rad(last.theta_rad - first.theta_rad) / (last.t_s - first.t_s);
        assert!(late.len() > 10, "{}", late.len());
        [late.iter().sum::<f64>() / late.len() as f64, rate_rad_per_s]
    };
    let ([left, left_rate], [right, right_rate]) = (lag_s(0.6), lag_s(-0.6));
    let lag_s = (left - right) / (left_rate - right_rate);
    assert!(lag_s.abs() < 0.004, "{lag_s} s: {left} rad at {left_rate} rad/s, {right} at {right_rate}");
}

/// Random commands for a minute (the sweeps walk 15 x 300 s): no fall, and the heading hold keeps the beacon ahead.
#[test]
fn paces_before_the_beacon_without_falling_or_turning_away() {
    let field = before_a_beacon();
    let start = Start { y_m: 1.0, theta_rad: 0.1, ..Start::default() };
    let camera = CameraConfig::default();
    let seed = Seed(1003);
    let mut world = AiboWorld::new(&AiboConfig::default(), &field, &camera, &Effects::default(), start, seed)
        .expect("the shipped body builds");
    let paced = run(&mut world, &mut Pace::new(Pacing::default(), seed.stream("pace")), 60.0);
    assert!(!world.has_fallen());
    let frames = paced.log.frames.map(|frames| frames.len()).unwrap_or_default();
    assert!(10 * paced.log.sightings.len() > 9 * frames, "{} of {frames} frames", paced.log.sightings.len());
    for pose in paced.truth.track.iter().filter(|pose| pose.t_s > 5.0) {
        let bearing_rad = wrap_rad(atan2(-(0.0 - pose.x_m), 3.3 - pose.y_m) - pose.theta_rad);
        assert!(bearing_rad.abs() < 10f64.to_radians(), "{bearing_rad} at {}", pose.t_s);
    }
}

/// All over the field for a minute with a scanning head: no fall, every beacon is seen, told from the others, and
/// where it is.
#[test]
fn scanning_head_sees_four_beacons_where_they_are() {
    let mut config = AiboConfig::default();
    config.gait.least_lift = 1.0;
    config.heading_hold.gain_per_s = 0.0;
    config.head.scan_amplitude_rad = 88f64.to_radians();
    let colours = [[Colour::Pink, Colour::Yellow], [Colour::Yellow, Colour::Pink], [Colour::Pink, Colour::Blue]];
    let bands = colours.into_iter().chain([[Colour::Blue, Colour::Pink]]);
    let beacons = (0..).zip(bands).zip([[1.95, 1.35], [-1.95, 1.35], [-1.95, -1.35], [1.95, -1.35]]);
    let beacons = beacons.map(|((id, bands), [x_m, y_m])| Landmark {
        id,
        body: Cylinder { x_m, y_m, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands },
    });
    let field = Field { beacons: beacons.collect(), clutter: vec![] };
    let camera = CameraConfig { least_height_px: 9.2, greatest_height_px: 35.0, ..CameraConfig::default() };
    let seed = Seed(1004);
    let mut world = AiboWorld::new(&config, &field, &camera, &Effects::default(), Start::default(), seed)
        .expect("the shipped body builds");
    let suite = Suite { max_right_m_per_s: 0.15, max_forward_m_per_s: 0.2, max_turn_rad_per_s: 0.8 };
    let mut drive = Explore::new(Exploring::default(), suite.actions(), seed.stream("drive"));
    let explored = run(&mut world, &mut drive, 60.0);
    assert!(!world.has_fallen());
    let mut seen = [0; 4];
    let mut worst_rad = 0.0_f64;
    for sighting in explored.log.sightings.iter() {
        let pose = pose_at(&explored.truth.track, sighting.t_s).expect("frames have a pose");
        let beacon = &field.beacons[usize::from(sighting.landmark)].body;
        let direction_rad = atan2(pose.x_m - beacon.x_m, beacon.y_m - pose.y_m) - pose.theta_rad;
        worst_rad = worst_rad.max(wrap_rad(sighting.bearing_rad - direction_rad).abs());
        seen[usize::from(sighting.landmark)] += 1;
        let Size::HeightPx(height_px) = sighting.size else { panic!("cameras see heights") };
        assert!((9.2..=35.0).contains(&height_px), "{height_px}");
    }
    assert!(seen.iter().all(|sightings| *sightings > 5), "{seen:?}");
    // Beacons are 90 degrees apart or so; the body turns by a fraction of a radian while an image is taken.
    assert!(worst_rad < 0.2, "{worst_rad}");
}

/// A trot: diagonal feet together, each on the ground for about its share of the stride.
#[test]
fn diagonal_feet_step_together() {
    let mut world = aibo(&Effects::default(), 1000);
    world.watch();
    run(&mut world, &mut Hold::forward(0.12), 4.0);
    let contacts = &world.watched().expect("watched").contacts[250..];
    let share = |holds: &dyn Fn(&[bool; 4]) -> bool| {
        contacts.iter().filter(|row| holds(&row.down)).count() as f64 / contacts.len() as f64
    };
    for foot in 0..4 {
        let down = share(&|feet| feet[foot]);
        assert!((0.4..0.8).contains(&down), "foot {foot} is down for {down} of the time");
    }
    for [diagonal, beside] in [[[0, 3], [0, 1]], [[1, 2], [2, 3]]] {
        let together = share(&|feet| feet[diagonal[0]] == feet[diagonal[1]]);
        let abreast = share(&|feet| feet[beside[0]] == feet[beside[1]]);
        assert!(together > 2.0 * abreast, "{together} together, {abreast} abreast");
    }
}
