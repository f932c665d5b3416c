use asami_dataset::survey::{Height, Speed};
use asami_dataset::{Action, Beacon, Command, Known, Sighting, Size};
use asami_math::angle::wrap_rad;

use super::*;

/// Chapter 3's survey of a robot whose sensor is `38 / d` pixels and whose speed bends.
fn survey() -> Survey {
    let speed = |i: i32| {
        let command_m_per_s = f64::from(i) * 0.02;
        let speed_m_per_s = 0.9 * command_m_per_s - 2.0 * command_m_per_s.powi(3);
        Speed { command_m_per_s, speed_m_per_s, sd_m_per_s: 0.004, timings: 5 }
    };
    let height = |i: i32| {
        let distance_m = 1.2 + 0.2 * f64::from(i);
        Height { distance_m, height_px: 38.0 / distance_m, sd_px: 1.0, bearing_sd_rad: 0.02, readings: 100 }
    };
    Survey {
        speed_by_command: (-15..=15).map(speed).collect(),
        height_by_distance: (0..13).map(height).collect(),
        ..Survey::default()
    }
}

fn models(sensor: &[f64], action: &[f64]) -> Models {
    Models {
        sensor: Some(SensorModel::DistanceOfHeight(Polynomial::plain(sensor.to_vec()).into())),
        action: Some(ActionModel::Polynomial(Polynomial::plain(action.to_vec()).into())),
        ..Models::default()
    }
}

#[test]
fn a_model_that_is_right_but_for_its_unit_has_no_error() {
    let yardstick = Yardstick::surveyed(&survey());
    // The learner's unit is 1/3 m: speeds times 3.
    let scores = yardstick.score(&models(&[5.0], &[0.0, 2.7, 0.0, -6.0]));
    assert!(scores.action_rmse_m_per_s.unwrap() < 1e-15);
    assert!((scores.action_scale.unwrap() - 1.0 / 3.0).abs() < 1e-12);
    assert!((scores.action_r2.unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(yardstick.distance_range_m().map(|r| (r * 1e6).round()), Some(2.4e6));
}

#[test]
fn scores_do_not_depend_on_the_models_units() {
    let yardstick = Yardstick::surveyed(&survey());
    let (sensor, action) = ([-6.0, 0.3, -0.004], [0.01, 0.8, 0.1]);
    let one = yardstick.score(&models(&sensor, &action));
    for unit in [0.01, -3.0, 1e4] {
        let times = |c: &[f64]| c.iter().map(|c| c * unit).collect::<Vec<_>>();
        let mut shifted = times(&sensor);
        shifted[0] += 17.0;
        let other = yardstick.score(&models(&shifted, &times(&action)));
        let same = |a: Option<f64>, b: Option<f64>| (a.unwrap() / b.unwrap() - 1.0).abs() < 1e-9;
        assert!(same(one.sensor_rmse_m, other.sensor_rmse_m));
        assert!(same(one.action_rmse_m_per_s, other.action_rmse_m_per_s));
        assert!(same(one.scale_ratio(), other.scale_ratio()));
        assert_eq!(one.are_opposed(), other.are_opposed(), "both models turned round agree as before");
    }
}

#[test]
fn models_that_disagree_on_forward_are_opposed() {
    let yardstick = Yardstick::surveyed(&survey());
    // A place that grows with the height grows towards the beacon, and so does a positive speed's way.
    assert!(!yardstick.score(&models(&[0.0, 0.1], &[0.0, 1.0])).are_opposed());
    assert!(yardstick.score(&models(&[0.0, 0.1], &[0.0, -1.0])).are_opposed());
    assert!(yardstick.score(&models(&[0.0, -0.1], &[0.0, 1.0])).are_opposed());
}

#[test]
fn no_polynomial_of_the_degree_beats_the_floor() {
    let yardstick = Yardstick::surveyed(&survey());
    for degree in 1..5 {
        let best = Models {
            sensor: yardstick.best_sensor(degree),
            action: yardstick.best_action(degree),
            ..Models::default()
        };
        let floor = yardstick.score(&best);
        assert!((floor.scale_ratio().unwrap() - 1.0).abs() < 1e-9, "the floors are in metres already");
        let (Some(SensorModel::DistanceOfHeight(s)), Some(ActionModel::Polynomial(a))) = (&best.sensor, &best.action)
        else {
            panic!("floors are polynomials")
        };
        for i in 0..=degree {
            for nudge in [-1e-3, 1e-3] {
                let (mut s, mut a) = (s.clone(), a.clone());
                s.polynomial.coefficients[i] += nudge;
                a.polynomial.coefficients[i] += nudge;
                let nudged = yardstick.score(&Models {
                    sensor: Some(SensorModel::DistanceOfHeight(s)),
                    action: Some(ActionModel::Polynomial(a)),
                    ..Models::default()
                });
                assert!(nudged.sensor_rmse_m.unwrap() >= floor.sensor_rmse_m.unwrap() - 1e-12);
                assert!(nudged.action_rmse_m_per_s.unwrap() >= floor.action_rmse_m_per_s.unwrap() - 1e-12);
            }
        }
        if degree >= 3 {
            assert!(floor.action_rmse_m_per_s.unwrap() < 1e-12, "the survey's speeds are a cubic");
        }
    }
    assert!(yardstick.best_sensor(13).is_none(), "13 distances do not determine 14 coefficients");
}

#[test]
fn what_was_not_learned_or_is_not_measured_has_no_score() {
    let yardstick = Yardstick::surveyed(&survey());
    assert_eq!(yardstick.score(&Models::default()), Scores::default());
    assert_eq!(Yardstick::default().score(&models(&[0.0, 1.0], &[0.0, 1.0])), Scores::default());
    let flat = yardstick.score(&models(&[1.0], &[0.0]));
    assert_eq!((flat.action_rmse_m_per_s, flat.action_scale), (None, None));
    let none = yardstick.score(&models(&[f64::NAN], &[f64::INFINITY]));
    assert_eq!((none.sensor_rmse_m, none.action_rmse_m_per_s), (None, None));
}

/// 30 s of walking to and fro on a line through the landmark, under any heading: speed 0.8 c.
fn walk(theta_rad: f64) -> (Log, Vec<TruePose>) {
    let forward = [-theta_rad.sin(), theta_rad.cos()];
    let command = |n: u32| {
        let speed = 0.1 * f64::from(n % 3) - 0.05;
        let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: speed, atheta_rad_per_s: 0.0 };
        Command { t_s: f64::from(n) * 1.7, action }
    };
    let commands: Vec<Command> = (0..18).map(command).collect();
    let mut track = Vec::new();
    let mut place_m = 0.0;
    for n in 0..=3000 {
        let t_s = f64::from(n) * 0.01;
        let [x_m, y_m] = forward.map(|part| part * place_m);
        track.push(TruePose { t_s, x_m, y_m, theta_rad: wrap_rad(theta_rad), v_m_per_s: None });
        let in_force = commands.iter().rfind(|command| command.t_s <= t_s + 1e-9).unwrap();
        place_m += 0.8 * in_force.action.forward_m_per_s().unwrap() * 0.01;
    }
    let [x_m, y_m] = forward.map(|part| part * 3.0);
    let see = |pose: &TruePose| {
        let range_m = (pose.x_m - x_m).hypot(pose.y_m - y_m);
        Sighting { t_s: pose.t_s, landmark: 0, size: Size::RangeM(range_m), bearing_rad: 0.0 }
    };
    let known = Known { landmarks: vec![Beacon { id: 0, x_m, y_m, height_m: None }], ..Known::default() };
    let log = Log {
        known: known.into(),
        sightings: track.iter().step_by(7).map(see).collect::<Vec<_>>().into(),
        commands: commands.into(),
        ..Log::default()
    };
    (log, track)
}

#[test]
fn a_track_gives_the_speeds_and_distances_that_were_under_any_heading() {
    for theta_rad in [0.0, -std::f64::consts::FRAC_PI_2, 2.5, -std::f64::consts::PI] {
        let (log, track) = walk(theta_rad);
        let yardstick = Yardstick::tracked(&log, &track);
        assert_eq!(yardstick.action.len(), 6);
        assert_eq!(yardstick.sensor.len(), log.sightings.len());
        for stretch in &yardstick.action {
            let share: f64 = stretch.commands.iter().map(|[_, share]| share).sum();
            assert!((share - 1.0).abs() < 1e-12);
        }
        // S(o) = -o: the place grows forward.
        let scores = yardstick.score(&models(&[0.0, -1.0], &[0.0, 1.0]));
        assert!(scores.sensor_rmse_m.unwrap() < 1e-9);
        assert!((scores.sensor_scale.unwrap() + 1.0).abs() < 1e-9);
        assert!(scores.action_rmse_m_per_s.unwrap() < 1e-9, "{scores:?}");
        assert!((scores.action_scale.unwrap() - 0.8).abs() < 1e-9);
        assert!(!scores.are_opposed());
    }
}

#[test]
fn a_window_is_scored_by_its_own_part_of_the_track() {
    let (log, track) = walk(0.0);
    let yardstick = Yardstick::tracked(&log.window(10.0..20.0), &track);
    let all = Yardstick::tracked(&log, &track);
    assert_eq!(yardstick.sensor.len(), log.sightings.iter().filter(|s| (10.0..20.0).contains(&s.t_s)).count());
    // The window ends with its last sighting, a little before its second stretch does.
    assert_eq!(yardstick.action.len(), 2);
    assert_eq!(yardstick.action[0], all.action[2]);
    assert!((yardstick.action[1].speed_m_per_s - all.action[3].speed_m_per_s).abs() < 0.01);
}

#[test]
fn gaps_in_the_track_are_not_bridged() {
    let (log, mut track) = walk(0.0);
    track.retain(|pose| !(12.0..13.0).contains(&pose.t_s));
    let yardstick = Yardstick::tracked(&log, &track);
    assert_eq!(yardstick.action.len(), 5, "one of six stretches has the gap");
    assert!(yardstick.sensor.len() < log.sightings.len());
}

#[test]
fn what_was_surveyed_comes_from_the_survey_and_the_rest_from_the_track() {
    let (log, track) = walk(0.0);
    let survey = Survey { height_by_distance: Vec::new(), ..survey() };
    let truth = Truth { track: track.clone().into(), survey: Some(survey.clone()) };
    let yardstick = Yardstick::of(&log, &truth);
    assert_eq!(yardstick.action, Yardstick::surveyed(&survey).action);
    assert_eq!(yardstick.sensor, Yardstick::tracked(&log, &track).sensor);
}
