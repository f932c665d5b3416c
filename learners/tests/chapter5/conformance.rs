//! Every learner of chapter 5 keeps its promises on any log.

use std::sync::Arc;

use asami_dataset::log::Velodyne;
use asami_dataset::{Action, Command, Firings, Known, Log, SensorModel};
use asami_learners::Needs;
use proptest::prelude::*;

use crate::synthetic::{Ride, learn};

fn catalogue() -> Vec<&'static str> {
    let ours = |about: &&asami_learners::About| about.needs == Needs::Firings;
    asami_learners::catalogue().into_iter().filter(ours).map(|about| about.name).collect()
}

/// Firings out of nowhere, most of them with columns that fit.
fn any_log() -> impl Strategy<Value = Log> {
    let lasers = prop_oneof![1 => Just(0usize), 6 => 1..6usize];
    (lasers, 0..400usize, any::<u64>(), 1..9000u16, proptest::option::of(0..9usize), any::<bool>()).prop_map(
        |(lasers, n, mut state, step, spoil, still)| {
            let mut draw = move || {
                // Marsaglia 2003.
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                state
            };
            let mut firings = Firings {
                t_s: (0..n).map(|i| 0.01 * i as f64).collect(),
                encoder_cdeg: (0..n)
                    .map(|i| if still { 7 } else { (i as u64 * u64::from(step) % 36_000) as u16 })
                    .collect(),
                range_2mm: (0..lasers).map(|_| (0..n).map(|_| (draw() % 65_536) as u16).collect()).collect(),
                intensity: Vec::new(),
            };
            let mut angles: Vec<f64> = (0..lasers).map(|l| -0.3 + 0.1 * l as f64).collect();
            match spoil {
                Some(0) => firings.t_s.reverse(),
                Some(1) => firings.encoder_cdeg.iter_mut().for_each(|e| *e = e.wrapping_mul(7)),
                Some(2) => firings.range_2mm.iter_mut().for_each(|r| r.truncate(3)),
                Some(3) => firings.t_s.iter_mut().for_each(|t| *t *= 1e300),
                Some(4) => angles.iter_mut().for_each(|a| *a = f64::NAN),
                Some(5) => angles.truncate(1),
                Some(6) => firings.range_2mm.iter_mut().flatten().for_each(|r| *r = 0),
                Some(7) => firings.t_s.iter_mut().for_each(|t| *t = 1.0),
                _ => (),
            }
            let pedals = Action::Pedals { throttle: 1.0, brake: f64::NAN, steering: 0.0 };
            let velodyne = Velodyne {
                vertical_angles_rad: angles,
                firing_rate_hz: 0.0,
                turn_rate_hz: f64::NAN,
                sensor_height_m: 0.0,
                left_m: Vec::new(),
                up_m: Vec::new(),
            };
            Log {
                known: Known { velodyne: Some(velodyne), ..Known::default() }.into(),
                commands: vec![Command { t_s: 0.0, action: pedals }].into(),
                firings: Some(Arc::new(firings)),
                ..Log::default()
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn no_log_panics_and_what_is_learned_is_finite(log in any_log()) {
        for name in catalogue() {
            if let Ok(learned) = learn(name, &log)
                && let Some(SensorModel::Angles { horizontal_angles_rad, .. }) = &learned.models.sensor
            {
                prop_assert!(horizontal_angles_rad.iter().all(|angle| angle.is_finite()), "{name}: {horizontal_angles_rad:?}");
            }
        }
    }
}

#[test]
fn the_same_log_gives_the_same_bits() {
    let log = Ride { turns: 25, firings: 200, lasers: 7, ..Ride::default() }.drive().log;
    for name in catalogue() {
        let once = || learn(name, &log).map(|learned| (learned.models, format!("{:?}", learned.traces)));
        assert_eq!(once(), once(), "{name}");
    }
}
