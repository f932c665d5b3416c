//! The filters that learn as they go.

use asami_dataset::ActionModel;

use crate::synthetic::{Walker, learn, score, truth};

fn walker() -> Walker {
    Walker { cubic: true, sigma1_px: 0.3, sigma2_rad: 0.05, ..Walker::default() }
}

/// Told the noise and started near the truth, where all is linear but for little, the filters' errors are as large
/// as they say; the dual filter's a little larger, for neither half knows how unsure the other is.
#[test]
fn know_how_sure_they_are_where_little_bends() {
    let walker = walker();
    let near = [("sensor_sd_share", 0.02), ("velocity_sd_m_per_s", 0.05), ("turn_sd_rad_per_s", 0.1)];
    for (name, least) in [("joint_ekf", 0.91), ("dual_ekf", 0.89)] {
        let (mut within, mut of): (f64, f64) = (0.0, 0.0);
        for seed in 1000..1004 {
            let learned = learn(name, &near, &walker.log(seed), &truth(&walker)).unwrap();
            within += 120.0 * score(&walker, &learned.models).covered;
            of += 120.0;
        }
        // 480 entries at 95 %: a standard deviation of 1 %; four of these.
        let covered = within / of;
        assert!((least..0.99).contains(&covered), "{name}: {covered}");
    }
}

#[test]
fn the_joint_filter_learns_velocities_that_it_is_not_given() {
    let walker = walker();
    let mut start = truth(&walker);
    start.action = Some(ActionModel::Table(Vec::new()));
    let learned = learn("joint_ekf", &[], &walker.log(1003), &start).unwrap();
    let score = score(&walker, &learned.models);
    for (i, unit) in [1e3, 1e3, 1.0].into_iter().enumerate() {
        // Velocities of zero err by the velocities' own size.
        let size: f64 = (0..40).map(|id| Walker::velocity(id)[i].powi(2)).sum::<f64>() / 40.0;
        assert!(score.velocity[i] < 0.2 * unit * size.sqrt(), "{score:?}");
    }
}
