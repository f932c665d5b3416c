use asami_dataset::Dataset;

use super::super::blueprint::Model;
use super::*;
use crate::drives::driver::{Driver, Driving, Feel};
use crate::drives::hold::Hold;
use crate::effects::command_delay::CommandDelay;
use crate::scenes::town::{Town, TownConfig};
use crate::world::{dataset, record};

const FORWARD: Start = Start { x_m: 0.0, y_m: 0.0, theta_rad: 0.0 };

fn pedals(throttle: f64, brake: f64, steering: f64) -> Hold {
    Hold(Action::Pedals { throttle, brake, steering })
}

fn on(ground: &Ground, effects: &Effects) -> CarWorld {
    CarWorld::new(&CarConfig::default(), ground, None, effects, FORWARD, Seed(1000)).expect("the shipped car builds")
}

/// A car on a level plane.
fn level() -> CarWorld {
    on(&Ground::level(300.0), &Effects::default())
}

/// How far the nose points up.
fn pitch_rad(world: &CarWorld) -> f64 {
    asami_math::elementary::asin((world.sensor_pose().world_from_sensor * Vector3::y()).z)
}

fn town_drive(seed: u64, until_s: f64) -> (Dataset, Vec<SensorPose>) {
    let seed = Seed(seed);
    let town = Town::new(&TownConfig { detail: 0.0, ..TownConfig::default() }, seed);
    let start = town.route.at(0.0).into();
    let mut world =
        CarWorld::new(&CarConfig::default(), &town.ground(), None, &Effects::default(), start, seed).unwrap();
    let mut driver = Driver::new(Driving::default(), Feel::default(), town.route, 0.0, seed.stream("drive"));
    let mut record = record(&mut world, &mut driver, until_s);
    let poses = std::mem::take(&mut record.sensor_poses);
    (dataset(&world, record), poses)
}

#[test]
fn same_seed_same_bits_other_seed_other_bits() {
    let (a, b, c) = (town_drive(1000, 12.0), town_drive(1000, 12.0), town_drive(1001, 12.0));
    assert_eq!(a, b);
    assert_ne!(a.0.log.commands, c.0.log.commands);
    assert_eq!(a.1.len(), 12 * 400 + 1);
    assert!(a.0.log.frames.is_none());
}

/// At rest every wheel bears its share of the weight, and the Velodyne is 2 m above the road.
#[test]
fn stands_as_its_masses_say() {
    let world = level();
    let blueprint = Blueprint::shipped(Model::default()).unwrap();
    let loads = world.body().wheels().each_ref().map(|wheel| wheel.load_n());
    let weight_n = blueprint.mass_kg * 9.81;
    assert!((loads.iter().sum::<f64>() - weight_n).abs() < 1e-3 * weight_n, "{loads:?} of {weight_n}");
    // Moments about the rear axle.
    let front = (0.5 * blueprint.wheelbase_m() + blueprint.centre_of_mass_m.x) / blueprint.wheelbase_m();
    assert!(((loads[0] + loads[1]) / weight_n - front).abs() < 2e-3);
    assert!((loads[0] - loads[1]).abs() < 1.0 && (loads[2] - loads[3]).abs() < 1.0);
    assert!((world.sensor_pose().position_m[2] - 2.0).abs() < 0.02);
    // 1793 kg at the kerb and 220 kg of people and instruments.
    assert!((blueprint.mass_kg - 2013.0).abs() < 5.0, "{}", blueprint.mass_kg);
}

#[test]
fn pitch_changes_sign_between_pulling_away_and_braking() {
    let mut world = level();
    let at_rest = pitch_rad(&world);
    let mut record = Record::default();
    for _ in 0..30 {
        world.tick(pedals(0.3, 0.0, 0.0).0, &mut record);
    }
    let pulling = pitch_rad(&world) - at_rest;
    for _ in 0..15 {
        world.tick(pedals(0.0, 0.35, 0.0).0, &mut record);
    }
    let braking = pitch_rad(&world) - at_rest;
    assert!(pulling > 0.5_f64.to_radians() && braking < -0.5_f64.to_radians(), "{pulling} {braking}");
}

/// A car on ground of which `points` are `[y, z]`, with a configuration of its own.
fn along(points: &[[f32; 2]], config: &CarConfig) -> CarWorld {
    let ground = Ground::profile(50.0, points);
    CarWorld::new(config, &ground, None, &Effects::default(), FORWARD, Seed(1000)).expect("the shipped car builds")
}

fn drive(world: &mut CarWorld, action: Action, for_s: f64) -> Record {
    let mut record = Record::default();
    for _ in 0..(for_s / 0.05).round() as usize {
        world.tick(action, &mut record);
    }
    record
}

fn speed_m_per_s(world: &CarWorld) -> f64 {
    world.pose().v_m_per_s.unwrap_or(f64::NAN)
}

#[test]
fn stands_still_on_its_brake_level_and_on_a_hill() {
    for slope in [0.0, 0.05, -0.05] {
        let mut world = along(&[[-50.0, -50.0 * slope], [50.0, 50.0 * slope]], &CarConfig::default());
        // Until it has stopped rocking.
        drive(&mut world, pedals(0.0, 0.4, 0.0).0, 5.0);
        let before = world.pose();
        drive(&mut world, pedals(0.0, 0.4, 0.0).0, 60.0);
        let after = world.pose();
        let moved_m = (after.x_m - before.x_m).hypot(after.y_m - before.y_m);
        assert!(moved_m < 1e-4, "{moved_m} m on a slope of {slope}");
    }
}

#[test]
fn a_kerb_moves_the_suspension_and_lifts_the_car() {
    let kerb_m = 0.1;
    let mut world = along(&[[-50.0, 0.0], [8.0, 0.0], [8.02, kerb_m], [50.0, kerb_m]], &CarConfig::default());
    let before_m = world.sensor_pose().position_m[2];
    let (mut front, mut rear) = (0.0_f64, 0.0_f64);
    let mut flat = 0.0_f64;
    for _ in 0..280 {
        let braking = world.pose().y_m > 14.0;
        let action = if braking { pedals(0.0, 0.3, 0.0).0 } else { pedals(0.02, 0.0, 0.0).0 };
        world.tick(action, &mut Record::default());
        let travels = world.body().wheels().each_ref().map(|wheel| wheel.travel_m());
        // The front axle is 1.27 m before the Velodyne.
        if world.pose().y_m < 6.0 {
            flat = flat.max(travels[0].abs());
        }
        (front, rear) = (front.max(travels[0]), rear.max(travels[2]));
    }
    assert!(flat < 0.012 && front > 0.03 && rear > 0.03, "{flat} on the flat, then {front} and {rear} m");
    assert!(speed_m_per_s(&world).abs() < 1e-3 && world.pose().y_m > 14.0);
    let lifted_m = world.sensor_pose().position_m[2] - before_m;
    assert!((lifted_m - f64::from(kerb_m)).abs() < 3e-3, "{lifted_m} m");
}

#[test]
fn left_is_the_mirror_of_right() {
    let turn = |steering| {
        let mut world = level();
        drive(&mut world, pedals(0.15, 0.0, steering).0, 6.0);
        world.pose()
    };
    let (left, right) = (turn(0.3), turn(-0.3));
    assert!(left.x_m < -2.0 && left.theta_rad > 0.3, "{left:?}");
    assert!((left.x_m + right.x_m).abs() < 2e-3 && (left.y_m - right.y_m).abs() < 2e-3, "{left:?} {right:?}");
    assert!((left.theta_rad + right.theta_rad).abs() < 1e-3);
}

/// Rolling without slip, the rear axle's middle goes round with the curvature tan(delta) / wheelbase; tyres give way by
/// about a hundredth at walking pace.
#[test]
fn turns_about_the_centre_that_its_wheels_point_at() {
    let mut world = level();
    drive(&mut world, pedals(0.02, 0.0, 0.5).0, 12.0);
    let before = world.pose();
    drive(&mut world, pedals(0.02, 0.0, 0.5).0, 1.0);
    let after = world.pose();
    let turned_rad = wrap_rad(after.theta_rad - before.theta_rad);
    let curvature = turned_rad / (0.5 * (before.v_m_per_s.unwrap() + after.v_m_per_s.unwrap()));
    let wanted = asami_math::elementary::tan(0.5 * 0.6) / Blueprint::shipped(Model::default()).unwrap().wheelbase_m();
    assert!((curvature / wanted - 1.0).abs() < 0.03, "{curvature} against {wanted} per metre");
}

/// Rolling down a hill with the engine cut off, what weight gives less what tyres take is in the speed of body and
/// wheels: (m + 4 J / r^2) v^2 / 2 = m g (sin - c cos) s.
#[test]
fn a_car_rolling_down_a_hill_keeps_its_energy() {
    let (slope, mut config) = (0.06_f32, CarConfig::default());
    config.engine.converter_n_m_s2 = 0.0;
    config.engine.air_drag_n_s2_per_m2 = 0.0;
    let mut world = along(&[[-50.0, 50.0 * slope], [250.0, -250.0 * slope]], &config);
    // From when it rolls at an even pitch.
    drive(&mut world, pedals(0.0, 0.0, 0.0).0, 2.0);
    let (y0_m, v0) = (world.pose().y_m, speed_m_per_s(&world));
    drive(&mut world, pedals(0.0, 0.0, 0.0).0, 8.0);
    let (y1_m, v1) = (world.pose().y_m, speed_m_per_s(&world));
    let angle = asami_math::elementary::atan(f64::from(slope));
    let (sin, cos) = asami_math::elementary::sin_cos(angle);
    let blueprint = Blueprint::shipped(Model::default()).unwrap();
    let wheels_kg = 4.0 * blueprint.wheels[0].inertia_kg_m2 / (0.353 * 0.353);
    // Poses are level: way and speed along the hill are 1 / cos of them.
    let kinetic = 0.5 * (blueprint.mass_kg + wheels_kg) * (v1 * v1 - v0 * v0) / (cos * cos);
    let work = blueprint.mass_kg * 9.81 * (sin - config.tyre.rolling_resistance * cos) * (y1_m - y0_m) / cos;
    assert!((kinetic / work - 1.0).abs() < 0.01, "{kinetic} J of {work} J");
}

/// Locked wheels slide: all that the road can give is the friction coefficient times the weight.
#[test]
fn brakes_are_no_stronger_than_friction() {
    for friction in [0.3, 0.85] {
        let mut config = CarConfig::default();
        config.physics.friction = friction;
        let mut world = along(&[[-50.0, 0.0], [300.0, 0.0]], &config);
        drive(&mut world, pedals(0.4, 0.0, 0.0).0, 7.0);
        drive(&mut world, pedals(0.0, 1.0, 0.0).0, 0.5);
        let v0 = speed_m_per_s(&world);
        drive(&mut world, pedals(0.0, 1.0, 0.0).0, 0.5);
        let deceleration = (v0 - speed_m_per_s(&world)) / 0.5;
        assert!((deceleration / (friction * 9.81) - 1.0).abs() < 0.04, "{deceleration} m/s^2 at {friction}");
    }
}

/// The tyres' grip is theirs, not the time step's.
#[test]
fn half_the_time_step_drives_the_same_way() {
    let drive = |time_step_s: f64, steps_per_tick: u32| {
        let mut config = CarConfig::default();
        (config.physics.time_step_s, config.physics.steps_per_tick) = (time_step_s, steps_per_tick);
        let mut world = along(&[[-50.0, 0.0], [300.0, 0.0]], &config);
        drive(&mut world, pedals(0.2, 0.0, 0.1).0, 6.0);
        drive(&mut world, pedals(0.0, 0.25, -0.1).0, 1.0);
        world.pose()
    };
    let (coarse, fine) = (drive(0.0025, 20), drive(0.00125, 40));
    assert!((coarse.x_m - fine.x_m).hypot(coarse.y_m - fine.y_m) < 0.05, "{coarse:?} {fine:?}");
    assert!((coarse.theta_rad - fine.theta_rad).abs() < 0.005);
}

/// Full braking torque below the limit of friction: with the engine off, the deceleration is torque by radius and mass.
#[test]
fn knobs_turn_mass_brakes_and_steering() {
    let deceleration = |mass_ratio: f64, brake_ratio: f64| {
        let mut config = CarConfig::default();
        config.engine.converter_n_m_s2 = 0.0;
        config.engine.air_drag_n_s2_per_m2 = 0.0;
        let mut world = along(&[[-50.0, 5.0], [60.0, -6.0], [300.0, -6.0]], &config);
        drive(&mut world, pedals(0.0, 0.0, 0.0).0, 16.0);
        world.nominal.vehicle.mass_ratio = mass_ratio;
        world.nominal.vehicle.brake_ratio = brake_ratio;
        drive(&mut world, pedals(0.0, 0.15, 0.0).0, 1.0);
        let v0 = speed_m_per_s(&world);
        drive(&mut world, pedals(0.0, 0.15, 0.0).0, 1.0);
        (v0 - speed_m_per_s(&world)) - 0.014 * 9.81
    };
    let (plain, heavy, weak) = (deceleration(1.0, 1.0), deceleration(1.25, 1.0), deceleration(1.0, 0.5));
    let wanted = 0.15 * 7200.0 / (0.353 * 2013.0);
    assert!((plain / wanted - 1.0).abs() < 0.05, "{plain} against {wanted}");
    assert!((heavy / plain - 1.0 / 1.25).abs() < 0.03 && (weak / plain - 0.5).abs() < 0.03, "{heavy} {weak}");

    let mut world = level();
    world.nominal.vehicle.steering_offset_rad = 0.02;
    drive(&mut world, pedals(0.1, 0.0, 0.0).0, 5.0);
    assert!(world.pose().theta_rad > 0.05, "{:?}", world.pose());
}

#[test]
fn a_delay_repeats_the_drive_later() {
    let delayed = Effects { command_delay: Some(CommandDelay { delay_s: 0.3 }), ..Effects::default() };
    let action = pedals(0.2, 0.0, 0.05).0;
    let (mut prompt, mut late) = (level(), on(&Ground::level(300.0), &delayed));
    drive(&mut prompt, action, 5.0);
    drive(&mut late, action, 5.3);
    let (a, b) = (prompt.pose(), late.pose());
    assert!((a.x_m - b.x_m).abs() < 2e-3 && (a.y_m - b.y_m).abs() < 2e-3, "{a:?} {b:?}");
}

/// Off, round a corner and on the brake: where triangles are felt and where there are none.
#[test]
fn an_endless_plane_is_a_level_one() {
    let mut worlds = [level(), on(&Ground::endless(), &Effects::default())];
    for (throttle, brake, steering, lasts_s) in [(0.3, 0.0, 0.0, 4.0), (0.1, 0.0, 0.4, 4.0), (0.0, 0.4, 0.0, 3.0)] {
        let ends_s = worlds[0].t_s() + lasts_s;
        while worlds[0].t_s() < ends_s {
            let action = Action::Pedals { throttle, brake, steering };
            worlds.iter_mut().for_each(|world| world.tick(action, &mut Record::default()));
        }
        let [a, b] = worlds.each_ref().map(CarWorld::pose);
        assert!((a.x_m - b.x_m).hypot(a.y_m - b.y_m) < 2e-3 && (a.theta_rad - b.theta_rad).abs() < 1e-4, "{a:?} {b:?}");
    }
    assert!(worlds[1].pose().y_m > 5.0);
}

/// The race car weighs what its specification says, is where that says it is, and turns as it says.
#[test]
fn the_race_car_is_as_specified() {
    let race = Blueprint::shipped(Model::Av21).unwrap();
    assert!((race.mass_kg - 815.11).abs() < 0.01, "{}", race.mass_kg);
    assert!((race.wheelbase_m() - 2.9718).abs() < 1e-4);
    let behind_front_m = race.wheels[0].hub_m.x - race.centre_of_mass_m.x;
    assert!((behind_front_m - 1.6785).abs() < 1e-3, "{behind_front_m}");
    let own = race.inertia_kg_m2.diagonal();
    assert!((own - Vector3::new(265.0, 550.0, 800.0)).amax() < 1.0, "{own}");
}
