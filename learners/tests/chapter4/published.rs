//! EM as published, on the dissertation's simulation in small.

use asami_learners::Verdict;

use crate::synthetic::{Walker, learn, published, score, truth};

#[test]
fn learns_from_no_motion_and_a_poor_line() {
    // A quarter of the published run, a fifth of its noise of bearings.
    let walker = Walker { steps: 4_500, sigma2_rad: 0.1, ..Walker::default() };
    let log = walker.log(1000);
    let learned = learn("em_published", &[("max_iterations", 1500.0)], &log, &published()).unwrap();
    assert_eq!(learned.verdict, Verdict::Converged);
    let (start, end) = (score(&walker, &learned.history[0].models), score(&walker, &learned.models));
    assert!(start.velocity.iter().zip(end.velocity).all(|(start, end)| end < 0.3 * start), "{start:?} {end:?}");
    assert!(end.sensor_px < 0.5 * start.sensor_px, "{end:?}");
    // The likelihood grows, but flickers.
    let curve: Vec<f64> = learned.history.iter().filter_map(|step| step.log_likelihood).collect();
    let best = curve.iter().skip(1).copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(best > curve[1] + 1000.0 && curve.windows(2).any(|two| two[1] < two[0]));
}

#[test]
fn stays_near_the_truth() {
    let walker = Walker { cubic: true, ..Walker::default() };
    let log = walker.log(1001);
    for name in ["em_published", "em_rts"] {
        let learned = learn(name, &[("max_iterations", 6.0)], &log, &truth(&walker)).unwrap();
        let end = score(&walker, &learned.models);
        assert!(end.velocity[0] < 12.0 && end.velocity[1] < 12.0 && end.velocity[2] < 0.03, "{name}: {end:?}");
        assert!(end.sensor_px < 0.3 && (end.sigma1_px - 1.0).abs() < 0.03, "{name}: {end:?}");
        assert!((end.sigma2_rad - 0.5).abs() < 0.02 && end.covered > 0.9, "{name}: {end:?}");
    }
}
