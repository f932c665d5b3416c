//! What the response library of a wheeled robot says of effects on its camera, held against what the simulator is told to do.

use asami::scenario::{self, Origin};
use asami_gap::library::Budget;
use asami_gap::shape::{Numbers, Sight};
use asami_gap::{Library, Planted, Variant};

const RATIO: f64 = 0.05;
const SKEW: f64 = 0.04;

fn planted(name: &str, size: f64) -> Planted {
    let kinds = Variant::all("create", 1, &[]);
    let variant = kinds.into_iter().find(|it| it.about.name == name && it.sign > 0.0).unwrap();
    Planted { variant, size }
}

/// Of the arena, from few runs.
fn library(kinds: &[Variant]) -> Library {
    let text = include_str!("../scenarios/create.toml");
    let Origin::Simulated(nominal) = scenario::parse("create", "create.toml", text).unwrap().origin else {
        panic!("it is simulated")
    };
    let budget = Budget { nominal_runs: 6, runs: 2, sizes: 3, run_s: 60.0 };
    Library::learn(&*nominal, kinds, &budget).unwrap()
}

/// The range that a response says, less the nominal one.
fn longer_m(library: &Library, numbers: &[f64], distance_m: f64, bearing_rad: f64) -> f64 {
    let shape = &library.base.shape;
    let (mut columns, mut slopes) = (vec![0.0; shape.width(Numbers::Size)], [0.0; 4]);
    let sight = Sight {
        distance_m,
        bearing_rad,
        off_rad: bearing_rad,
        pan_rad_per_s: 0.0,
        theta_rad: 0.0,
        landmark: 0,
        attempt: [0.0; 3],
    };
    shape.size_columns(&sight, &mut columns, &mut slopes);
    let of =
        |numbers: &[f64]| columns.iter().zip(&numbers[shape.range(Numbers::Size)]).map(|(c, n)| c * n).sum::<f64>();
    of(numbers) - of(&library.base.numbers)
}

/// A depth along a skewed axis at a wrong scale is what the three make of a range one after another; and of bearings none of
/// them changes anything, however few runs it was learned from: what their noise happens to be is no effect's.
#[test]
fn effects_on_ranges_are_what_they_are_together_and_nothing_else() {
    let effects = [planted("depth_for_range", 1.0), planted("range_scale", RATIO), planted("range_skew", SKEW)];
    let library = library(&effects.clone().map(|it| it.variant));
    let numbers = library.numbers(&effects);
    for (distance_m, bearing_rad) in [(1.5, -0.4), (3.0, 0.1), (5.0, 0.5), (8.0, -0.5)] {
        let share = f64::cos(bearing_rad) + SKEW * f64::sin(bearing_rad);
        let expected_m = distance_m * (share * (1.0 + RATIO) - 1.0);
        let found_m = longer_m(&library, &numbers, distance_m, bearing_rad);
        assert!((found_m - expected_m).abs() < 2e-3 * distance_m, "{distance_m} {bearing_rad}: {found_m} {expected_m}");
    }
    let shape = &library.base.shape;
    for group in [Numbers::Bearing, Numbers::Motion] {
        for i in shape.range(group) {
            let change = numbers[i] - library.base.numbers[i];
            assert!(change.abs() < 1e-6, "{group:?} {i}: {change}");
        }
    }
}
