//! The joint estimate of poses, models and noise.

use asami_dataset::{ActionModel, Models};
use asami_learners::Verdict;

use crate::synthetic::{Walker, learn, published, score, truth};

fn walker() -> Walker {
    Walker { cubic: true, ..Walker::default() }
}

/// Velocities and their standard errors.
fn velocities(models: &Models) -> Vec<([f64; 3], [f64; 3])> {
    let Some(ActionModel::Table(entries)) = &models.action else { panic!("no table") };
    let of = |e: &asami_dataset::models::Entry| ([e.vx_m_per_s, e.vy_m_per_s, e.vtheta_rad_per_s], e.se.unwrap());
    entries.iter().map(of).collect()
}

#[test]
fn covers_the_truth_from_a_poor_start() {
    let walker = walker();
    let (mut within, mut of) = (0.0, 0.0);
    for seed in [1001, 1004, 1009] {
        let log = walker.log(seed);
        let learned = learn("batch", &[], &log, &published()).unwrap();
        assert_eq!(learned.verdict, Verdict::Converged, "{seed}");
        assert!(learned.iterations.unwrap() < 100, "{seed}: {:?}", learned.iterations);
        let score = score(&walker, &learned.models);
        // sigma / sqrt(2 n) each, four of these.
        let four = 4.0 / (2.0 * log.sightings.len() as f64).sqrt();
        assert!((score.sigma1_px - 1.0).abs() < four, "{seed}: {score:?}");
        assert!((score.sigma2_rad / 0.5 - 1.0).abs() < four, "{seed}: {score:?}");
        within += score.covered * 120.0;
        of += 120.0;
    }
    // 360 entries at 95 %: a standard deviation of 1.1 %, three of them.
    let covered: f64 = within / of;
    assert!((0.915..0.985).contains(&covered), "{covered}");
}

#[test]
fn does_not_depend_on_the_start() {
    let walker = walker();
    let log = walker.log(1002);
    let from = |start: &Models| velocities(&learn("batch", &[], &log, start).unwrap().models);
    for ((a, se), (b, _)) in from(&published()).into_iter().zip(from(&truth(&walker))) {
        for i in 0..3 {
            assert!((a[i] - b[i]).abs() < 0.3 * se[i], "{a:?} {b:?} {se:?}");
        }
    }
}

#[test]
fn false_sightings_do_little_harm() {
    let walker = Walker { false_share: 0.03, ..walker() };
    let log = walker.log(1006);
    let learned = learn("batch", &[("false_share", 0.05)], &log, &published()).unwrap();
    let clean = Walker { false_share: 0.0, ..walker.clone() };
    let without = learn("batch", &[], &clean.log(1006), &published()).unwrap();
    let (a, b) = (score(&walker, &learned.models), score(&clean, &without.models));
    assert!((a.sigma1_px - 1.0).abs() < 0.05, "{a:?}");
    for i in 0..3 {
        assert!(a.velocity[i] < 1.5 * b.velocity[i], "{a:?} {b:?}");
    }
}
