//! The published method on a drive made of the model itself.

use asami_dataset::log::Odometry;
use asami_dataset::{ActionModel, Log, SensorModel};
use asami_learners::{CannotLearn, Lack};
use asami_math::angle::wrap_rad;

use crate::synthetic::{Ride, learn};

#[test]
fn angles_motions_and_action_model_are_learned_from_nothing() {
    let ride = Ride::default();
    let driven = ride.drive();
    let learned = learn("car_published", &driven.log).unwrap();
    assert_eq!(learned.lacks, []);

    let Some(SensorModel::Angles { horizontal_angles_rad, se_rad }) = &learned.models.sensor else { panic!() };
    let errors: Vec<f64> =
        horizontal_angles_rad.iter().zip(&driven.angles_rad).map(|(a, b)| wrap_rad(a - b).to_degrees()).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    // The published figure: 0.544 deg over a chain of 63 pairs, absolute; this one has 11.
    assert!(rms < 0.544, "{errors:?}");
    let worst = errors.iter().zip(se_rad).map(|(e, se)| e.abs() / se.to_degrees()).fold(0.0, f64::max);
    assert!(worst < 4.0, "{errors:?}, standard errors {se_rad:?}");

    let trace = |name: &str| &learned.traces.iter().find(|trace| trace.name == name).unwrap().points;
    for (points, of) in [(trace("forward_m_per_s"), 3), (trace("turning_rad_per_s"), 4)] {
        assert_eq!(points.len(), 29);
        let mean = |t_s: f64| {
            let first = (t_s * 7800.0).round() as usize;
            driven.track[first..(first + 3900).min(driven.track.len())].iter().map(|row| row[of]).sum::<f64>() / 3900.0
        };
        let errors: Vec<f64> = points.iter().map(|[t_s, value]| value - mean(*t_s)).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        // Points smear by the way of a tenth of a second, which the method does not undo.
        assert!(rms < if of == 3 { 0.35 } else { 0.02 }, "{rms}: {errors:?}");
    }

    let Some(ActionModel::Car { c, se: Some(se), delay_s: 0.0 }) = learned.models.action else { panic!() };
    for (i, (learned, truth)) in c.iter().zip(ride.c).enumerate() {
        assert!(
            (learned - truth).abs() < 5.0 * se[i] + 0.1 * truth.abs(),
            "c{}: {learned} and {truth}, se {}",
            i + 5,
            se[i]
        );
    }
}

#[test]
fn a_log_of_odometry_and_pedals_gives_an_action_model_alone() {
    let ride = Ride { lasers: 1, turns: 300, firings: 40, ..Ride::default() };
    let driven = ride.drive();
    let odometry: Vec<Odometry> = driven
        .track
        .iter()
        .enumerate()
        .map(|(i, row)| Odometry { t_s: i as f64 / 400.0, v_m_per_s: row[3], omega_rad_per_s: row[4] })
        .collect();
    let log = Log { firings: None, odometry: odometry.into(), ..driven.log.clone() };
    let learned = learn("car_published", &log).unwrap();
    assert_eq!(learned.lacks, [Lack::NoFirings]);
    assert!(learned.models.sensor.is_none());
    let Some(ActionModel::Car { c, .. }) = learned.models.action else { panic!() };
    // Means over half a second of a speed that is no straight line.
    assert!((c[4] - ride.c[4]).abs() < 2e-3 && (c[5] - ride.c[5]).abs() < 0.02 * ride.c[5], "{c:?}");
    let none = Log { firings: None, odometry: Vec::new().into(), ..driven.log };
    assert_eq!(learn("car_published", &none).unwrap_err(), CannotLearn::NoFirings);
}

#[test]
fn a_short_drive_without_pedals_gives_angles_and_says_what_is_missing() {
    let driven = Ride { turns: 4, ..Ride::default() }.drive();
    let log = Log { commands: Vec::new().into(), ..driven.log };
    let learned = learn("car_published", &log).unwrap();
    assert!(learned.models.sensor.is_some() && learned.models.action.is_none());
    assert_eq!(
        learned.lacks,
        [Lack::UnmatchedScans { unmatched: 0, scans: 1 }, Lack::NoForward, Lack::Pedals { found: 0 }]
    );
}
