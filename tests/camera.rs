//! What response libraries of wheeled robots say of effects on their sensors, held against what the simulator is told to do.

use asami::scenario::{self, Origin};
use asami_gap::library::Budget;
use asami_gap::shape::{Numbers, Sight};
use asami_gap::{Library, Planted, Variant};

const RATIO: f64 = 0.05;
const SKEW: f64 = 0.04;
const ECCENTRICITY: f64 = 0.03;

/// Of 60 degrees.
const CAMERA: &str = include_str!("../scenarios/create.toml");
/// Of 240 degrees.
const SCANNER: &str = include_str!("../scenarios/create_laser.toml");

fn planted(name: &str, size: f64) -> Planted {
    let kinds = Variant::all("create", 1, &[]);
    let variant = kinds.into_iter().find(|it| it.about.name == name && it.sign > 0.0).unwrap();
    Planted { variant, size }
}

/// Of effects in a world, from few runs.
fn library(scenario: &str, effects: &[Planted]) -> Library {
    let Origin::Simulated(nominal) = scenario::parse("create", "create.toml", scenario).unwrap().origin else {
        panic!("it is simulated")
    };
    let kinds: Vec<Variant> = effects.iter().map(|it| it.variant.clone()).collect();
    let budget = Budget { nominal_runs: 6, runs: 2, sizes: 3, run_s: 60.0 };
    Library::learn(&*nominal, &kinds, &budget).unwrap()
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
        assert!((found_rad - expected_rad).abs() < 1e-3, "{bearing_rad}: {found_rad} {expected_rad}");
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
