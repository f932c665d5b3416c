//! What must not matter does not matter.

use std::sync::Arc;

use asami_dataset::{ActionModel, Beacon, Known, Log, Sighting};

use crate::synthetic::{Walker, learn, published};

/// The log in a world whose landmarks are changed, and the sightings.
fn changed(log: &Log, place: impl Fn(f64, f64) -> (f64, f64), bearing: f64) -> Log {
    let landmark = |beacon: &Beacon| {
        let (x_m, y_m) = place(beacon.x_m, beacon.y_m);
        Beacon { x_m, y_m, ..*beacon }
    };
    let landmarks = log.known.landmarks.iter().map(landmark).collect();
    let turned = |row: &Sighting| Sighting { bearing_rad: bearing * row.bearing_rad, ..*row };
    Log {
        known: Arc::new(Known { landmarks, ..(*log.known).clone() }),
        sightings: log.sightings.iter().map(turned).collect::<Vec<_>>().into(),
        ..log.clone()
    }
}

fn velocities(name: &str, log: &Log) -> Vec<[f64; 3]> {
    // Few iterations: roundings grow by a tenth in each.
    let learned = learn(name, &[("max_iterations", 40.0)], log, &published()).unwrap();
    let Some(ActionModel::Table(entries)) = learned.models.action else { panic!("no table") };
    entries.iter().map(|e| [e.vx_m_per_s, e.vy_m_per_s, e.vtheta_rad_per_s]).collect()
}

#[test]
fn turning_moving_and_mirroring_the_world() {
    let log = Walker { steps: 4_000, sigma2_rad: 0.1, ..Walker::default() }.log(1002);
    for name in ["em_exact", "em_best"] {
        let plain = velocities(name, &log);
        let turned = velocities(name, &changed(&log, |x, y| (5.0 - y, x - 2.0), 1.0));
        let mirrored = velocities(name, &changed(&log, |x, y| (-x, y), -1.0));
        for ((plain, turned), mirrored) in plain.iter().zip(&turned).zip(&mirrored) {
            for i in 0..3 {
                let sign = if i == 1 { 1.0 } else { -1.0 };
                assert!((plain[i] - turned[i]).abs() < 1e-5, "{name}: {plain:?} {turned:?}");
                assert!((plain[i] - sign * mirrored[i]).abs() < 1e-5, "{name}: {plain:?} {mirrored:?}");
            }
        }
        assert!(plain.iter().any(|v| v[2].abs() > 0.5));
    }
}
