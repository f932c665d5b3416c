//! What each variant is for, on drives that differ from the published method's assumptions in that.

use std::collections::BTreeMap;
use std::sync::Arc;

use asami_dataset::{ActionModel, Log, Models, Seed, SensorModel};
use asami_learners::Learners;
use asami_learners::car_lines::CarLines;
use asami_learners::lidar::{AsOf, Drive, Motion, Odometry, Offsets, Sensor, from_slopes, slopes};

use crate::synthetic::{Driven, Ride, learn};

/// Errors of the learned angles, the common one removed, and their standard errors; degrees.
fn errors(name: &str, driven: &Driven) -> (Vec<f64>, Vec<f64>) {
    let learned = learn(name, &driven.log).unwrap();
    let Some(SensorModel::Angles { horizontal_angles_rad, se_rad }) = learned.models.sensor else { panic!() };
    let off: Vec<f64> =
        horizontal_angles_rad.iter().zip(&driven.angles_rad).map(|(a, b)| (a - b).to_degrees()).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    (off.iter().map(|e| e - mean).collect(), se_rad.iter().map(|se| se.to_degrees()).collect())
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

#[test]
fn a_graph_of_fine_lags_beats_the_chain_of_steps() {
    let driven = Ride::default().drive();
    let (chain, _) = errors("car_published", &driven);
    let (graph, _) = errors("car_graph", &driven);
    // The bar on simulated drives with lasers on the axis.
    assert!(rms(&graph) < 0.05 && rms(&graph) < 0.5 * rms(&chain), "{graph:?} and {chain:?}");
}

#[test]
fn offsets_off_the_axis_are_found_and_undone() {
    let ride = Ride { offset_m: 0.06, firings: 1500, turns: 14, ..Ride::default() };
    let driven = ride.drive();
    let sensor = Sensor::graph(23.0, 5.0, 2.0);
    let drive = Drive::try_from(&driven.log).unwrap();
    let angles = sensor.learn(&drive).unwrap();
    let slopes = slopes(&sensor, &drive, &angles.angle_rad, 3);
    for offsets in [Offsets::Alternating, Offsets::Sides] {
        let found = from_slopes(12, &slopes, offsets);
        assert!(found.iter().enumerate().all(|(l, o)| (o * found[0] > 0.0) == (l % 2 == 0)), "{offsets:?}: {found:?}");
        assert!((found[0] / 0.06 - 1.0).abs() < 0.3, "{offsets:?}: {found:?}");
    }
    let on_axis = rms(&errors("car_graph", &driven).0);
    for name in ["car_alternating", "car_sides"] {
        let off_axis = rms(&errors(name, &driven).0);
        assert!(off_axis < 0.5 * on_axis, "{name}: {off_axis} and {on_axis}");
    }
}

#[test]
fn lasers_on_the_axis_get_no_offset() {
    let driven = Ride { firings: 1000, turns: 20, ..Ride::default() }.drive();
    let sensor = Sensor::graph(23.0, 5.0, 2.0);
    let drive = Drive::try_from(&driven.log).unwrap();
    let angles = sensor.learn(&drive).unwrap();
    let slopes = slopes(&sensor, &drive, &angles.angle_rad, 3);
    for offsets in [Offsets::Alternating, Offsets::Sides] {
        assert_eq!(from_slopes(12, &slopes, offsets), [0.0; 12], "{offsets:?}");
    }
}

/// Of a drive whose first and last turn alone saw anything, two turns are those two.
#[test]
fn few_turns_are_spread_over_the_whole_drive() {
    let mut log = Ride { turns: 9, ..Ride::default() }.drive().log;
    let mut firings = (**log.firings.as_ref().unwrap()).clone();
    let n = firings.len();
    firings.range_2mm.iter_mut().for_each(|ranges| ranges[780..n - 780].fill(0));
    log.firings = Some(Arc::new(firings));
    let drive = Drive::try_from(&log).unwrap();
    let of = |most_turns| Sensor { most_turns, ..Sensor::graph(23.0, 5.0, 2.0) }.learn(&drive).unwrap().angle_rad;
    let (all, two) = (of(0), of(2));
    assert!(all.iter().zip(&two).all(|(a, b)| (a - b).abs() < 1e-3), "{all:?} and {two:?}");
}

/// An action model that is given moves where matching begins, not where it ends.
#[test]
fn scan_matching_ends_where_it_did_from_a_given_model() {
    let ride = Ride { turns: 60, ..Ride::default() };
    let driven = ride.drive();
    let learner = Learners::default().configured("car_lines", &BTreeMap::new()).unwrap();
    let forward = |factor: f64, log: &Log| {
        let action = ActionModel::Car { c: ride.c.map(|c| factor * c), se: None, delay_s: 0.0 };
        let given = Models { action: Some(action), ..Models::default() };
        let given = if factor == 0.0 { Models::default() } else { given };
        let learned = learner.learn(log, &given, &mut Seed(1000).stream("learner")).unwrap();
        learned.traces.iter().find(|trace| trace.name == "forward_m_per_s").unwrap().points.clone()
    };
    let published = forward(0.0, &driven.log);
    for factor in [0.5, 1.0] {
        for (a, b) in published.iter().zip(forward(factor, &driven.log)) {
            assert!((a[1] - b[1]).abs() < 0.05, "{factor}: {a:?} and {b:?}");
        }
    }
}

/// Root mean square errors of the motions from turn to turn, metres and radians, on a car that speeds up, brakes and turns.
fn off_track(driven: &Driven, lines: CarLines, as_of: AsOf) -> [f64; 2] {
    let (drive, car) = (Drive::try_from(&driven.log).unwrap(), lines.car());
    let scans = drive.scans(0.0);
    let (cut, matching, angles_rad) = (car.cut, car.matching, &driven.angles_rad);
    let odometry = Odometry { drive: &drive, scans: &scans, angles_rad, cut, matching, as_of };
    let motions: Vec<Motion> = odometry.in_motion(&[]).into_iter().flatten().collect();
    assert_eq!(motions.len() + 1, scans.len());
    let firing = |t_s: f64| (t_s * 7800.0).round() as usize;
    let off = |motion: &Motion| {
        let [from, to] = [motion.t_s, motion.t_s + motion.dt_s].map(|t_s| driven.track[firing(t_s)]);
        let (sin, cos) = from[2].sin_cos();
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let found = motion.later_from_earlier;
        let apart = [found.x - (cos * x + sin * y), found.y - (cos * y - sin * x)];
        [(apart[0] * apart[0] + apart[1] * apart[1]).sqrt(), found.turn_rad - (to[2] - from[2])]
    };
    let all: Vec<[f64; 2]> = motions.iter().map(off).collect();
    [0, 1].map(|k| rms(&all.iter().map(|it| it[k]).collect::<Vec<_>>()))
}

/// What is wrong with a turn's speed moves its beginning, not its middle.
#[test]
fn a_turns_middle_is_better_known_than_its_beginning() {
    let driven = Ride { turns: 60, ..Ride::default() }.drive();
    let [beginning, middle] =
        [AsOf::Beginning, AsOf::Middle].map(|as_of| off_track(&driven, CarLines::default(), as_of));
    assert!(middle[0] < 0.8 * beginning[0] && middle[1] < 0.8 * beginning[1], "{middle:?} and {beginning:?}");
}

/// With the nose up the ground ahead is higher than the cut; its rings go with the car.
#[test]
fn the_ground_is_left_out_where_the_car_pitches() {
    let of = |pitch_deg: f64, least_slope: f64| {
        let driven = Ride { turns: 60, pitch_rad: pitch_deg.to_radians(), ..Ride::default() }.drive();
        off_track(&driven, CarLines { least_slope, ..CarLines::default() }, AsOf::Middle)[0]
    };
    let [level, fooled, pitched] = [of(0.0, 1.0), of(3.0, 0.0), of(3.0, 1.0)];
    assert!(fooled > 5.0 * level && pitched < 1.5 * level, "{level} level, {fooled} and {pitched} with the nose up");
}
