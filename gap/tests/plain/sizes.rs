//! Whether effects are found as large as they are.

use asami_dataset::Seed;
use asami_gap::answer::how_far::misfit;
use asami_gap::library::{Budget, Entry, play};
use asami_gap::weigh::evidence::{CLOSE, weigh};
use asami_gap::{Library, Planted, Responds, Variant};

use super::{library, log, planted, world};

/// Where a single landmark stands is where a robot believes itself to be from it: nothing speaks for another place, however far, and
/// the log fits the nominal world.
#[test]
fn a_single_landmark_that_stands_elsewhere_leaves_no_trace() {
    let mut world = world::Plain::default();
    world.field.beacons.truncate(1);
    let kinds: Vec<Variant> =
        Variant::all("plain", 1, &[]).into_iter().filter(|it| it.about.name == "landmark_moved").collect();
    let budget = Budget { nominal_runs: 16, runs: 3, sizes: 3, run_s: 120.0 };
    let library = Library::learn(&world, &kinds, &budget).unwrap();
    for seed in 0..4 {
        for size in [0.0, 0.8] {
            let moved = Planted { variant: kinds[0].clone(), size };
            let planted = if size > 0.0 { vec![moved] } else { Vec::new() };
            let log = play(&world, &planted, Seed(1000 + seed), 120.0).unwrap().log;
            let judge = library.judge(&log).unwrap();
            let reading = judge.read(&judge.numbers(&[]));
            let off = misfit(&reading) * (reading.observations as f64).sqrt();
            assert!(off.abs() < 4.0, "seed {seed}, {size} m: {off} standard errors");
            let found = weigh(&*judge, &kinds, &[], CLOSE).remove(0);
            assert!(found.evidence_nats.abs() < 1e-9, "seed {seed}, {size} m: {found:?}");
        }
    }
}

/// Halfway between two sizes that were played, by ratio, where a straight line in the logarithm would be off by a tenth;
/// over logs, sizes scatter about the truth, and their mean by the less.
#[test]
fn shares_and_noise_between_sizes_that_were_played_are_found_on_average() {
    for name in ["false_sightings", "missed_sightings", "vision_noise"] {
        let variant = planted(name, 1.0, 1.0).variant;
        let (least, greatest) = variant.sizes();
        let size = (greatest / least).powf(5.0 / 6.0) * least;
        let off = |seed: u64| {
            let judge = library().judge(&log(&[planted(name, 1.0, size)], 70 + seed)).unwrap();
            (weigh(&*judge, std::slice::from_ref(&variant), &[], CLOSE).remove(0).best.size / size).ln()
        };
        let offs: Vec<f64> = (0..16).map(off).collect();
        let mean = offs.iter().sum::<f64>() / 16.0;
        let sd = (offs.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / 15.0).sqrt();
        // Three standard errors of the logs, and as much of a library that has 6 runs at each size.
        assert!(mean.abs() < 3.0 * sd * (1.0 / 16.0 + 1.0 / 6.0_f64).sqrt(), "{name}: {mean} of {sd}");
    }
}

/// A robot knows worse than the truth how far off the image's middle it sees a landmark: a lens' effect that is learned from the
/// truth alone appears a fifth smaller than it is.
#[test]
fn a_lens_is_found_as_large_as_it_is() {
    let all = Variant::all("plain", 4, &[]);
    let variant = all.into_iter().find(|it| it.about.name == "lens_distortion" && it.sign > 0.0).unwrap();
    let (runs, logs) = (8, 32);
    let budget = Budget { nominal_runs: 0, runs, sizes: 4, run_s: 120.0 };
    let entry = Entry::learn(&world::Plain::default(), &library().base, &variant, &budget).unwrap();
    let library = Library { entries: vec![entry], ..library().clone() };
    let (least, greatest) = variant.sizes();
    let size = (greatest / least).powf(0.75) * least;
    let off = |seed: u64| {
        let log = log(&[Planted { variant: variant.clone(), size }], 400 + seed);
        let judge = library.judge(&log).unwrap();
        (weigh(&*judge, std::slice::from_ref(&variant), &[], CLOSE).remove(0).best.size / size).ln()
    };
    let offs: Vec<f64> = (0..logs).map(off).collect();
    let (runs, logs) = (runs as f64, logs as f64);
    let mean = offs.iter().sum::<f64>() / logs;
    let sd = (offs.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / (logs - 1.0)).sqrt();
    assert!(mean.abs() < 3.0 * sd * (1.0 / logs + 1.0 / runs).sqrt(), "{mean} of {sd}");
}
