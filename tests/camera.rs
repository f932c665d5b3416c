//! What response libraries of wheeled robots say of effects on their sensors, held against what the simulator is told to do.

use asami::scenario::{self, Origin, Simulation};
use asami_dataset::truth::pose_at;
use asami_dataset::{Dataset, Log, Seed};
use asami_gap::filter::{Kalman, UNCOUNTED, Walk};
use asami_gap::library::{Budget, play};
use asami_gap::shape::{Numbers, Sight};
use asami_gap::state::Belief;
use asami_gap::view::View;
use asami_gap::{Judge, Library, Planted, Sighted, Variant};
use nalgebra::{Matrix3, Vector3};
use rand_distr::{Distribution, StandardNormal};

const RATIO: f64 = 0.05;
const SKEW: f64 = 0.04;
const ECCENTRICITY: f64 = 0.03;
/// By how much a scanner's bearings scatter.
const SIGMA2_RAD: f64 = 0.026;
const SEEDS: u64 = 24;

/// Of 60 degrees.
const CAMERA: &str = include_str!("../scenarios/create.toml");
/// Of 240 degrees.
const SCANNER: &str = include_str!("../scenarios/create_laser.toml");

fn planted(name: &str, size: f64) -> Planted {
    let kinds = Variant::all("create", 1, &[]);
    let variant = kinds.into_iter().find(|it| it.about.name == name && it.sign > 0.0).unwrap();
    Planted { variant, size }
}

fn world(scenario: &str) -> Box<Simulation> {
    let Origin::Simulated(world) = scenario::parse("create", "create.toml", scenario).unwrap().origin else {
        panic!("it is simulated")
    };
    world
}

/// Of effects in a world, from few runs.
fn library(scenario: &str, effects: &[Planted]) -> Library {
    let kinds: Vec<Variant> = effects.iter().map(|it| it.variant.clone()).collect();
    let budget = Budget { nominal_runs: 6, runs: 2, sizes: 3, run_s: 60.0 };
    Library::learn(&*world(scenario), &kinds, &budget).unwrap()
}

fn sight(distance_m: f64, bearing_rad: f64) -> Sight {
    Sight {
        distance_m,
        bearing_rad,
        off_rad: bearing_rad,
        pan_rad_per_s: 0.0,
        theta_rad: 0.0,
        landmark: 0,
        attempt: [0.0; 3],
    }
}

/// What columns make of a group's numbers, less what they make of the nominal ones.
fn more(library: &Library, numbers: &[f64], group: Numbers, columns: &[f64]) -> f64 {
    let of = |numbers: &[f64]| {
        columns.iter().zip(&numbers[library.base.shape.range(group)]).map(|(c, n)| c * n).sum::<f64>()
    };
    of(numbers) - of(&library.base.numbers)
}

/// The range that a response says, less the nominal one.
fn longer_m(library: &Library, numbers: &[f64], sight: &Sight) -> f64 {
    let shape = &library.base.shape;
    let (mut columns, mut slopes) = (vec![0.0; shape.width(Numbers::Size)], [0.0; 4]);
    shape.size_columns(sight, &mut columns, &mut slopes);
    more(library, numbers, Numbers::Size, &columns)
}

/// The bearing that a response says, less the nominal one.
fn farther_left_rad(library: &Library, numbers: &[f64], sight: &Sight) -> f64 {
    let shape = &library.base.shape;
    let mut columns = vec![0.0; shape.width(Numbers::Bearing)];
    shape.bearing_columns(sight, &mut columns);
    more(library, numbers, Numbers::Bearing, &columns)
}

/// Numbers of these groups are the nominal ones.
fn assert_nominal(library: &Library, numbers: &[f64], groups: &[Numbers]) {
    for group in groups {
        for i in library.base.shape.range(*group) {
            let change = numbers[i] - library.base.numbers[i];
            assert!(change.abs() < 1e-6, "{group:?} {i}: {change}");
        }
    }
}

/// A depth along a skewed axis at a wrong scale is what the three make of a range one after another; and of bearings none of
/// them changes anything, however few runs it was learned from: what their noise happens to be is no effect's.
#[test]
fn effects_on_ranges_are_what_they_are_together_and_nothing_else() {
    let effects = [planted("depth_for_range", 1.0), planted("range_scale", RATIO), planted("range_skew", SKEW)];
    let library = library(CAMERA, &effects);
    let numbers = library.numbers(&effects);
    for (distance_m, bearing_rad) in [(1.5, -0.4), (3.0, 0.1), (5.0, 0.5), (8.0, -0.5)] {
        let share = f64::cos(bearing_rad) + SKEW * f64::sin(bearing_rad);
        let expected_m = distance_m * (share * (1.0 + RATIO) - 1.0);
        let found_m = longer_m(&library, &numbers, &sight(distance_m, bearing_rad));
        assert!((found_m - expected_m).abs() < 2e-3 * distance_m, "{distance_m} {bearing_rad}: {found_m} {expected_m}");
    }
    assert_nominal(&library, &numbers, &[Numbers::Bearing, Numbers::Motion]);
}

/// A scanner's mirror that turns too slowly about another axis than its encoder's spreads bearings and bends them to both sides,
/// also behind right angles, and changes no range.
#[test]
fn angles_of_a_scanner_are_its_mirrors() {
    let effects = [planted("bearing_scale", RATIO), planted("encoder_eccentricity", ECCENTRICITY)];
    let library = library(SCANNER, &effects);
    let numbers = library.numbers(&effects);
    for bearing_rad in [-1.9, -0.8, 0.3, 1.6] {
        let expected_rad = RATIO * bearing_rad + ECCENTRICITY * (1.0 - f64::cos(bearing_rad));
        let found_rad = farther_left_rad(&library, &numbers, &sight(3.0, bearing_rad));
        assert!((found_rad - expected_rad).abs() < 0.1 * SIGMA2_RAD, "{bearing_rad}: {found_rad} {expected_rad}");
    }
    assert_nominal(&library, &numbers, &[Numbers::Size, Numbers::Motion]);
}

/// A scanner has no lens, and a camera no mirror: what is the matter with it changes no number at all.
#[test]
fn what_a_sensor_has_not_changes_nothing() {
    let lens = [planted("focal_error", RATIO), planted("lens_distortion", 0.1)];
    let mirror = [planted("bearing_scale", RATIO), planted("encoder_eccentricity", ECCENTRICITY)];
    for (scenario, effects) in [(SCANNER, lens), (CAMERA, mirror)] {
        let library = library(scenario, &effects);
        assert_eq!(library.numbers(&effects), library.base.numbers);
    }
}

/// A camera that is turned, of which bearings are read to 6 mrad, seems to stand metres away where nothing is known of that; no filter
/// finds back from there for a while.
#[test]
fn a_robot_starts_where_it_is_likeliest_to_with_what_is_known() {
    let exact = CAMERA.replace("sigma2_rad = 0.02", "sigma2_rad = 0.006");
    let effects = [planted("pan_offset", 0.045), planted("depth_for_range", 1.0)];
    let (world, library) = (world(&exact), library(&exact, &effects));
    let better: Vec<f64> = (1..=SEEDS)
        .map(|seed| {
            let log = Log { frames: None, ..play(&*world, &effects, Seed(seed), 40.0).unwrap().log };
            let [known, unknown] =
                [&effects[..], &[]].map(|with| Sighted::scoring(&log, &library, with, |_| true).unwrap());
            // Whoever starts later, has less to say.
            let from_s = known.steps()[0].t_s.max(unknown.steps()[0].t_s);
            let likely = |judge: &Sighted<'_>| {
                let terms = judge.terms(&judge.numbers(&effects));
                let scored = judge.steps().iter().zip(terms).filter(|(step, _)| step.t_s >= from_s);
                scored.fold(0.0, |sum, (_, term)| sum + term)
            };
            likely(&known) - likely(&unknown)
        })
        .collect();
    assert!(better.iter().all(|it| *it > -5.0) && better.iter().any(|it| *it > 50.0), "{better:?}");
}

/// A robot that has gone on for a while with a heading that it is unsure of, and has seen nothing, is somewhere on an arc: of most logs
/// what it sees then is likelier to the filter that knows that, and the other is lost of some.
#[test]
fn a_robot_that_was_unsure_of_its_heading_is_found_on_an_arc() {
    const OFF: [f64; 3] = [0.02, 0.02, 0.5];
    const BLIND_S: std::ops::Range<f64> = 2.0..30.0;
    const LENGTH_S: f64 = 60.0;
    let exact = CAMERA.replace("sigma2_rad = 0.02", "sigma2_rad = 0.006");
    let (world, library) = (world(&exact), library(&exact, &[]));
    let base = &library.base;
    let found = |seed: u64| {
        let Dataset { log, truth, .. } = play(&*world, &[], Seed(seed), LENGTH_S).unwrap();
        let sightings =
            log.sightings.iter().filter(|seen| !BLIND_S.contains(&seen.t_s)).copied().collect::<Vec<_>>().into();
        let view = View::new(&Log { frames: None, sightings, ..log }, &base.shape.columns).unwrap();
        let begin = view.steps.iter().position(|step| BLIND_S.contains(&step.t_s)).unwrap();
        let at = |step: usize| {
            let pose = pose_at(&truth.track, view.steps[step].t_s).unwrap();
            Vector3::new(pose.x_m, pose.y_m, pose.theta_rad)
        };
        let mut rng = Seed(seed).stream("camera/off");
        let off = Vector3::from(OFF.map(|sd| sd * Distribution::<f64>::sample(&StandardNormal, &mut rng)));
        let covariance = Matrix3::from_diagonal(&Vector3::from(OFF.map(|sd| sd * sd)));
        let last = view.steps.len() - 1;
        [Kalman::Extended, Kalman::Invariant].map(|kalman| {
            let mut belief = Belief { mean: at(begin) + off, covariance };
            let walk = Walk {
                shape: &base.shape,
                numbers: &base.numbers,
                memory: base.memory,
                view: &view,
                counted: UNCOUNTED,
                kalman,
            };
            let likely = walk.filter(begin..last, &mut belief).total(0);
            let off = belief.mean - at(last - 1);
            (likely, off.x.hypot(off.y))
        })
    };
    let all: Vec<_> = (1..=SEEDS).map(found).collect();
    let gains: Vec<f64> = all.iter().map(|[extended, invariant]| invariant.0 - extended.0).collect();
    assert!(gains.iter().all(|it| *it > -10.0) && gains.iter().filter(|it| **it > 10.0).count() > 8, "{gains:?}");
    let [extended, invariant] = [0, 1].map(|k| all.iter().map(|it| it[k].1).fold(0.0, f64::max));
    assert!(extended > 1.0 && invariant < 0.02, "{extended} {invariant}");
}
