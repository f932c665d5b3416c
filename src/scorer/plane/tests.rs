use asami_dataset::models::Entry;
use asami_dataset::{Beacon, Known, Sighting, Size};

use super::*;

fn velocity(action: u16) -> Velocity {
    let i = f64::from(action);
    Velocity { action, vx_m_per_s: 0.01 * i, vy_m_per_s: 0.3 - 0.02 * i, vtheta_rad_per_s: 0.1 * (i - 10.0) }
}

fn survey() -> Survey {
    let height = |i: u32| {
        let distance_m = 1.275 + 0.1 * f64::from(i);
        // Noise grows with the distance.
        let (sd_px, bearing_sd_rad) = (distance_m, 0.01 * distance_m);
        Height { distance_m, height_px: 40.0 - 8.0 * distance_m, sd_px, bearing_sd_rad, readings: 100 }
    };
    Survey {
        velocity_by_action: (0..21).map(velocity).collect(),
        height_by_distance: (0..30).map(height).collect(),
        ..Survey::default()
    }
}

/// A robot that stands `distance_m` before a landmark, for so many sightings each.
fn stood(at: &[(f64, usize)]) -> (Log, Truth) {
    let (mut sightings, mut track) = (Vec::new(), Vec::new());
    for (distance_m, count) in at {
        for _ in 0..*count {
            let t_s = 0.1 * track.len() as f64;
            track.push(TruePose { t_s, x_m: 0.0, y_m: -distance_m, theta_rad: 0.0, v_m_per_s: None });
            sightings.push(Sighting { t_s, landmark: 3, size: Size::HeightPx(20.0), bearing_rad: 0.0 });
        }
    }
    let landmarks = vec![Beacon { id: 3, x_m: 0.0, y_m: 0.0, height_m: None }];
    let log =
        Log { known: Known { landmarks, ..Known::default() }.into(), sightings: sightings.into(), ..Log::default() };
    (log, Truth { track: track.into(), survey: Some(survey()) })
}

fn table(off: [f64; 3], se: f64) -> ActionModel {
    let entry = |action: u16| {
        let Velocity { vx_m_per_s, vy_m_per_s, vtheta_rad_per_s, .. } = velocity(action);
        Entry {
            action,
            vx_m_per_s: vx_m_per_s + off[0],
            vy_m_per_s: vy_m_per_s - off[1],
            vtheta_rad_per_s: vtheta_rad_per_s + off[2],
            se: Some([se; 3]),
        }
    };
    ActionModel::Table((0..21).map(entry).collect())
}

#[test]
fn errors_are_root_mean_squares_over_the_actions_without_scaling() {
    let (log, truth) = stood(&[(2.0, 10)]);
    let yardstick = Yardstick::of(&log, &truth);
    let f = Polynomial::plain(vec![41.5, -8.0]);
    let models = Models {
        action: Some(table([0.003, 0.004, 0.05], 0.0025)),
        sensor: Some(SensorModel::HeightOfDistance(f.into())),
        ..Models::default()
    };
    let scores = yardstick.score(&models);
    for (found, due) in scores.velocity_rmse.unwrap().into_iter().zip([0.003, 0.004, 0.05]) {
        assert!((found - due).abs() < 1e-12);
    }
    assert!((scores.sensor_rmse.unwrap() - 1.5).abs() < 1e-12);
    // 1.96 x 0.0025 covers 3 and 4 mm/s, not 0.05 rad/s.
    assert_eq!(scores.covered, Some([42, 63]));
    assert!(yardstick.faults(&models, &scores, 0.75).is_empty());
    assert_eq!(yardstick.velocity_ranges().map(|ranges| ranges.map(|r| (1e9 * r).round())), Some([2e8, 4e8, 2e9]));
}

#[test]
fn true_noise_counts_each_distance_as_often_as_it_occurred() {
    let (log, truth) = stood(&[(1.275, 30), (4.175, 10)]);
    let yardstick = Yardstick::of(&log, &truth);
    let sd = ((30.0 * 1.275_f64.powi(2) + 10.0 * 4.175_f64.powi(2)) / 40.0).sqrt();
    assert!((yardstick.sigma1.unwrap() - sd).abs() < 1e-12);
    assert!((yardstick.sigma2_rad.unwrap() - 0.01 * sd).abs() < 1e-12);
}

#[test]
fn one_direction_alone_may_diverge() {
    let (log, truth) = stood(&[(2.0, 10)]);
    let yardstick = Yardstick::of(&log, &truth);
    let models = Models { action: Some(table([0.0, 0.5, 0.0], 0.1)), ..Models::default() };
    let faults = yardstick.faults(&models, &yardstick.score(&models), 0.75);
    assert_eq!(faults.len(), 1);
    assert!(faults[0].starts_with("v_y R^2 -"), "{faults:?}");
    let nan = Models { action: Some(table([f64::NAN, 0.0, 0.0], 0.1)), ..Models::default() };
    let faults = yardstick.faults(&nan, &yardstick.score(&nan), 0.75);
    assert_eq!(faults, ["v_x is not finite", "v_y is not finite", "v_theta is not finite"]);
}

#[test]
fn no_cubic_beats_the_floor() {
    let (log, mut truth) = stood(&[(2.0, 10)]);
    if let Some(survey) = &mut truth.survey {
        for height in &mut survey.height_by_distance {
            height.height_px = 38.3887 / (height.distance_m - 0.1);
        }
    }
    let yardstick = Yardstick::of(&log, &truth);
    let best = yardstick.best_sensor(3).unwrap();
    let score = |sensor: SensorModel| {
        yardstick.score(&Models { sensor: Some(sensor), ..Models::default() }).sensor_rmse.unwrap()
    };
    let floor = score(best.clone());
    assert!(floor > 0.0);
    let SensorModel::HeightOfDistance(curve) = best else { panic!("heights") };
    for i in 0..4 {
        for nudge in [-1e-3, 1e-3] {
            let mut curve = curve.clone();
            curve.polynomial.coefficients[i] += nudge;
            assert!(score(SensorModel::HeightOfDistance(curve)) > floor);
        }
    }
}

/// A sensor 0.2 m ahead of the centre whose ranges are 3 % long and whose bearings are 0.02 rad off, while
/// the robot drives a circle about a landmark of two.
#[test]
fn a_track_tells_what_ranges_and_bearings_should_have_been() {
    let places = [[0.5, 4.0], [-3.0, -1.0]];
    let (mut sightings, mut track) = (Vec::new(), Vec::new());
    for n in 0..4000_u32 {
        let t_s = 0.05 * f64::from(n);
        let theta_rad = asami_math::angle::wrap_rad(0.3 * t_s);
        let (sin, cos) = theta_rad.sin_cos();
        let (x_m, y_m) = (1.5 * cos, 1.5 * sin);
        track.push(TruePose { t_s, x_m, y_m, theta_rad, v_m_per_s: None });
        let (from_x_m, from_y_m) = (x_m - 0.2 * sin, y_m + 0.2 * cos);
        for (landmark, place) in (0..).zip(places) {
            let (dx, dy) = (place[0] - from_x_m, place[1] - from_y_m);
            let size = Size::RangeM(1.03 * dx.hypot(dy));
            let bearing_rad = asami_math::angle::wrap_rad((-dx).atan2(dy) - theta_rad + 0.02);
            sightings.push(Sighting { t_s, landmark, size, bearing_rad });
        }
    }
    let landmark = |(id, [x_m, y_m]): (u16, [f64; 2])| Beacon { id, x_m, y_m, height_m: None };
    let range_bearing = Some(asami_dataset::log::RangeBearing { max_range_m: 9.0, sensor_origin_m: [0.0, 0.2] });
    let known = Known { landmarks: (0..).zip(places).map(landmark).collect(), range_bearing, ..Known::default() };
    let log = Log { known: known.into(), sightings: sightings.into(), ..Log::default() };
    let truth = Truth { track: track.into(), survey: None };
    let yardstick = Yardstick::of(&log, &truth);
    assert_eq!(yardstick.unit, Unit::RangeM);
    assert!(yardstick.sensor.len() >= 25);
    for [distance_m, range_m] in &yardstick.sensor {
        assert!((range_m - 1.03 * distance_m).abs() < 1e-9);
    }
    assert!(yardstick.sigma1.unwrap() < 1e-9 && yardstick.sigma2_rad.unwrap() < 1e-9);
}

/// Where all beacons are seen all but perfectly all the time, a velocity is as uncertain as the way made good is random: after `n` steps
/// of `dt` with standard deviation `sd` each, `sd / (dt sqrt(n))`.
#[test]
fn the_bound_of_a_robot_that_sees_all_but_perfectly_is_that_of_its_motion() {
    let text = include_str!("../../../scenarios/plain_2d.toml");
    let all_round = "sigma1_px = 1.0\nview_rad = 6.2\nrecognised = 1.0\nnear_m = 0.5\nfar_m = 20.0";
    let text = text.replace("sigma1_px = 1.0", all_round).replace("sigma2_rad = 0.5", "sigma2_rad = 0.0005");
    let scenario = crate::scenario::parse("plain_2d", "plain_2d.toml", &text).unwrap();
    let crate::scenario::Origin::Simulated(simulation) = &scenario.origin else { panic!("simulated") };
    let asami_dataset::Dataset { log, truth, .. } = simulation.dataset(asami_dataset::Seed(1000)).unwrap();
    let survey = crate::survey::at_hand(simulation, &[]).unwrap().unwrap();
    let truth = Truth { survey: Some(survey.clone()), ..truth };
    let yardstick = Yardstick::of(&log, &truth);
    let bound = bound::bound(&yardstick, &log, &truth).unwrap();

    let plane = asami_learners::plane::Plane::try_from(&log).unwrap();
    let sds = survey.motion_sd.unwrap();
    for i in 0..3 {
        let var = |held_s: f64| (sds[i] / 0.05).powi(2) / (held_s / 0.05);
        let due = (plane.actions.iter().map(|action| var(action.held_s)).sum::<f64>() / 40.0).sqrt();
        assert!((bound[i] / due - 1.0).abs() < 0.03, "direction {i}: {} for {due}", bound[i]);
    }
}
