//! Each model learned while the other is known.

use asami_dataset::{Action, ActionModel, Command, Log, Models, SensorModel};
use asami_math::polynomial::Polynomial;

use crate::synthetic::{Pacer, action_error, curve_of_action, curve_of_sensor, floors, learn, sensor_error};

/// The best action model of degree 4, given as known, as in section 3.3.3.
fn best_action(pacer: &Pacer) -> Models {
    let points = (-15..=15).map(|i| 0.02 * f64::from(i)).map(|c| (c, pacer.speed(c)));
    let (action, _) = Polynomial::fit(points, 4, 0.0, 0.3).unwrap();
    Models { action: Some(ActionModel::Polynomial(action.into())), ..Models::default() }
}

/// The true sensor model, near enough.
fn best_sensor() -> Models {
    let points = (0..100).map(|i| 1.1 + 0.026 * f64::from(i)).map(|d| (Pacer::height(d), -d));
    let (sensor, _) = Polynomial::fit(points, 10, 25.0, 16.0).unwrap();
    Models { sensor: Some(SensorModel::DistanceOfHeight(sensor.into())), ..Models::default() }
}

/// One command after another, `(seconds, command)`.
fn commanded(pacer: &Pacer, parts: &[(f64, f64)]) -> Log {
    let log = Pacer { duration_s: parts.iter().map(|part| part.0).sum(), ..pacer.clone() }.log(0);
    let (mut t_s, mut d, mut commands) = (0.0, 3.4, Vec::new());
    for (seconds, v_m_per_s) in parts {
        commands
            .push(Command { t_s, action: Action::Wheels { id: None, v_m_per_s: *v_m_per_s, omega_rad_per_s: 0.0 } });
        t_s += seconds;
    }
    let mut sightings = log.sightings.to_vec();
    let mut before_s = 0.0;
    for sighting in &mut sightings {
        let command = commands.iter().rev().find(|command| command.t_s <= before_s).unwrap();
        d -= pacer.speed(command.action.forward_m_per_s().unwrap()) * (sighting.t_s - before_s);
        before_s = sighting.t_s;
        sighting.size = asami_dataset::Size::HeightPx(Pacer::height(d));
    }
    Log { commands: commands.into(), sightings: sightings.into(), ..Log::default() }
}

#[test]
fn a_constant_action_gives_the_sensor_whatever_its_speed() {
    let pacer = Pacer::default();
    let log = commanded(&pacer, &[(1.0, -0.1), (11.5, 0.25), (1.0, -0.2)]);
    let learned = learn("sensor_constant_action", &[("sensor_degree", 7.0)], &log, &Models::default()).unwrap();
    let sensor = &curve_of_sensor(&learned.models).polynomial;
    let (near, far) = (Pacer::height(1.6), Pacer::height(3.2));
    // 1.6 m, in units of what was commanded instead of what was done.
    let expected = 1.6 * 0.25 / pacer.speed(0.25);
    assert!((sensor.at(near) - sensor.at(far) - expected).abs() < 1e-3 * expected);
    let (half, whole) = (sensor.at(Pacer::height(2.4)) - sensor.at(far), sensor.at(near) - sensor.at(far));
    assert!((half / whole - 0.5).abs() < 1e-3);
    // 11.5 s at 20 Hz, less the frame at which it began, and with the one at which it ended.
    assert_eq!(learned.traces[0].points.len(), 230);
}

#[test]
fn a_known_action_model_gives_the_sensor() {
    let pacer = Pacer { sigma_px: 0.0, walk_m: 0.0, saturates_m_per_s: f64::INFINITY, ..Pacer::default() };
    let learned = learn("sensor_from_action", &[("sensor_degree", 7.0)], &pacer.log(1), &best_action(&pacer)).unwrap();
    let (b, sensor_mm) = sensor_error(&learned.models);
    // Within 0.25 % of the range, of which the robot does not see the ends.
    assert!(sensor_mm < 6.0 && (b + 1.0).abs() < 4e-3, "{sensor_mm} mm, {b}");
}

#[test]
fn a_known_sensor_model_gives_the_action() {
    let pacer = Pacer { sigma_px: 0.0, walk_m: 0.0, ..Pacer::default() };
    let learned = learn("action_from_sensor", &[("action_degree", 7.0)], &pacer.log(1), &best_sensor()).unwrap();
    let (k, action_mm_per_s) = action_error(&pacer, &learned.models);
    let (_, floor) = floors(&pacer, 3, 7);
    assert!(action_mm_per_s < 3.0 * floor + 0.1 && (k - 1.0).abs() < 0.01, "{action_mm_per_s} mm/s, {floor}, {k}");
    let last = |i: usize| learned.traces[i].points.last().unwrap()[1];
    assert!((last(0) - last(1)).abs() < 0.02);
    assert_eq!(curve_of_action(&learned.models).polynomial.degree(), 7);
}

#[test]
fn both_need_what_they_need() {
    let log = Pacer { duration_s: 20.0, ..Pacer::default() }.log(0);
    for name in ["sensor_from_action", "degree_selection", "algorithm1"] {
        assert!(learn(name, &[], &log, &best_sensor()).is_err());
    }
    assert!(learn("action_from_sensor", &[], &log, &best_action(&Pacer::default())).is_err());
}

#[test]
fn the_degree_grows_as_far_as_the_noise_allows() {
    let degrees = |pacer: &Pacer, seeds: u64| -> Vec<f64> {
        let run = |seed| learn("degree_selection", &[], &pacer.log(seed), &best_action(pacer)).unwrap();
        (0..seeds).map(|seed| curve_of_sensor(&run(seed).models).polynomial.degree() as f64).collect()
    };
    let mean = |degrees: &[f64]| degrees.iter().sum::<f64>() / degrees.len() as f64;
    let careful = degrees(&Pacer { duration_s: 300.0, sigma_px: 0.1, walk_m: 0.001, ..Pacer::default() }, 8);
    let clumsy = degrees(&Pacer { duration_s: 300.0, sigma_px: 1.0, walk_m: 0.05, ..Pacer::default() }, 8);
    assert!(careful.iter().all(|degree| *degree >= 3.0), "{careful:?}");
    assert!(mean(&clumsy) < mean(&careful), "{clumsy:?} {careful:?}");
}

#[test]
fn the_degree_settles_within_half_of_five_minutes() {
    let pacer = Pacer { duration_s: 300.0, ..Pacer::default() };
    let (mut sum_mm, floor_mm) = (0.0, floors(&pacer, 2, 4).0);
    for seed in 0..8 {
        let learned = learn("degree_selection", &[], &pacer.log(seed), &best_action(&pacer)).unwrap();
        let degrees: Vec<f64> = learned.traces[0].points.iter().map(|point| point[1]).collect();
        let half = degrees[degrees.len() / 2];
        assert!(degrees.is_sorted() && degrees[0] == 1.0 && *degrees.last().unwrap() <= half + 1.0, "{half}");
        sum_mm += sensor_error(&learned.models).1;
    }
    // Better on average than any parabola.
    assert!(sum_mm / 8.0 < floor_mm, "{} mm, floor of degree 2 {floor_mm} mm", sum_mm / 8.0);
}
