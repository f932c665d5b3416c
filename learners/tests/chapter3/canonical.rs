//! The closed form.

use crate::synthetic::{Pacer, curve_of_action, curve_of_sensor, floors, learn, scaled, score, starting};
use asami_dataset::Models;

#[test]
fn without_noise_only_the_degrees_stand_between_it_and_the_truth() {
    let pacer = Pacer { sigma_px: 0.0, walk_m: 0.0, saturates_m_per_s: f64::INFINITY, ..Pacer::default() };
    let models = learn("canonical", &[("sensor_degree", 7.0)], &pacer.log(2), &Models::default()).unwrap().models;
    let found = score(&pacer, &models);
    // The robot does not see the outermost distances, where degree 7 misses most.
    assert!(found.sensor_mm < 0.0025 * 2400.0 && found.action_mm_per_s < 0.01, "{found:?}");
    assert!((found.k - 1.0).abs() < 1e-4 && (found.b + 1.0).abs() < 4e-3, "{found:?}");
}

#[test]
fn needs_no_start_and_errs_less_than_algorithm_1() {
    let pacer = Pacer::default();
    let mut sums = [[0.0; 2]; 2];
    for seed in 0..15 {
        let log = pacer.log(seed);
        let ours = score(&pacer, &learn("canonical", &[], &log, &Models::default()).unwrap().models);
        let theirs = score(&pacer, &learn("algorithm1", &[], &log, &starting("c")).unwrap().models);
        for (sum, score) in sums.iter_mut().zip([ours, theirs]) {
            *sum = [sum[0] + score.sensor_mm, sum[1] + score.action_mm_per_s];
        }
        assert!((ours.k / ours.b + 1.0).abs() < 0.15, "{ours:?}");
    }
    assert!(sums[0][0] < sums[1][0] && sums[0][1] < sums[1][1], "{sums:?}");
}

#[test]
fn errors_fall_with_the_length_of_the_log() {
    let error = |duration_s: f64| {
        let pacer = Pacer { duration_s, ..Pacer::default() };
        let (_, floor) = floors(&pacer, 3, 4);
        let sum: f64 = (0..20)
            .map(|seed| score(&pacer, &learn("canonical", &[], &pacer.log(seed), &Models::default()).unwrap().models))
            .map(|score| score.action_mm_per_s.powi(2) - floor * floor)
            .sum();
        (sum / 20.0).sqrt()
    };
    // Sixteen times the data: a quarter of the error above the floor.
    let ratio = error(150.0) / error(2400.0);
    assert!((2.5..6.5).contains(&ratio), "{ratio}");
}

#[test]
fn units_and_the_clock_do_not_matter() {
    let log = Pacer::default().log(3);
    let models = |log| learn("canonical", &[], log, &Models::default()).unwrap().models;
    let (plain, other) = (models(&log), models(&scaled(&log, 2.0, -0.5, 1024.0)));
    for i in -10..=10 {
        let c = 0.03 * f64::from(i);
        let (a, b) = (curve_of_action(&plain).polynomial.at(c), curve_of_action(&other).polynomial.at(2.0 * c));
        assert!((2.0 * a - b).abs() < 1e-7, "A({c}) = {a}, in other units {b}");
        let o = 23.0 + f64::from(i);
        let (a, b) = (curve_of_sensor(&plain).polynomial.at(o), curve_of_sensor(&other).polynomial.at(-0.5 * o));
        assert!((2.0 * a - b).abs() < 1e-7, "S({o}) = {a}, in other units {b}");
    }
}

#[test]
fn a_mirrored_robot_learns_mirrored_models() {
    let log = Pacer::default().log(4);
    let models = |log| learn("canonical", &[], log, &Models::default()).unwrap().models;
    let (plain, mirrored) = (models(&log), models(&scaled(&log, -1.0, 1.0, 0.0)));
    for i in -10..=10 {
        let (c, o) = (0.03 * f64::from(i), 23.0 + f64::from(i));
        let (a, b) = (curve_of_action(&plain), curve_of_action(&mirrored));
        assert!((a.polynomial.at(c) + b.polynomial.at(-c)).abs() < 1e-7);
        let (a, b) = (curve_of_sensor(&plain), curve_of_sensor(&mirrored));
        assert!((a.polynomial.at(o) + b.polynomial.at(o)).abs() < 1e-7);
    }
}
