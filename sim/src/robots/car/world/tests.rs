use asami_dataset::Dataset;

use super::*;
use crate::drives::driver::{Driver, Driving, Feel};
use crate::drives::hold::Hold;
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
    let blueprint = Blueprint::shipped().unwrap();
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
