//! Known geometry, known ranges.

use asami_dataset::{Firings, Seed};
use asami_raycast::Parry;
use nalgebra::{UnitQuaternion, Vector3};

use super::*;

const SEED: Seed = Seed(1000);
/// Walls, floor and ceiling.
const ROOM_HALF_M: [f64; 3] = [6.0, 9.0, 3.0];

/// No noise, no loss.
fn quiet() -> VelodyneConfig {
    VelodyneConfig {
        range_sd_m: 0.0,
        dropouts: 0.0,
        half_lost_range_m: 1e5,
        least_range_m: 0.0,
        ..VelodyneConfig::default()
    }
}

fn box_mesh(half_m: [f64; 3]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { -half_m[k] as f32 } else { half_m[k] as f32 });
    let sides = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
    ((0..8).map(corner).collect(), sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

fn room() -> Scenery {
    let (vertices, triangles) = box_mesh(ROOM_HALF_M);
    Scenery::new(&vertices, &triangles, |_| 0.5).expect("a mesh")
}

/// A wall across the way, `at_m` ahead.
fn wall(at_m: f32, reflectivity: f64) -> Scenery {
    let vertices = [[-500.0, at_m, -500.0], [500.0, at_m, -500.0], [500.0, at_m, 500.0], [-500.0, at_m, 500.0]];
    Scenery::new(&vertices, &[[0, 1, 2], [0, 2, 3]], |_| reflectivity).expect("a mesh")
}

/// Poses every 10 ms of a sensor that moves and turns evenly from the middle of the room.
fn track(until_s: f64, velocity_m_per_s: [f64; 3], spin_rad_per_s: [f64; 3]) -> Vec<SensorPose> {
    (0..=(until_s * 100.0).round() as usize)
        .map(|k| {
            let t_s = k as f64 * 0.01;
            SensorPose {
                t_s,
                position_m: velocity_m_per_s.map(|v| v * t_s),
                world_from_sensor: UnitQuaternion::from_scaled_axis(Vector3::from(spin_rad_per_s) * t_s),
            }
        })
        .collect()
}

/// Where a return comes from, by eq. 2.35 of Stronger 2008 about the sensor as it moves: time and angle of the firing,
/// told by its number.
fn point_m(
    config: &VelodyneConfig,
    unit: &Unit,
    [velocity, spin]: [[f64; 3]; 2],
    firings: &Firings,
    laser: usize,
    firing: usize,
) -> Option<Vector3<f64>> {
    let d = firings.range_m(laser, firing)?;
    let Laser { vertical_rad, horizontal_rad } = unit.lasers()[laser];
    let t_s = firing as f64 / config.firing_rate_hz;
    let theta = horizontal_rad - std::f64::consts::TAU * config.turn_rate_hz * t_s + config.base_rad;
    let look = Vector3::new(vertical_rad.cos() * theta.cos(), vertical_rad.cos() * theta.sin(), vertical_rad.sin());
    let left_m = config.offset_m * if laser.is_multiple_of(2) { 1.0 } else { -1.0 };
    let from = Vector3::new(-theta.sin(), theta.cos(), 0.0) * left_m;
    let t_s = t_s + config.bank_s * laser as f64 / 63.0;
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(spin) * t_s);
    Some(Vector3::from(velocity) * t_s + turn * (from + look * d))
}

/// The farthest that any return lies off the room's walls; all beams must have returns.
fn off_walls_m(config: &VelodyneConfig, motion: [[f64; 3]; 2], assumed: [[f64; 3]; 2]) -> f64 {
    let unit = Unit::art();
    let velodyne = Velodyne::new(config.clone(), unit.clone());
    let firings = velodyne.scan(&room(), &track(0.25, motion[0], motion[1]), SEED).expect("a track");
    firings.check().expect("firings that fit together");
    assert_eq!((firings.len(), firings.lasers()), (1950, 64));
    let mut worst_m = 0.0_f64;
    for (laser, firing) in (0..64).flat_map(|laser| (0..firings.len()).map(move |firing| (laser, firing))) {
        let point = point_m(config, &unit, assumed, &firings, laser, firing).expect("a return");
        let off = (0..3).map(|k| point[k].abs() - ROOM_HALF_M[k]).fold(f64::NEG_INFINITY, f64::max);
        worst_m = worst_m.max(off.abs());
    }
    worst_m
}

/// Half a unit of the range, and single precision.
const EXACT_M: f64 = 0.00105;
const STILL: [[f64; 3]; 2] = [[0.0; 3]; 2];

#[test]
fn a_wall_stands_where_it_stands() {
    let (config, unit) = (quiet(), Unit::art());
    let firings =
        Velodyne::new(config.clone(), unit.clone()).scan(&wall(20.0, 0.5), &track(0.1, [0.0; 3], [0.0; 3]), SEED);
    let firings = firings.expect("a track");
    let mut returns = 0;
    for (laser, firing) in (0..64).flat_map(|laser| (0..firings.len()).map(move |firing| (laser, firing))) {
        let laser_angles = unit.lasers()[laser];
        let theta = laser_angles.horizontal_rad + firings.theta_r_rad(firing).expect("a firing") + config.base_rad;
        let ahead = laser_angles.vertical_rad.cos() * theta.sin();
        match firings.range_m(laser, firing) {
            // The encoder reads hundredths of a degree: the angle is known to half of that.
            Some(range_m) => {
                let slack_m = 0.00105 + range_m * range_m / 20.0 * 0.9e-4;
                assert!((range_m - 20.0 / ahead).abs() < slack_m, "{laser} {firing}: {range_m} {}", 20.0 / ahead);
                returns += 1;
            }
            None => assert!(ahead < 20.0 / 119.9, "{laser} {firing}"),
        }
    }
    // The wall is within reach over 2 acos(20/120 / cos(vertical)) of a turn.
    let share = returns as f64 / (64.0 * firings.len() as f64);
    assert!((share - (20.0_f64 / 120.0).acos() / std::f64::consts::PI).abs() < 0.005, "{share}");
}

#[test]
fn a_still_sensor_sees_the_room() {
    assert!(off_walls_m(&quiet(), STILL, STILL) < EXACT_M);
}

#[test]
fn a_turning_sensor_sees_the_room_at_its_angles() {
    let turning = [[0.0; 3], [0.0, 0.0, 1.5]];
    assert!(off_walls_m(&quiet(), turning, turning) < 0.0012);
    assert!(off_walls_m(&quiet(), turning, STILL) > 1.0);
}

/// Fast enough for the 48 us within a bank to matter: 100 m/s * 48 us = 4.8 mm.
#[test]
fn a_moving_and_pitching_sensor_sees_the_room_when_every_laser_has_its_own_time() {
    let (gallop, pitch) = ([3.0, 8.0, 0.5], [0.8, -0.6, 1.0]);
    let moving = [gallop, pitch];
    assert!(off_walls_m(&quiet(), moving, moving) < 0.0015);
    assert!(off_walls_m(&quiet(), moving, [gallop, [0.0; 3]]) > 0.5);
    assert!(off_walls_m(&quiet(), moving, [[0.0; 3], pitch]) > 0.5);
}

#[test]
fn lasers_of_one_revolution_and_of_one_firing_have_different_origins() {
    let speed = 200.0;
    let (config, unit) = (quiet(), Unit::art());
    let velodyne = Velodyne::new(config.clone(), unit.clone());
    let firings = velodyne.scan(&wall(60.0, 0.5), &track(0.1, [0.0, speed, 0.0], [0.0; 3]), SEED).expect("a track");
    // Where a beam began: the wall less what it measured.
    let began_m = |laser: usize, firing: usize| {
        let end = point_m(&config, &unit, STILL, &firings, laser, firing).expect("a return");
        60.0 - end.y
    };
    let (first, last) = (began_m(0, 10), began_m(63, 10));
    assert!((last - first - speed * config.bank_s).abs() < 0.003, "{first} {last}");
    let later = began_m(0, 60);
    assert!((later - first - speed * 50.0 / 7800.0).abs() < 0.003, "{first} {later}");
}

#[test]
fn lasers_may_stand_off_the_axis() {
    let config = VelodyneConfig { offset_m: 0.026, ..quiet() };
    assert!(off_walls_m(&config, STILL, STILL) < EXACT_M);
    let moving = [[1.0, 5.0, 0.0], [0.1, 0.1, 0.5]];
    assert!(off_walls_m(&config, moving, moving) < 0.0015);
    // It matters: left out, it shows.
    let unit = Unit::art();
    let firings =
        Velodyne::new(config, unit.clone()).scan(&room(), &track(0.1, [0.0; 3], [0.0; 3]), SEED).expect("a track");
    let point = (0..780).filter_map(|firing| point_m(&quiet(), &unit, STILL, &firings, 40, firing));
    let off = point.map(|p| (p.x.abs() - 6.0).max(p.y.abs() - 9.0).abs()).fold(0.0, f64::max);
    assert!(off > 0.02 && off < 0.05, "{off}");
}

/// Ranges of a wall that is looked at squarely err as the normal distribution does: bounds are five standard errors.
#[test]
fn ranges_are_as_noisy_as_told_and_returns_get_lost_as_often() {
    let config = VelodyneConfig { range_sd_m: 0.05, dropouts: 0.1, ..quiet() };
    let unit = Unit::art();
    let scenery = room();
    let poses = track(1.0, [0.0; 3], [0.0; 3]);
    let noisy = Velodyne::new(config, unit.clone()).scan(&scenery, &poses, SEED).expect("a track");
    let clean = Velodyne::new(quiet(), unit).scan(&scenery, &poses, SEED).expect("a track");
    let (mut n, mut sum, mut squares, mut fourths, mut total) = (0.0_f64, 0.0, 0.0, 0.0, 0.0);
    for (noisy, clean) in noisy.range_2mm.iter().flatten().zip(clean.range_2mm.iter().flatten()) {
        total += 1.0;
        if *noisy > 0 {
            let error = (f64::from(*noisy) - f64::from(*clean)) / 25.0;
            n += 1.0;
            sum += error;
            squares += error * error;
            fourths += error.powi(4);
        }
    }
    // Two roundings to 1/25 of the deviation add 2/12 of that, squared.
    let variance = 1.0 + 2.0 / 12.0 / 625.0;
    assert!((sum / n).abs() < 5.0 / n.sqrt(), "{}", sum / n);
    assert!((squares / n - variance).abs() < 5.0 * (2.0 / n).sqrt(), "{}", squares / n);
    assert!((fourths / n - 3.0 * variance * variance).abs() < 5.0 * (96.0 / n).sqrt(), "{}", fourths / n);
    assert!((n / total - 0.9).abs() < 5.0 * (0.09 / total).sqrt(), "{}", n / total);
}

#[test]
fn weak_returns_get_lost_and_intensity_is_what_comes_back() {
    let poses = track(1.0, [0.0; 3], [0.0; 3]);
    let beam = Unit::of(vec![Laser { vertical_rad: 0.0, horizontal_rad: 0.0 }]);
    let seen = |reflectivity: f64, half_lost_range_m: f64| {
        let config = VelodyneConfig { half_lost_range_m, ..quiet() };
        let firings =
            Velodyne::new(config, beam.clone()).scan(&wall(30.0, reflectivity), &poses, SEED).expect("a track");
        // Straight ahead, give or take 5 degrees: the first firing of a revolution looks 0.9 degrees to the right.
        let ahead: Vec<usize> = (0..firings.len()).filter(|i| (i + 10) % 780 < 20).collect();
        let returns: Vec<u8> =
            ahead.iter().filter(|i| firings.range_2mm[0][**i] > 0).map(|i| firings.intensity[0][*i]).collect();
        (returns.len() as f64 / ahead.len() as f64, returns)
    };
    let (share, intensities) = seen(0.6, 1e5);
    assert!(share > 0.999 && intensities.iter().all(|i| (152..=153).contains(i)), "{intensities:?}");
    // Odds of one to one: 200 draws.
    let (share, _) = seen(1.0, 30.0);
    assert!((share - 0.5).abs() < 0.18, "{share}");
    // A quarter of the light: one to sixteen.
    let (share, _) = seen(0.25, 30.0);
    assert!(share < 0.06 + 5.0 * (0.06_f64 / 200.0).sqrt(), "{share}");
}

#[test]
fn threads_do_not_change_bits() {
    let scan = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let velodyne = Velodyne::new(VelodyneConfig::default(), Unit::art());
        pool.install(|| velodyne.scan(&room(), &track(0.3, [1.0, 5.0, 0.0], [0.0, 0.1, 0.3]), SEED)).expect("a track")
    };
    let one = scan(1);
    assert_eq!(one, scan(3));
    assert_eq!(one, scan(2));
}

/// Streams by purpose: losing returns leaves the noise of the others as it is, and another seed changes both.
#[test]
fn losses_do_not_touch_noise() {
    let scan = |dropouts: f64, seed: u64| {
        let config = VelodyneConfig { dropouts, ..VelodyneConfig::default() };
        let poses = track(0.2, [0.0; 3], [0.0; 3]);
        Velodyne::new(config, Unit::art()).scan(&room(), &poses, Seed(seed)).expect("a track")
    };
    let (few, many, other) = (scan(0.0, 1000), scan(0.5, 1000), scan(0.0, 1001));
    let rows = |firings: &Firings| firings.range_2mm.iter().flatten().copied().collect::<Vec<u16>>();
    let (few, many, other) = (rows(&few), rows(&many), rows(&other));
    assert!(few.iter().zip(&many).all(|(a, b)| *b == 0 || a == b));
    let lost = many.iter().filter(|r| **r == 0).count() as f64 / many.len() as f64;
    assert!((lost - 0.5).abs() < 0.02, "{lost}");
    assert!(few.iter().zip(&other).filter(|(a, b)| a != b).count() > few.len() / 2);
}

#[test]
fn another_caster_sees_the_same() {
    let (vertices, triangles) = box_mesh(ROOM_HALF_M);
    let parry = Parry::new(&vertices, &triangles).expect("a mesh");
    let theirs = Scenery::seen_by(Box::new(parry), &vertices, &triangles, |_| 0.5);
    let velodyne = Velodyne::new(VelodyneConfig::default(), Unit::art());
    let poses = track(0.1, [1.0, 5.0, 0.0], [0.0, 0.1, 0.3]);
    let scan = |scenery: &Scenery| velodyne.scan(scenery, &poses, SEED).expect("a track");
    let (a, b) = (scan(&room()), scan(&theirs));
    let apart = a.range_2mm.iter().flatten().zip(b.range_2mm.iter().flatten()).filter(|(a, b)| a.abs_diff(**b) > 1);
    assert_eq!(apart.count(), 0);
}

#[test]
fn a_track_that_says_too_little_is_refused() {
    let velodyne = Velodyne::new(quiet(), Unit::art());
    let good = track(0.1, [0.0; 3], [0.0; 3]);
    let refused = |poses: &[SensorPose]| velodyne.scan(&room(), poses, SEED).expect_err("no track");
    assert_eq!(refused(&good[..1]), TrackError::Short(1));
    let mut bad = good.clone();
    bad[3].t_s = bad[2].t_s;
    assert_eq!(refused(&bad), TrackError::Pose { pose: 3, t_s: bad[2].t_s });
    let mut bad = good.clone();
    bad[5].position_m[1] = f64::NAN;
    assert!(matches!(refused(&bad), TrackError::Pose { pose: 5, .. }));
    // Two poses a moment apart hold one firing.
    let mut short = good[..2].to_vec();
    short[1].t_s = 1e-4;
    assert_eq!(velodyne.scan(&room(), &short, SEED).expect("a track").len(), 1);
}

#[test]
fn what_is_to_be_learned_is_the_lasers_angles_from_the_base() {
    let angles = Velodyne::new(quiet(), Unit::art()).horizontal_angles_rad();
    let expected =
        Unit::art().lasers().iter().map(|laser| laser.horizontal_rad + 89.1_f64.to_radians()).collect::<Vec<_>>();
    assert!(angles.len() == 64 && angles.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
}
