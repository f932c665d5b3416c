//! What each replaceable answer is there for.

use asami_learners::{Learned, Verdict};

use crate::synthetic::{Walker, learn, published, score, truth};

fn small() -> Walker {
    Walker { steps: 6_000, sigma2_rad: 0.1, cubic: true, ..Walker::default() }
}

fn best(learned: &Learned) -> f64 {
    learned.history.iter().skip(1).filter_map(|step| step.log_likelihood).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn exact_moments_do_not_flicker() {
    let log = small().log(1006);
    let falls = |name: &str| {
        let learned = learn(name, &[("max_iterations", 80.0), ("tolerance", 0.0)], &log, &truth(&small()));
        let learned = learned.or_else(|_| learn(name, &[("max_iterations", 80.0)], &log, &truth(&small()))).unwrap();
        let curve: Vec<f64> = learned.history.iter().filter_map(|step| step.log_likelihood).collect();
        curve[30..].windows(2).filter(|two| two[1] < two[0] - 0.02).count()
    };
    assert_eq!(falls("em_exact"), 0);
}

#[test]
fn extrapolation_finds_the_same_maximum_sooner() {
    let log = small().log(1006);
    let plain = learn("em_exact", &[], &log, &published()).unwrap();
    let fast = learn("em_squarem", &[], &log, &published()).unwrap();
    assert!(best(&fast) > best(&plain) - 2.0, "{} {}", best(&fast), best(&plain));
    assert!(2 * fast.iterations.unwrap() < plain.iterations.unwrap(), "{:?} {:?}", fast.iterations, plain.iterations);
    let (a, b) = (score(&small(), &plain.models), score(&small(), &fast.models));
    assert!((a.velocity[0] - b.velocity[0]).abs() < 4.0 && (a.velocity[1] - b.velocity[1]).abs() < 4.0, "{a:?} {b:?}");
}

#[test]
fn the_noise_of_the_motion_is_found() {
    let walker = Walker { motion_sd: [0.004, 0.008, 0.03], cubic: true, sigma2_rad: 0.05, ..Walker::default() };
    let learned = learn("em_best", &[("pooled_steps", 1e6)], &walker.log(1007), &published()).unwrap();
    let sd = learned.models.noise.motion_sd.unwrap();
    // It started as 10 mm, 10 mm and 0.1 rad. To the side little is seen of it.
    assert!((sd[2] / 0.03 - 1.0).abs() < 0.1 && (sd[1] / 0.008 - 1.0).abs() < 0.2, "{sd:?}");
    assert!(sd[0] < 0.9 * sd[1], "{sd:?}");
}

#[test]
fn bearings_of_one_head_are_not_taken_for_several() {
    // A heading that jitters as much as the head does is told from two bearings of a frame or not at all.
    let wide = Walker { view_rad: 0.7, motion_sd: [0.005, 0.005, 0.08], ..Walker::default() };
    let walker = Walker { common_share: 0.9, sigma2_rad: 0.05, cubic: true, ..wide };
    let log = walker.log(1006);
    let sigma2 = |name: &str| score(&walker, &learn(name, &[], &log, &truth(&walker)).unwrap().models).sigma2_rad;
    let (head, apart) = (sigma2("em_head"), sigma2("em_noise"));
    assert!((head / 0.05 - 1.0).abs() < 0.06, "{head}");
    assert!(apart < 0.8 * 0.05, "{apart}");
    // Where each bearing is wrong by itself, nothing is found in common.
    let walker = Walker { common_share: 0.0, ..walker };
    let learned = learn("em_head", &[], &walker.log(1006), &truth(&walker)).unwrap();
    assert!((score(&walker, &learned.models).sigma2_rad / 0.05 - 1.0).abs() < 0.06);
}

#[test]
fn false_sightings_do_little_harm() {
    let walker = Walker { false_share: 0.03, ..small() };
    let log = walker.log(1008);
    let robust = score(&walker, &learn("em_best", &[], &log, &truth(&walker)).unwrap().models);
    let exact = score(&walker, &learn("em_noise", &[], &log, &truth(&walker)).unwrap().models);
    assert!((robust.sigma1_px - 1.0).abs() < 0.1 && (robust.sigma2_rad - 0.1).abs() < 0.01, "{robust:?}");
    assert!(exact.sigma1_px > 1.3 && exact.sigma2_rad > 0.15, "{exact:?}");
    assert!(robust.velocity[0] < 0.8 * exact.velocity[0] && robust.velocity[1] < 0.8 * exact.velocity[1]);
}

#[test]
fn actions_that_share_err_less() {
    let walker = Walker { steps: 6_000, sigma2_rad: 0.3, cubic: true, ..Walker::default() };
    let (mut alone, mut shared) = (0.0, 0.0);
    for seed in 1009..1011 {
        let log = walker.log(seed);
        let square = |name: &str| -> f64 {
            let learned = learn(name, &[], &log, &published()).unwrap();
            score(&walker, &learned.models).velocity.iter().take(2).map(|e| e * e).sum()
        };
        alone += square("em_best");
        shared += square("em_shared");
    }
    assert!(shared < 0.8 * alone, "{shared} {alone}");
}

#[test]
fn standard_errors_cover_the_truth() {
    let walker = Walker { cubic: true, ..Walker::default() };
    let mut covered = Vec::new();
    for seed in 1012..1016 {
        let learned = learn("em_best", &[], &walker.log(seed), &truth(&walker)).unwrap();
        assert_eq!(learned.verdict, Verdict::Converged);
        covered.push(score(&walker, &learned.models).covered);
    }
    // 480 entries, those of one log tied to each other by f.
    let mean = covered.iter().sum::<f64>() / covered.len() as f64;
    assert!((0.9..0.98).contains(&mean), "{covered:?}");
}

/// Normalised by their standard errors, the noise's errors over several logs have mean squares of about 1: that of 20
/// numbers has a standard deviation of 0.32 if they are independent.
#[test]
fn standard_errors_of_the_noise_fit_its_errors() {
    let walker = Walker { steps: 4_000, sigma2_rad: 0.1, cubic: true, ..Walker::default() };
    for name in ["em_noise", "batch"] {
        let mut squares = 0.0;
        for seed in 1010..1020 {
            let noise = learn(name, &[], &walker.log(seed), &truth(&walker)).unwrap().models.noise;
            let off =
                |value: Option<f64>, truth: f64, se: Option<f64>| ((value.unwrap() - truth) / se.unwrap()).powi(2);
            squares += off(noise.sigma1_px, 1.0, noise.se.sigma1) + off(noise.sigma2_rad, 0.1, noise.se.sigma2_rad);
            assert!(noise.se.motion_sd.unwrap().iter().all(|se| *se > 0.0));
        }
        assert!((0.3..2.3).contains(&(squares / 20.0)), "{name}: {}", squares / 20.0);
    }
    let given = learn("em_exact", &[], &walker.log(1010), &truth(&walker)).unwrap().models.noise;
    assert!(given.se.sigma1.is_some() && given.se.motion_sd.is_none(), "{given:?}");
}
