//! Maximum likelihood.

use asami_dataset::{Log, Models};
use asami_math::statistics::paired_t;

use crate::synthetic::{Pacer, curve_of_action, curve_of_sensor, learn, scaled, score, starting};

fn models(log: &Log) -> Models {
    learn("likelihood", &[], log, &Models::default()).unwrap().models
}

#[test]
fn without_noise_it_finds_the_truth() {
    let pacer = Pacer { sigma_px: 0.0, walk_m: 0.0, saturates_m_per_s: f64::INFINITY, ..Pacer::default() };
    let found = score(&pacer, &models(&pacer.log(2)));
    assert!(found.sensor_mm < 1.0 && found.action_mm_per_s < 0.01, "{found:?}");
    assert!((found.k - 1.0).abs() < 1e-3 && (found.b + 1.0).abs() < 1e-3, "{found:?}");
}

#[test]
fn beats_algorithm_1_in_both_models() {
    let pacer = Pacer::default();
    let (mut sensor, mut action) = (Vec::new(), Vec::new());
    for seed in 0..15 {
        let log = pacer.log(seed);
        let ours = score(&pacer, &models(&log));
        let theirs = score(&pacer, &learn("algorithm1", &[], &log, &starting("c")).unwrap().models);
        sensor.push(ours.sensor_mm - theirs.sensor_mm);
        action.push(ours.action_mm_per_s - theirs.action_mm_per_s);
        assert!((ours.k / ours.b + 1.0).abs() < 0.08, "{ours:?}");
    }
    for differences in [sensor, action] {
        let (t, p) = paired_t(&differences).unwrap();
        assert!(t < 0.0 && p < 0.001, "t {t}, p {p}");
    }
}

#[test]
fn late_commands_and_outliers_do_little_harm() {
    let pacer = Pacer { delay_s: 0.2, outliers: 0.03, ..Pacer::default() };
    let plain = Pacer::default();
    let mut sums = [[0.0; 2]; 2];
    for seed in 0..8 {
        for (sum, pacer) in sums.iter_mut().zip([&pacer, &plain]) {
            let score = score(pacer, &models(&pacer.log(seed)));
            *sum = [sum[0] + score.sensor_mm, sum[1] + score.action_mm_per_s];
        }
    }
    assert!(sums[0][0] < 2.0 * sums[1][0] && sums[0][1] < 1.5 * sums[1][1], "{sums:?}");
}

#[test]
fn standard_errors_cover() {
    let pacer = Pacer { saturates_m_per_s: f64::INFINITY, ..Pacer::default() };
    let (mut squares, mut n) = (0.0, 0.0);
    let fixed = [("action_degree", 1.0), ("max_delay_s", 0.0)];
    for seed in 0..40 {
        let found = learn("likelihood", &fixed, &pacer.log(seed), &Models::default()).unwrap().models;
        // Of a straight line the slope is set to 1 by definition: the speed at command 0 is left.
        let curve = curve_of_action(&found);
        squares += (curve.polynomial.coefficients[0] / curve.se[0]).powi(2);
        n += 1.0;
        assert!(curve.se[1] < 1e-3 * curve.polynomial.coefficients[1]);
        assert_eq!(curve_of_sensor(&found).se.len(), curve_of_sensor(&found).polynomial.coefficients.len());
    }
    // A mean of n squares of standard normals has variance 2 / n: three standard deviations.
    let sd = f64::sqrt(2.0 / n);
    assert!((squares / n - 1.0).abs() < 3.0 * sd, "mean squared z {}", squares / n);
}

#[test]
fn sensor_standard_errors_cover() {
    let pacer = Pacer::default();
    let (near, far) = (Pacer::height(1.6), Pacer::height(3.0));
    let (mut squares, n) = (0.0, 30.0);
    for seed in 0..30 {
        let found = models(&pacer.log(seed));
        let curve = curve_of_sensor(&found);
        // The length of the track in the units of the action model is what is known least.
        let scale = score(&pacer, &found).k;
        let length = scale * (curve.polynomial.at(near) - curve.polynomial.at(far));
        let gradient: Vec<f64> = (0..curve.se.len())
            .map(|i| {
                f64::powi(curve.polynomial.scaled(near), i as i32) - f64::powi(curve.polynomial.scaled(far), i as i32)
            })
            .collect();
        // Coefficients are correlated: the sum of their parts bounds the standard error.
        let bound: f64 = gradient.iter().zip(&curve.se).map(|(g, se)| (g * se).abs()).sum();
        squares += ((length - 1.4) / (scale * bound)).powi(2);
    }
    assert!(squares / n < 1.5, "mean squared z {}", squares / n);
}

#[test]
fn units_the_clock_and_the_mirror_do_not_matter() {
    let log = Pacer { duration_s: 100.0, ..Pacer::default() }.log(3);
    let (plain, other, mirrored) =
        (models(&log), models(&scaled(&log, 2.0, -0.5, 1024.0)), models(&scaled(&log, -1.0, 1.0, 0.0)));
    for i in -10..=10 {
        let (c, o) = (0.03 * f64::from(i), 23.0 + f64::from(i));
        let a = |models: &Models, c: f64| curve_of_action(models).polynomial.at(c);
        assert!((2.0 * a(&plain, c) - a(&other, 2.0 * c)).abs() < 2e-4);
        assert!((a(&plain, c) + a(&mirrored, -c)).abs() < 1e-4);
        let s = |models: &Models, o: f64| curve_of_sensor(models).polynomial.at(o);
        assert!((2.0 * s(&plain, o) - s(&other, -0.5 * o)).abs() < 4e-3);
        assert!((s(&plain, o) + s(&mirrored, o)).abs() < 2e-3);
    }
}
