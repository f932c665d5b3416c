//! Algorithm 1 against its published behaviour.

use asami_dataset::{Log, Models};

use crate::synthetic::{Pacer, action_error, curve_of_action, curve_of_sensor, floors, learn, scaled, score, starting};

fn mean_errors(pacer: &Pacer, start: &str, with: &[(&str, f64)], seeds: u64) -> (f64, f64) {
    let scores = (0..seeds).map(|seed| {
        let learned = learn("algorithm1", with, &pacer.log(seed), &starting(start)).unwrap();
        score(pacer, &learned.models)
    });
    let sums = scores.fold((0.0, 0.0), |sum, score| (sum.0 + score.sensor_mm, sum.1 + score.action_mm_per_s));
    (sums.0 / seeds as f64, sums.1 / seeds as f64)
}

#[test]
fn learns_from_c_and_from_the_sign_alone() {
    let pacer = Pacer::default();
    for start in ["c", "sgn"] {
        let (sensor_mm, action_mm_per_s) = mean_errors(&pacer, start, &[], 15);
        // The published ratio to the floor is 1.44; this robot's walk is rougher.
        let (sensor_floor_mm, _) = floors(&pacer, 3, 4);
        assert!(sensor_mm < 3.0 * sensor_floor_mm, "{start}: {sensor_mm} mm, floor {sensor_floor_mm} mm");
        let (_, unlearned_mm_per_s) = action_error(&pacer, &starting("c"));
        assert!(
            action_mm_per_s < unlearned_mm_per_s,
            "{start}: {action_mm_per_s} mm/s, unlearned {unlearned_mm_per_s}"
        );
    }
}

#[test]
fn models_share_one_scale() {
    let pacer = Pacer::default();
    for seed in 0..5 {
        let found = score(&pacer, &learn("algorithm1", &[], &pacer.log(seed), &starting("c")).unwrap().models);
        // Places grow forward, distances backward.
        assert!(found.k > 0.0 && found.b < 0.0);
        assert!((found.k / found.b + 1.0).abs() < 0.25, "{found:?}");
    }
}

#[test]
fn without_the_pull_it_drifts() {
    let pacer = Pacer { duration_s: 300.0, ..Pacer::default() };
    let parts = |alpha: f64| {
        let run = |seed| learn("algorithm1", &[("alpha", alpha)], &pacer.log(seed), &starting("c")).unwrap();
        (0..5)
            .map(run)
            .map(|learned| {
                let end = |i: usize| learned.traces[i].points.last().unwrap()[1];
                (end(0) - end(1)).abs()
            })
            .sum::<f64>()
            / 5.0
    };
    let (with, without) = (parts(1.0 / 30.0), parts(0.0));
    assert!(without > 1.5 * with, "w_a and w_s end {with} m apart with the pull, {without} m without");
}

#[test]
fn units_and_the_clock_do_not_matter() {
    let log = Pacer::default().log(3);
    let models = |log: &Log| -> Models { learn("algorithm1", &[], log, &starting("c")).unwrap().models };
    let (plain, other) = (models(&log), models(&scaled(&log, 2.0, -0.5, 1024.0)));
    for i in -10..=10 {
        let c = 0.03 * f64::from(i);
        let (a, b) = (curve_of_action(&plain).polynomial.at(c), curve_of_action(&other).polynomial.at(2.0 * c));
        assert!((2.0 * a - b).abs() < 1e-6, "A({c}) = {a}, in other units {b}");
        let o = 23.0 + f64::from(i);
        let (a, b) = (curve_of_sensor(&plain).polynomial.at(o), curve_of_sensor(&other).polynomial.at(-0.5 * o));
        assert!((2.0 * a - b).abs() < 1e-6, "S({o}) = {a}, in other units {b}");
    }
}
