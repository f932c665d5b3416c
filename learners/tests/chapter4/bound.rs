//! The Cramer-Rao bound against the errors of an estimator that is efficient where noise is small.

use asami_dataset::{ActionModel, Log, Models};
use asami_learners::batch::{PlaneBound, plane_bound};

use crate::synthetic::{Walker, learn, truth};

fn bound(walker: &Walker, log: &Log, poses: &[[f64; 3]]) -> PlaneBound {
    let pose_at = |t_s: f64| poses.get((t_s / walker.dt_s).round() as usize).copied();
    plane_bound(log, pose_at, &truth(walker)).unwrap()
}

fn errors(models: &Models) -> Vec<[f64; 3]> {
    let Some(ActionModel::Table(entries)) = &models.action else { panic!("no table") };
    let of = |e: &asami_dataset::models::Entry| {
        let v = Walker::velocity(e.action);
        [e.vx_m_per_s - v[0], e.vy_m_per_s - v[1], e.vtheta_rad_per_s - v[2]]
    };
    entries.iter().map(of).collect()
}

#[test]
fn is_reached_where_noise_is_small() {
    let walker =
        Walker { cubic: true, sigma1_px: 0.2, sigma2_rad: 0.05, steps: 4_000, actions: 8, ..Walker::default() };
    let (mut squares, mut n, mut noise) = ([0.0; 3], 0.0, [0.0; 2]);
    let seeds = 1000..1020;
    let trials = seeds.clone().count() as f64;
    for seed in seeds {
        let (log, poses) = walker.walk(seed);
        let bound = bound(&walker, &log, &poses);
        let models = learn("batch", &[], &log, &truth(&walker)).unwrap().models;
        for (error, (_, least)) in errors(&models).iter().zip(&bound.velocities) {
            for i in 0..3 {
                squares[i] += (error[i] / least[i]).powi(2);
            }
            n += 1.0;
        }
        noise[0] += ((models.noise.sigma1_px.unwrap() / 0.2 - 1.0) / bound.noise_shares[0]).powi(2) / trials;
        noise[1] += ((models.noise.sigma2_rad.unwrap() / 0.05 - 1.0) / bound.noise_shares[1]).powi(2) / trials;
    }
    // Mean squares of n normalised errors have a standard deviation of sqrt(2 / n) if independent; four of these.
    for square in squares {
        assert!((square / n - 1.0).abs() < 4.0 * (2.0f64 / n).sqrt(), "{squares:?} of {n}");
    }
    for square in noise {
        assert!((square - 1.0).abs() < 4.0 * (2.0 / trials).sqrt(), "{noise:?}");
    }
}

#[test]
fn falls_with_the_noise_and_with_time() {
    let walker = Walker { cubic: true, ..Walker::default() };
    let of = |walker: &Walker| {
        let (log, poses) = walker.walk(1000);
        let bound = bound(walker, &log, &poses);
        (bound.velocity_rms(), bound.sensor_at(2.7))
    };
    let (long, long_f) = of(&walker);
    let (short, short_f) = of(&Walker { steps: 9_000, ..walker.clone() });
    let (clear, clear_f) = of(&Walker { sigma1_px: 0.5, sigma2_rad: 0.25, ..walker.clone() });
    assert!(long_f < short_f && clear_f < long_f);
    for i in 0..3 {
        // Half the time: twice the variance, but for which actions came up.
        assert!((1.2..1.8).contains(&(short[i] / long[i])), "{short:?} {long:?}");
        assert!(clear[i] < long[i], "{clear:?} {long:?}");
    }
}
