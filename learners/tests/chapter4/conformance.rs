//! Every learner of chapter 4 keeps its promises on any log.

use std::sync::Arc;

use asami_dataset::log::Frame;
use asami_dataset::{Action, ActionModel, Beacon, Command, Known, Log, Models, Seed, SensorModel, Sighting, Size};
use asami_learners::{About, CannotLearn, Learners, Needs};
use proptest::prelude::*;

use crate::synthetic::{Walker, learn, published};

fn catalogue() -> Vec<&'static About> {
    asami_learners::catalogue().into_iter().filter(|about| about.needs == Needs::Both).collect()
}

fn finite(models: &Models) -> bool {
    let Some(ActionModel::Table(entries)) = &models.action else { return false };
    let (Some(SensorModel::HeightOfDistance(curve)) | Some(SensorModel::RangeOfDistance(curve))) = &models.sensor
    else {
        return false;
    };
    let velocities = entries.iter().flat_map(|e| [e.vx_m_per_s, e.vy_m_per_s, e.vtheta_rad_per_s]);
    let noise = &models.noise;
    let sigmas = [noise.sigma1_px, noise.sigma1_m, noise.sigma2_rad].into_iter().flatten();
    velocities.chain(curve.polynomial.coefficients.iter().copied()).chain(sigmas).all(f64::is_finite)
        && entries.iter().filter_map(|entry| entry.se).flatten().all(|se| se.is_finite() && se >= 0.0)
}

/// Sightings out of nowhere, of landmark 0 for learners along a line.
fn any_log() -> impl Strategy<Value = Log> {
    let number = || prop_oneof![6 => -40.0..40.0f64, 1 => Just(0.0), 1 => proptest::num::f64::ANY];
    let commands = proptest::collection::vec((0.0..3.0f64, proptest::option::of(0..4u16), number()), 1..20);
    let sightings = proptest::collection::vec((0.0..0.6f64, 0..4u16, number(), -3.1..3.1f64), 0..80);
    (commands, sightings, any::<bool>(), any::<bool>()).prop_map(|(commands, sightings, with_frames, one)| {
        let mut t_s = 0.0;
        let commands: Vec<Command> = commands
            .into_iter()
            .map(|(gap, id, v)| {
                t_s += gap;
                Command { t_s, action: Action::Legs { id, ax_m_per_s: v, ay_m_per_s: 0.1, atheta_rad_per_s: 0.0 } }
            })
            .collect();
        let mut t_s = 0.0;
        let sightings: Vec<Sighting> = sightings
            .into_iter()
            .map(|(gap, landmark, size, bearing_rad)| {
                t_s += gap;
                Sighting { t_s, landmark: if one { 0 } else { landmark }, size: Size::HeightPx(size), bearing_rad }
            })
            .collect();
        let frames = (0..200).map(|i| Frame { t_s: 0.1 * f64::from(i), head_pan_rad: 0.0 }).collect::<Vec<_>>();
        Log {
            known: known(),
            commands: commands.into(),
            sightings: sightings.into(),
            frames: with_frames.then(|| frames.into()),
            ..Log::default()
        }
    })
}

fn known() -> Arc<Known> {
    let landmarks = (0..4).map(|id| Beacon { id, x_m: f64::from(id % 2), y_m: f64::from(id / 2), height_m: None });
    Arc::new(Known { landmarks: landmarks.collect(), ..Known::default() })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]
    #[test]
    fn nothing_panics_and_nothing_learned_is_infinite(log in any_log()) {
        for about in catalogue() {
            if let Ok(learned) = learn(about.name, &[("max_iterations", 30.0)], &log, &published()) {
                prop_assert!(finite(&learned.models), "{}: {:?}", about.name, learned.models);
            }
        }
    }
}

#[test]
fn what_cannot_be_learned_from_is_refused() {
    let legs =
        |id| Command { t_s: 0.0, action: Action::Legs { id, ax_m_per_s: 0.0, ay_m_per_s: 0.1, atheta_rad_per_s: 0.0 } };
    let looks = |n: u32| {
        let look = |i| Sighting { t_s: 0.05 * f64::from(i), landmark: 0, size: Size::HeightPx(20.0), bearing_rad: 0.0 };
        (0..n).map(look).collect::<Vec<_>>()
    };
    let log = |commands: Vec<Command>, sightings: Vec<Sighting>| Log {
        known: known(),
        commands: commands.into(),
        sightings: sightings.into(),
        ..Log::default()
    };
    let pedals = Command { t_s: 0.0, action: Action::Pedals { throttle: 0.1, brake: 0.0, steering: 0.0 } };
    for about in catalogue() {
        let refuses = |log: Log, given: &Models| learn(about.name, &[], &log, given).unwrap_err();
        let given = published();
        assert_eq!(refuses(log(vec![], looks(50)), &given), CannotLearn::NoCommands);
        assert_eq!(refuses(log(vec![pedals], looks(50)), &given), CannotLearn::WrongCommands);
        assert_eq!(refuses(log(vec![legs(None)], looks(50)), &given), CannotLearn::NoActions);
        assert_eq!(refuses(log(vec![legs(Some(1))], vec![]), &given), CannotLearn::NoSightings);
        let short = refuses(log(vec![legs(Some(1))], looks(1)), &given);
        assert!(matches!(short, CannotLearn::TooShort { found: 1, .. }), "{}: {short}", about.name);
        let missing = [
            Models { action: None, ..published() },
            Models { sensor: None, ..published() },
            Models { noise: asami_dataset::Noise::default(), ..published() },
        ];
        for given in missing {
            let refused = refuses(log(vec![legs(Some(1))], looks(50)), &given);
            assert!(matches!(refused, CannotLearn::NotGiven(_)), "{}: {refused}", about.name);
        }
    }
}

#[test]
fn learning_draws_the_same_again() {
    let log = Walker { steps: 2_000, beacons: vec![0], ..Walker::default() }.log(1000);
    for about in catalogue() {
        let with = [("max_iterations".to_string(), 4.0)].into();
        let learner = Learners::default().configured(about.name, &with).unwrap();
        let models = || learner.learn(&log, &published(), &mut Seed(1).stream("learner")).unwrap().models;
        assert_eq!(models(), models(), "{}", about.name);
    }
}
