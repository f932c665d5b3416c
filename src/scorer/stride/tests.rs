use asami_dataset::models::Entry;
use asami_dataset::survey::{Height, Speed};

use super::*;

fn speed_m_per_s(command: f64) -> f64 {
    0.9 * command - 0.5 * command.powi(3)
}

fn strides() -> Vec<(u16, f64)> {
    (0..21).map(|id| (id, 0.04 * (f64::from(id) - 10.0))).collect()
}

fn survey() -> Survey {
    let speed = |(_, command_m_per_s): &(u16, f64)| {
        let speed_m_per_s = speed_m_per_s(*command_m_per_s);
        Speed { command_m_per_s: *command_m_per_s, speed_m_per_s, sd_m_per_s: 0.0, timings: 5 }
    };
    let height = |i: i32| {
        let distance_m = 1.2 + 0.2 * f64::from(i);
        Height { distance_m, height_px: 38.0 / distance_m, sd_px: 1.0, bearing_sd_rad: 0.02, readings: 100 }
    };
    Survey {
        speed_by_command: strides().iter().map(speed).collect(),
        height_by_distance: (0..13).map(height).collect(),
        ..Survey::default()
    }
}

/// What a learner learns whose unit of length is `unit_m`, whose landmark is `shift` units off, and whose
/// robot is `weaker` than the one surveyed.
fn models(yardstick: &Yardstick, unit_m: f64, shift: f64, weaker: f64) -> Models {
    let entry = |(id, command): (u16, f64)| {
        let vy_m_per_s = weaker * speed_m_per_s(command) / unit_m;
        Entry { action: id, vx_m_per_s: 0.0, vy_m_per_s, vtheta_rad_per_s: 0.0, se: None }
    };
    let Some(SensorModel::HeightOfDistance(best)) = yardstick.best_sensor(3) else { panic!("a cubic") };
    let mut f = best.polynomial;
    f.centre = f.centre / unit_m + shift;
    f.scale /= unit_m;
    Models {
        action: Some(ActionModel::Table(strides().into_iter().map(entry).collect())),
        sensor: Some(SensorModel::HeightOfDistance(f.into())),
        ..Models::default()
    }
}

#[test]
fn units_and_shifts_of_the_learner_do_not_count() {
    let yardstick = Yardstick::surveyed(&survey(), &strides());
    let metres = yardstick.score(&models(&yardstick, 1.0, 0.0, 1.0));
    for (unit_m, shift) in [(0.5, 0.0), (2.0, -1.0), (0.001, 300.0), (1.0, 5.0)] {
        let scores = yardstick.score(&models(&yardstick, unit_m, shift, 1.0));
        assert!(scores.action_rmse_m_per_s.unwrap() < 1e-12);
        let [one, other] = [metres, scores].map(|scores| scores.sensor_rmse_px.unwrap());
        assert!((one - other).abs() < 1e-6, "unit {unit_m} m, shift {shift}: {other} for {one} px");
        assert!((scores.scale_ratio().unwrap() - 1.0).abs() < 1e-3, "{:?}", scores.scale_ratio());
        assert!((scores.action_scale.unwrap() / unit_m - 1.0).abs() < 1e-9);
    }
}

/// The dissertation's cross-evaluation: 4/3 where the truth is of the stronger robot.
#[test]
fn the_scales_part_where_the_robot_is_another() {
    let yardstick = Yardstick::surveyed(&survey(), &strides());
    let ratio = |weaker: f64| yardstick.score(&models(&yardstick, 0.7, 0.2, weaker)).scale_ratio().unwrap();
    assert!((ratio(0.75) - 4.0 / 3.0).abs() < 1e-3);
    assert!((ratio(4.0 / 3.0) - 0.75).abs() < 1e-3);
}

#[test]
fn what_does_not_vary_diverges() {
    let yardstick = Yardstick::surveyed(&survey(), &strides());
    let flat = Models {
        sensor: Some(SensorModel::HeightOfDistance(Polynomial::plain(vec![20.0]).into())),
        action: Some(ActionModel::Table(Vec::new())),
        ..Models::default()
    };
    let scores = yardstick.score(&flat);
    assert_eq!(yardstick.faults(&flat, &scores, 0.75).len(), 2, "{scores:?}");
    assert!((yardstick.height_range_px().unwrap() - (38.0 / 1.2 - 38.0 / 3.6)).abs() < 1e-12);
}
