//! Every learner of the list keeps its promises on any log.

use std::collections::BTreeMap;

use asami_dataset::{Action, Command, Log, Models, Seed, SensorModel, Sighting, Size};
use asami_learners::{CannotLearn, Lack, Learners, Needs};
use asami_math::polynomial::Polynomial;
use proptest::prelude::*;

use crate::synthetic::{curve_of_action, curve_of_sensor, learn, starting};

/// The learners of chapter 3; those of chapter 4 start from both models, those of chapter 5 are a car's.
fn catalogue() -> Vec<&'static asami_learners::About> {
    let ours = |about: &&asami_learners::About| !matches!(about.needs, Needs::Both | Needs::Firings);
    asami_learners::catalogue().into_iter().filter(ours).collect()
}

fn given() -> Models {
    let sensor = Polynomial { coefficients: vec![0.0, 1.0, -0.3, 0.1], centre: 20.0, scale: 10.0 };
    Models { sensor: Some(SensorModel::DistanceOfHeight(sensor.into())), ..starting("c") }
}

fn finite(models: &Models) -> bool {
    let curves = [
        models.action.as_ref().map(|_| curve_of_action(models)),
        models.sensor.as_ref().map(|_| curve_of_sensor(models)),
    ];
    curves.into_iter().flatten().all(|curve| {
        curve.polynomial.coefficients.iter().chain(&curve.se).all(|x| x.is_finite())
            && curve.polynomial.scale != 0.0
            && (curve.se.is_empty() || curve.se.len() == curve.polynomial.coefficients.len())
    })
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -40.0..40.0f64, 1 => Just(0.0), 1 => proptest::num::f64::ANY]
}

fn any_action() -> impl Strategy<Value = Action> {
    prop_oneof![
        8 => (-0.5..0.5f64).prop_map(|v| Action::Wheels { id: None, v_m_per_s: v, omega_rad_per_s: 0.0 }),
        2 => any_number().prop_map(|v| Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: v, atheta_rad_per_s: 0.0 }),
    ]
}

fn any_log() -> impl Strategy<Value = Log> {
    let times = |n| proptest::collection::vec(prop_oneof![9 => 0.0..3.0f64, 1 => Just(0.0), 1 => any_number()], n);
    let commands = (times(0..30), proptest::collection::vec(any_action(), 30));
    let sightings = (times(0..120), proptest::collection::vec(any_number(), 120));
    (commands, sightings).prop_map(|((gaps, actions), (waits, sizes))| {
        let clock = |steps: Vec<f64>| {
            steps
                .into_iter()
                .scan(0.0, |t, step| {
                    *t += step;
                    Some(*t)
                })
                .collect::<Vec<f64>>()
        };
        let commands: Vec<Command> =
            clock(gaps).into_iter().zip(actions).map(|(t_s, action)| Command { t_s, action }).collect();
        let sightings: Vec<Sighting> = clock(waits)
            .into_iter()
            .zip(sizes)
            .map(|(t_s, o)| Sighting { t_s, landmark: 0, size: Size::HeightPx(o), bearing_rad: 0.0 })
            .collect();
        Log { commands: commands.into(), sightings: sightings.into(), ..Log::default() }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]
    #[test]
    fn nothing_panics_and_nothing_learned_is_infinite(log in any_log()) {
        for about in catalogue() {
            let learned = learn(about.name, &[], &log, &given());
            if let Ok(learned) = learned {
                prop_assert!(finite(&learned.models), "{}: {:?}", about.name, learned.models);
            }
        }
    }
}

fn legs(t_s: f64, c: f64) -> Command {
    Command { t_s, action: Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: c, atheta_rad_per_s: 0.0 } }
}

fn seen(t_s: f64, landmark: u16, size: Size) -> Sighting {
    Sighting { t_s, landmark, size, bearing_rad: 0.0 }
}

#[test]
fn what_cannot_be_learned_from_is_refused() {
    let looks = |n: u32| (0..n).map(|i| seen(0.05 * f64::from(i), 0, Size::HeightPx(20.0))).collect::<Vec<_>>();
    let pedals = Command { t_s: 0.0, action: Action::Pedals { throttle: 0.1, brake: 0.0, steering: 0.0 } };
    let log = |commands: Vec<Command>, sightings: Vec<Sighting>| Log {
        commands: commands.into(),
        sightings: sightings.into(),
        ..Log::default()
    };
    let ranges = [looks(9), vec![seen(9.0, 0, Size::RangeM(1.0))]].concat();
    let others = [looks(9), vec![seen(9.0, 7, Size::HeightPx(20.0))]].concat();
    for about in catalogue() {
        let refuses = |log: Log| learn(about.name, &[], &log, &given()).unwrap_err();
        assert_eq!(refuses(log(vec![], looks(50))), CannotLearn::NoCommands);
        assert_eq!(refuses(log(vec![pedals], looks(50))), CannotLearn::WrongCommands);
        assert_eq!(refuses(log(vec![legs(0.0, 0.1)], vec![])), CannotLearn::NoSightings);
        assert_eq!(refuses(log(vec![legs(0.0, 0.1)], ranges.clone())), CannotLearn::MixedSightings);
        assert_eq!(refuses(log(vec![legs(0.0, 0.1)], others.clone())), CannotLearn::SeveralLandmarks { found: 2 });
        let short = refuses(log(vec![legs(0.0, 0.1)], looks(1)));
        assert!(matches!(short, CannotLearn::TooShort { found: 1, .. }), "{}: {short}", about.name);
    }
}

#[test]
fn a_robot_that_stands_still_says_so() {
    let looks: Vec<Sighting> = (0..2000).map(|i| seen(0.05 * f64::from(i), 0, Size::HeightPx(20.0))).collect();
    let log = Log { commands: vec![legs(0.0, 0.0)].into(), sightings: looks.into(), ..Log::default() };
    for about in catalogue() {
        match learn(about.name, &[], &log, &given()) {
            Ok(learned) => {
                assert!(finite(&learned.models), "{}", about.name);
                let narrow = |lack: &Lack| matches!(lack, Lack::NarrowObservations { .. });
                assert!(learned.lacks.iter().any(narrow), "{}: {:?}", about.name, learned.lacks);
            }
            Err(error) => assert!(matches!(error, CannotLearn::Undetermined(_)), "{}: {error}", about.name),
        }
    }
}

#[test]
fn the_catalogue_is_sound_and_overrides_are_checked() {
    use asami_learners::catalogue;
    let mut names: Vec<&str> = catalogue().iter().map(|about| about.name).collect();
    for about in catalogue() {
        assert!(!about.what.is_empty() && !about.source.is_empty());
        assert_eq!(Learners::default().configured(about.name, &BTreeMap::new()).unwrap().about().name, about.name);
        for parameter in about.parameters {
            let with = |value: f64| BTreeMap::from([(parameter.name.to_string(), value)]);
            assert!(Learners::default().configured(about.name, &with(parameter.default)).is_ok(), "{}", parameter.name);
            let faults = Learners::default().configured(about.name, &with(parameter.range.1 + 1.0)).err().unwrap();
            assert_eq!(faults[0].path, format!("learners.{}.{}", about.name, parameter.name));
        }
    }
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), catalogue().len());
    let with = BTreeMap::from([("sensor_degree".to_string(), 2.5)]);
    let faults = Learners::default().configured("algorithm1", &with).err().unwrap();
    assert_eq!(faults[0].message, "sensor_degree must be a whole number, not 2.5");
    assert!(Learners::default().configured("algorithm_1", &BTreeMap::new()).is_err());
}

#[test]
fn learning_draws_the_same_again() {
    let log = crate::synthetic::Pacer { duration_s: 90.0, ..Default::default() }.log(1);
    for about in catalogue() {
        let learner = Learners::default().configured(about.name, &BTreeMap::new()).unwrap();
        let models = || learner.learn(&log, &given(), &mut Seed(1).stream("learner")).unwrap().models;
        assert_eq!(models(), models(), "{}", about.name);
    }
}
