//! What is written reads back the same.

use std::sync::Arc;

use asami_dataset::log::{RangeBearing, Velodyne};
use asami_dataset::models::{Curve, Entry, NoiseErrors};
use asami_dataset::survey::{Height, Speed, Velocity};
use asami_dataset::{
    Action, ActionModel, Beacon, Camera, Command, CommandsAre, Dataset, Frame, Known, Log, Models, Noise, Odometry,
    Provenance, SensorModel, Sighting, Size, Survey, TruePose, Truth, store,
};
use asami_math::angle::wrap_rad;
use asami_math::polynomial::Polynomial;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

/// Any finite number, subnormal and huge ones included.
fn finite() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![-10.0..10.0, POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO]
}

fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![1e-3..1e3, proptest::num::f64::POSITIVE | proptest::num::f64::NORMAL]
}

fn angle() -> impl Strategy<Value = f64> {
    finite().prop_map(wrap_rad)
}

/// Increasing times.
fn times() -> impl Strategy<Value = Vec<f64>> {
    vec(1e-6..10.0, 0..20).prop_map(|steps| {
        let mut t_s = -0.5;
        steps
            .iter()
            .map(|step| {
                t_s += step;
                t_s
            })
            .collect()
    })
}

fn timed<T: std::fmt::Debug>(value: impl Strategy<Value = T>) -> impl Strategy<Value = Vec<(f64, T)>> {
    (times(), vec(value, 20)).prop_map(|(times, values)| times.into_iter().zip(values).collect())
}

fn rows<T, R>(timed: Vec<(f64, T)>, row: impl Fn(f64, T) -> R) -> asami_dataset::Channel<R> {
    timed.into_iter().map(|(t_s, value)| row(t_s, value)).collect::<Vec<_>>().into()
}

fn action(robot: &str) -> BoxedStrategy<Action> {
    match robot {
        "car" => (0.0..=1.0, 0.0..=1.0, -1.0..=1.0)
            .prop_map(|(throttle, brake, steering)| Action::Pedals { throttle, brake, steering })
            .boxed(),
        "create" => (option::of(any::<u16>()), finite(), finite())
            .prop_map(|(id, v_m_per_s, omega_rad_per_s)| Action::Wheels { id, v_m_per_s, omega_rad_per_s })
            .boxed(),
        _ => (option::of(any::<u16>()), finite(), finite(), finite())
            .prop_map(|(id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s)| Action::Legs {
                id,
                ax_m_per_s,
                ay_m_per_s,
                atheta_rad_per_s,
            })
            .boxed(),
    }
}

fn known(robot: &'static str) -> impl Strategy<Value = Known> {
    let landmark = (finite(), finite(), option::of(positive()));
    let camera = (1..9999u32, 1..9999u32, positive(), positive());
    let vertical = vec(-1.5..1.5, 1..64).prop_map(|mut angles: Vec<f64>| {
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    });
    let velodyne = (vertical, positive(), positive(), finite());
    (
        option::of(".{0,12}"),
        option::of(positive()),
        option::of(camera),
        option::of((positive(), finite(), finite())),
        proptest::collection::btree_map(any::<u16>(), landmark, 1..6),
        option::of(velodyne),
        proptest::collection::btree_map(".{1,8}", positive(), 0..3),
        any::<bool>(),
    )
        .prop_map(move |(nominal, command_rate_hz, camera, sensor, landmarks, velodyne, full_scale, told)| Known {
            robot: robot.to_owned(),
            nominal,
            commands_are: if told { CommandsAre::Told } else { CommandsAre::Odometry },
            command_rate_hz,
            range_bearing: sensor
                .filter(|_| camera.is_none())
                .map(|(max_range_m, x_m, y_m)| RangeBearing { max_range_m, sensor_origin_m: [x_m, y_m] }),
            camera: camera.map(|(width_px, height_px, focal_px, frame_rate_hz)| Camera {
                width_px,
                height_px,
                focal_px,
                frame_rate_hz,
            }),
            landmarks: landmarks
                .into_iter()
                .map(|(id, (x_m, y_m, height_m))| Beacon { id, x_m, y_m, height_m })
                .collect(),
            velodyne: velodyne.map(|(vertical_angles_rad, firing_rate_hz, turn_rate_hz, sensor_height_m)| Velodyne {
                left_m: vertical_angles_rad.iter().map(|angle| 0.1 * angle).collect(),
                up_m: Vec::new(),
                vertical_angles_rad,
                firing_rate_hz,
                turn_rate_hz,
                sensor_height_m,
            }),
            full_scale: full_scale.into_iter().collect(),
        })
}

fn survey() -> impl Strategy<Value = Survey> {
    let speed = (finite(), finite(), positive(), 1..u32::MAX).prop_map(
        |(command_m_per_s, speed_m_per_s, sd_m_per_s, timings)| Speed {
            command_m_per_s,
            speed_m_per_s,
            sd_m_per_s,
            timings,
        },
    );
    let height = (positive(), positive(), positive(), positive(), 1..u32::MAX).prop_map(
        |(distance_m, height_px, sd_px, bearing_sd_rad, readings)| Height {
            distance_m,
            height_px,
            sd_px,
            bearing_sd_rad,
            readings,
        },
    );
    let velocity =
        (any::<u16>(), finite(), finite(), finite()).prop_map(|(action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s)| {
            Velocity { action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s }
        });
    (
        vec(speed, 0..4),
        vec(height, 0..4),
        vec(velocity, 0..4),
        (option::of(positive()), option::of(positive()), option::of(positive()), option::of(finite())),
        (vec(finite(), 0..4), option::of([positive(), positive(), positive()])),
    )
        .prop_map(
            |(
                speed_by_command,
                height_by_distance,
                velocity_by_action,
                (sigma1_px, sigma1_m, sigma2_rad, theta_b_rad),
                (horizontal_angles_rad, motion_sd),
            )| {
                Survey {
                    speed_by_command,
                    height_by_distance,
                    velocity_by_action,
                    sigma1_px,
                    sigma1_m,
                    sigma2_rad,
                    motion_sd,
                    horizontal_angles_rad,
                    theta_b_rad,
                }
            },
        )
}

fn dataset() -> impl Strategy<Value = Dataset> {
    prop_oneof![Just("aibo"), Just("car"), Just("create"), Just("plain")].prop_flat_map(|robot| {
        let log = (
            known(robot),
            timed(action(robot)),
            option::of(timed(angle())),
            timed((positive(), any::<prop::sample::Index>(), angle())),
            any::<bool>(),
            timed((finite(), finite())),
        );
        let provenance = (".{0,9}", ".{0,9}", any::<u64>(), ".{0,9}")
            .prop_map(|(scenario, scenario_hash, seed, version)| Provenance { scenario, scenario_hash, seed, version });
        let truth = (timed((finite(), finite(), angle(), option::of(finite()))), option::of(survey()));
        (log, truth, option::of(provenance)).prop_map(|(log, (track, survey), provenance)| {
            let (known, commands, frames, sightings, heights, odometry) = log;
            let heights = known.camera.is_some() || (known.range_bearing.is_none() && heights);
            let sighting = |t_s, (size, landmark, bearing_rad): (f64, prop::sample::Index, f64)| Sighting {
                t_s,
                landmark: known.landmarks[landmark.index(known.landmarks.len())].id,
                size: if heights { Size::HeightPx(size) } else { Size::RangeM(size) },
                bearing_rad,
            };
            let log = Log {
                commands: rows(commands, |t_s, action| Command { t_s, action }),
                frames: frames.map(|frames| rows(frames, |t_s, head_pan_rad| Frame { t_s, head_pan_rad })),
                sightings: rows(sightings, sighting),
                odometry: rows(odometry, |t_s, (v_m_per_s, omega_rad_per_s)| Odometry {
                    t_s,
                    v_m_per_s,
                    omega_rad_per_s,
                }),
                known: Arc::new(known),
                ..Log::default()
            };
            let track =
                rows(track, |t_s, (x_m, y_m, theta_rad, v_m_per_s)| TruePose { t_s, x_m, y_m, theta_rad, v_m_per_s });
            Dataset { log, truth: Truth { track, survey }, provenance }
        })
    })
}

fn models() -> impl Strategy<Value = Models> {
    let curve = || {
        (vec((finite(), positive()), 1..6), finite(), positive(), any::<bool>()).prop_map(
            |(terms, centre, scale, with_se)| {
                let (coefficients, se): (Vec<f64>, Vec<f64>) = terms.into_iter().unzip();
                Curve {
                    polynomial: Polynomial { coefficients, centre, scale },
                    se: if with_se { se } else { Vec::new() },
                }
            },
        )
    };
    let se = || option::of([positive(), positive(), positive()]);
    let entry = (finite(), finite(), finite(), se());
    let entries = proptest::collection::btree_map(any::<u16>(), entry, 0..5).prop_map(|entries| {
        let entry = |(action, (vx_m_per_s, vy_m_per_s, vtheta_rad_per_s, se))| Entry {
            action,
            vx_m_per_s,
            vy_m_per_s,
            vtheta_rad_per_s,
            se,
        };
        ActionModel::Table(entries.into_iter().map(entry).collect())
    });
    let car = (vec(finite(), 6), option::of(vec(positive(), 6)), finite()).prop_map(|(c, se, delay_s)| {
        ActionModel::Car { c: std::array::from_fn(|i| c[i]), se: se.map(|se| std::array::from_fn(|i| se[i])), delay_s }
    });
    let action = prop_oneof![curve().prop_map(ActionModel::Polynomial), Just(ActionModel::Sign), entries, car];
    let angles = (vec(finite(), 64), any::<bool>()).prop_map(|(horizontal_angles_rad, with_se)| {
        let se_rad = if with_se { vec![0.5; 64] } else { Vec::new() };
        SensorModel::Angles { horizontal_angles_rad, se_rad }
    });
    let sensor = prop_oneof![
        curve().prop_map(SensorModel::HeightOfDistance),
        curve().prop_map(SensorModel::DistanceOfHeight),
        curve().prop_map(SensorModel::RangeOfDistance),
        angles,
    ];
    let motion = option::of((positive(), positive(), positive()).prop_map(|(x, y, theta)| [x, y, theta]));
    let motion_se = option::of((positive(), positive(), positive()).prop_map(|(x, y, theta)| [x, y, theta]));
    let se = (option::of(positive()), option::of(positive()), motion_se)
        .prop_map(|(sigma1, sigma2_rad, motion_sd)| NoiseErrors { sigma1, sigma2_rad, motion_sd });
    let noise = (option::of(positive()), option::of(positive()), option::of(positive()), motion, se).prop_map(
        |(sigma1_px, sigma1_m, sigma2_rad, motion_sd, se)| Noise { sigma1_px, sigma1_m, sigma2_rad, motion_sd, se },
    );
    (option::of(action), option::of(sensor), noise).prop_map(|(action, sensor, noise)| Models { action, sensor, noise })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn a_data_set_reads_back_as_it_was(dataset in dataset()) {
        let dir = tempfile::tempdir().unwrap();
        store::write(&dataset, dir.path()).unwrap();
        let read = store::read(dir.path()).unwrap();
        // An empty channel of commands, sightings or poses is no file, and back an empty channel.
        prop_assert_eq!(read, dataset);
    }

    #[test]
    fn models_read_back_as_they_were(models in models(), learner in ".{0,20}") {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("models.toml");
        store::write_models(&learner, &models, &path).unwrap();
        prop_assert_eq!(store::read_models(&path).unwrap(), (learner, models));
    }
}

#[test]
fn the_written_bytes_do_not_depend_on_the_sign_of_zero() {
    let row = |zero| Command {
        t_s: 0.0,
        action: Action::Legs { id: None, ax_m_per_s: zero, ay_m_per_s: 0.3, atheta_rad_per_s: zero },
    };
    let text = |zero| {
        let known = Known { robot: "aibo".to_owned(), ..Known::default() };
        let log = Log { known: known.into(), commands: vec![row(zero)].into(), ..Log::default() };
        let dir = tempfile::tempdir().unwrap();
        store::write(&Dataset { log, ..Dataset::default() }, dir.path()).unwrap();
        std::fs::read_to_string(dir.path().join("commands.csv")).unwrap()
    };
    assert_eq!(text(-0.0), text(0.0));
    assert_eq!(text(0.0), "t_s,action,ax_m_per_s,ay_m_per_s,atheta_rad_per_s\n0.0,,0.0,0.3,0.0\n");
}

#[test]
fn wheels_have_a_column_of_actions_where_they_were_binned() {
    let known = Known { robot: "create".to_owned(), ..Known::default() };
    let row = |t_s, id| Command { t_s, action: Action::Wheels { id, v_m_per_s: 0.1, omega_rad_per_s: 0.0 } };
    let text = |commands: Vec<Command>| {
        let log = Log { known: known.clone().into(), commands: commands.into(), ..Log::default() };
        let dir = tempfile::tempdir().unwrap();
        store::write(&Dataset { log: log.clone(), ..Dataset::default() }, dir.path()).unwrap();
        assert_eq!(store::read(dir.path()).unwrap().log, log);
        std::fs::read_to_string(dir.path().join("commands.csv")).unwrap()
    };
    assert_eq!(text(vec![row(0.0, None)]), "t_s,v_m_per_s,omega_rad_per_s\n0.0,0.1,0.0\n");
    assert_eq!(
        text(vec![row(0.0, None), row(1.0, Some(7))]),
        "t_s,action,v_m_per_s,omega_rad_per_s\n0.0,,0.1,0.0\n1.0,7,0.1,0.0\n"
    );
}

#[test]
fn writing_replaces_what_an_earlier_data_set_left() {
    let dir = tempfile::tempdir().unwrap();
    let known = Known { robot: "create".to_owned(), ..Known::default() };
    let odometry = vec![Odometry { t_s: 0.0, v_m_per_s: 1.0, omega_rad_per_s: 0.0 }];
    let bare = Dataset { log: Log { known: known.into(), ..Log::default() }, ..Dataset::default() };
    let mut more = bare.clone();
    more.log.odometry = odometry.into();
    store::write(&more, dir.path()).unwrap();
    std::fs::write(dir.path().join("notes.txt"), "mine").unwrap();
    store::write(&bare, dir.path()).unwrap();
    assert_eq!(store::read(dir.path()).unwrap(), bare);
    assert!(dir.path().join("notes.txt").exists(), "files that are not the format's are left alone");
}

#[test]
fn what_the_reader_would_refuse_is_not_written() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("set");
    let known = Known { robot: "aibo".to_owned(), ..Known::default() };
    let log = |commands: Vec<Command>, sightings: Vec<Sighting>| Log {
        known: known.clone().into(),
        commands: commands.into(),
        sightings: sightings.into(),
        ..Log::default()
    };
    let legs = |t_s, ay_m_per_s| Command {
        t_s,
        action: Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 },
    };
    let wheels = Command { t_s: 1.0, action: Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s: 0.0 } };
    let seen = Sighting { t_s: 0.0, landmark: 3, size: Size::HeightPx(9.0), bearing_rad: 0.0 };
    let unfit = [
        (log(vec![legs(0.0, f64::NAN)], vec![]), "ay_m_per_s must be a finite number, not NaN"),
        (log(vec![legs(1.0, 0.0), legs(0.5, 0.0)], vec![]), "times must increase: 0.5 follows 1"),
        (log(vec![legs(0.0, 0.0), wheels], vec![]), "commands must be of one kind"),
        (log(vec![], vec![seen]), "landmark must be one that dataset.toml declares, not 3"),
    ];
    for (log, message) in unfit {
        let refused = store::write(&Dataset { log, ..Dataset::default() }, &target).unwrap_err().to_string();
        assert!(refused.contains(message), "{refused}");
        assert!(!target.exists(), "nothing may be touched: {message}");
    }
    let nan = Models { noise: Noise { sigma1_px: Some(f64::NAN), ..Noise::default() }, ..Models::default() };
    let refused = store::write_models("x", &nan, &dir.path().join("m.toml")).unwrap_err().to_string();
    assert!(refused.contains("sigma1_px must be a number not less than 0, not nan"), "{refused}");
}
