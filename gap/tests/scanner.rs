//! Diagnoses of a scanner by its own table, in towns that it has no map of.

use asami_dataset::{Log, Seed};
use asami_gap::answer::diagnosis::{Cause, Verdict};
use asami_gap::library::play;
use asami_gap::real::scanner::agrees::Agreement;
use asami_gap::real::scanner::{Found, corrected, diagnose};
use asami_gap::view::CannotSee;
use asami_gap::{Planted, Variant};

mod town;

use town::Town;

const RUN_S: f64 = 24.0;

fn variants() -> Vec<Variant> {
    Variant::all("car", 0, &[])
}

fn log(planted: &[Planted], seed: u64) -> Log {
    play(&Town::default(), planted, Seed(seed), RUN_S).unwrap().log
}

fn planted(name: &str, apart_m: f64, size: f64) -> Planted {
    let is = |it: &Variant| it.about.name == name && it.choices.iter().all(|(_, value)| *value == apart_m);
    Planted { variant: variants().into_iter().find(is).unwrap(), size }
}

fn leads(found: &Found) -> &Cause {
    &found.diagnosis.which[0]
}

fn value(found: &Found, path: &str) -> f64 {
    leads(found).parameters.get(path).unwrap_or_else(|| panic!("{path}: {:?}", leads(found))).value
}

#[test]
fn a_scanner_whose_table_is_right_has_no_gap() {
    for seed in [1000, 1001] {
        let found = diagnose(&variants(), &log(&[], seed)).unwrap();
        assert_eq!(found.diagnosis.verdict, Verdict::None, "{:?}", found.diagnosis.which);
        assert!(found.lasers.is_empty());
        assert!(found.diagnosis.smallest_visible["laser_origin_offsets.aside_m"] < 0.01);
        assert!(found.diagnosis.smallest_visible["vertical_angle_bias.spread_rad"] < 1e-3);
    }
}

/// What is planted is named, corrected, and then gone; surfaces are thinner for it, which nothing was made best by.
#[test]
fn what_is_wrong_with_a_table_is_named_and_its_correction_makes_surfaces_thinner() {
    let log = log(&[planted("range_bias", 0.0, 0.04), planted("laser_origin_offsets", 0.09, 0.026)], 1002);
    let found = diagnose(&variants(), &log).unwrap();
    assert_eq!(found.diagnosis.verdict, Verdict::Named, "{:?}", found.diagnosis.which);
    let mut effects = leads(&found).effects.clone();
    effects.sort();
    assert_eq!(effects, ["laser_origin_offsets", "range_bias"]);
    assert!((value(&found, "laser_origin_offsets.aside_m") - 0.026).abs() < 0.004, "{:?}", leads(&found));
    assert_eq!(value(&found, "laser_origin_offsets.apart_m"), 0.09);
    // The spread of 64 is within a quarter of the law's, and lasers that see nothing say nothing.
    assert!((value(&found, "range_bias.spread_m") / 0.04).ln().abs() < 0.35, "{:?}", leads(&found));
    assert!(found.diagnosis.how_far.closed.unwrap() > 0.95);
    // By how much all are off alike is the street's shape as well.
    assert!(!leads(&found).parameters.contains_key("range_bias.bias_m"));

    let repaired = corrected(&log, &found.lasers);
    let [first, then] = [&log, &repaired].map(|log| Agreement::of(log).unwrap());
    assert!(then.off_planes_m.unwrap() < 0.9 * first.off_planes_m.unwrap(), "{first:?} {then:?}");
    let [before, after] = [first, then].map(|it| it.thickness.unwrap());
    assert!(after.flat_m < 0.8 * before.flat_m && after.upright_m < 0.9 * before.upright_m, "{before:?} {after:?}");
    let places = |log: &Log| log.known.velodyne.as_ref().unwrap().left_m.clone();
    let twice: Vec<f64> = places(&repaired).iter().map(|left_m| 2.0 * left_m).collect();
    assert_eq!(places(&corrected(&repaired, &found.lasers)), twice, "what is corrected again is corrected on top");
    let again = diagnose(&variants(), &repaired).unwrap();
    assert!(!leads(&again).effects.contains(&"laser_origin_offsets".to_owned()), "{:?}", leads(&again));
    if let Some(left) = leads(&again).parameters.get("range_bias.spread_m") {
        assert!(left.value < 0.01, "{left:?}");
    }
}

/// With its name out of the list, single angles that are off are in the right flexible block, or behave like what else does so.
#[test]
fn what_nothing_in_the_list_explains_is_the_sensors() {
    let log = log(&[planted("laser_origin_offsets", 0.0, 0.03)], 1003);
    let others: Vec<Variant> = variants().into_iter().filter(|it| it.about.name != "laser_origin_offsets").collect();
    let found = diagnose(&others, &log).unwrap();
    assert_eq!(found.diagnosis.verdict, Verdict::Unknown, "{:?}", found.diagnosis.which);
    assert_eq!(leads(&found).block.as_deref(), Some("sensor"));
}

#[test]
fn scans_that_show_nothing_are_refused() {
    let whole = log(&[], 1000);
    let refused = |log: &Log| diagnose(&variants(), log).err().unwrap();
    assert!(matches!(refused(&Log { firings: None, ..whole.clone() }), CannotSee::Follow(_)));
    assert!(matches!(refused(&whole.window(0.0..1.4)), CannotSee::Follow(_)), "it stands still");
}
