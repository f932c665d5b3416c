//! A drive of chapter 5 as a whole: as lively as the dissertation's, three left turns, stops, on the street.

use asami_dataset::truth::pose_at;
use asami_dataset::{Action, Dataset, Seed};
use asami_math::angle::wrap_rad;
use asami_sim::drives::driver::{Driver, Driving, Feel};
use asami_sim::effects::Effects;
use asami_sim::robots::car::{CarConfig, CarWorld};
use asami_sim::scenes::town::{Route, Town, TownConfig};
use asami_sim::world::run;

const DRIVE_S: f64 = 200.0;
/// The step of chapter 5's scans.
const STEP_S: f64 = 0.5;

fn drive(seed: Seed) -> (Dataset, Route) {
    let town = Town::new(&TownConfig::default(), seed);
    let start = town.route.at(0.0).into();
    let mut world = CarWorld::new(&CarConfig::default(), &town.ground(), None, &Effects::default(), start, seed)
        .expect("the shipped car on the town's ground");
    let mut driver = Driver::new(Driving::default(), Feel::default(), town.route.clone(), 0.0, seed.stream("drive"));
    (run(&mut world, &mut driver, DRIVE_S), town.route)
}

/// Speeds and yaw rates over steps of half a second, from poses at their ends.
fn steps(drive: &Dataset) -> Vec<[f64; 2]> {
    let at = |i: usize| pose_at(&drive.truth.track, i as f64 * STEP_S).expect("a track without gaps");
    let step = |i: usize| {
        let (a, b) = (at(i), at(i + 1));
        let turn_rad = wrap_rad(b.theta_rad - a.theta_rad);
        let heading_rad = a.theta_rad + 0.5 * turn_rad;
        let forward_m = (b.y_m - a.y_m) * heading_rad.cos() - (b.x_m - a.x_m) * heading_rad.sin();
        [forward_m / STEP_S, turn_rad / STEP_S]
    };
    (0..(DRIVE_S / STEP_S) as usize).map(step).collect()
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), it| (low.min(it), high.max(it)));
    high - low
}

/// Of every fourth of the seeds that the example `driving` prints. Ranges within 20 % of Table 5.1's: 5.79 m/s^2, 6.30 m/s, 0.202 rad/s; three quarter turns to the left.
#[test]
fn drives_are_as_lively_as_the_dissertations() {
    for seed in (1000..1015).step_by(4) {
        let (drive, route) = drive(Seed(seed));
        let steps = steps(&drive);
        let ranges = [
            range(steps.windows(2).map(|pair| (pair[1][0] - pair[0][0]) / STEP_S)),
            range(steps.iter().map(|step| step[0])),
            range(steps.iter().map(|step| step[1])),
        ];
        for (range, wanted) in ranges.into_iter().zip([5.79, 6.30, 0.202]) {
            assert!((range / wanted - 1.0).abs() < 0.2, "seed {seed}: {ranges:?}");
        }
        let turned_deg: f64 = steps.iter().map(|step| (step[1] * STEP_S).to_degrees()).sum();
        assert!((turned_deg - 270.0).abs() < 5.0, "seed {seed} turns by {turned_deg} degrees");
        let stops = steps.windows(2).filter(|pair| pair[0][0] >= 0.2 && pair[1][0] < 0.2).count();
        assert!((4..=9).contains(&stops), "seed {seed} stops {stops} times");
        // Parked cars begin 0.5 m beside a car in its lane.
        let mut along_m = 0.0;
        for pose in drive.truth.track.iter() {
            along_m = route.along_m([pose.x_m, pose.y_m], along_m);
            let at = route.at(along_m);
            let aside_m = (pose.x_m - at.x_m).hypot(pose.y_m - at.y_m);
            let most_m = if at.curvature_per_m == 0.0 { 0.4 } else { 0.6 };
            assert!(aside_m < most_m, "seed {seed}: {aside_m} m off the route at {} s", pose.t_s);
        }
    }
}

/// Twenty commands a second, one foot for both pedals, nothing out of range; every command changes something.
#[test]
fn commands_are_a_persons() {
    let (drive, _) = drive(Seed(1000));
    let commands = &drive.log.commands;
    assert!(commands.len() > 3000, "{} commands", commands.len());
    let mut together = 0;
    for pair in commands.windows(2) {
        let ticks = (pair[1].t_s - pair[0].t_s) / 0.05;
        assert!((ticks - ticks.round()).abs() < 1e-6 && ticks > 0.5);
        let Action::Pedals { throttle, brake, steering } = pair[1].action else { panic!("a car has pedals") };
        assert!((0.0..=1.0).contains(&throttle) && (0.0..=1.0).contains(&brake) && steering.abs() <= 1.0);
        together += usize::from(throttle > 0.05 && brake > 0.05);
    }
    assert!(together < commands.len() / 200, "both pedals {together} times");
    assert_eq!(drive.log.known.robot, "car");
    assert!(drive.log.frames.is_none() && drive.log.sightings.is_empty());
}
