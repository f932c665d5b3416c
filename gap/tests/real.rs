//! Diagnoses as of a real robot's log: of a world noisier than the nominal one, with several things wrong at once.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use asami_dataset::log::RangeBearing;
use asami_dataset::{Command, Known, Log, Seed, Sighting, Size};
use asami_gap::answer::diagnosis::{Diagnosis, Verdict};
use asami_gap::judge::{Judge, Moment};
use asami_gap::library::{Budget, play};
use asami_gap::race::Pace;
use asami_gap::real::Search;
use asami_gap::real::crossed::Crossed;
use asami_gap::real::folds::Folds;
use asami_gap::real::kin::Kin;
use asami_gap::real::layers::{Least, layers, planted as of_layers};
use asami_gap::real::prior::Prior;
use asami_gap::shape::Numbers;
use asami_gap::view::View;
use asami_gap::{Library, Planted, Responds, Sighted, Variant, real};
use rand_distr::{Distribution, StandardNormal};

mod world;

const NAMES: [&str; 4] = ["command_scale", "height_bias", "image_delay", "vision_noise"];
const LENGTH_S: f64 = 180.0;

fn variants() -> Vec<Variant> {
    world::kinds(&NAMES)
}

fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let budget = Budget { nominal_runs: 48, runs: 6, sizes: 4, run_s: 120.0 };
        Library::learn(&quiet(), &variants(), &budget).unwrap()
    })
}

/// A robot whose bearings tell something.
fn quiet() -> world::Plain {
    let mut world = world::Plain::default();
    world.config.sight.sigma2_rad = 0.05;
    world
}

/// The same with noise of other sizes: of the motion, of heights, of bearings.
fn noisy([motion, height, bearing]: [f64; 3]) -> world::Plain {
    let mut world = quiet();
    let (of_motion, of_sight) = (&mut world.config.motion, &mut world.config.sight);
    for sd in [&mut of_motion.right_sd_m, &mut of_motion.forward_sd_m, &mut of_motion.turn_sd_rad] {
        *sd *= motion;
    }
    of_sight.sigma1_px *= height;
    of_sight.sigma2_rad *= bearing;
    world
}

fn planted(name: &str, sign: f64, size: f64) -> Planted {
    let variant = variants().into_iter().find(|it| it.about.name == name && it.sign == sign).unwrap();
    Planted { variant, size }
}

fn log(noise: [f64; 3], planted: &[Planted], seed: u64) -> Log {
    play(&noisy(noise), planted, Seed(1000 + seed), LENGTH_S).unwrap().log
}

fn named(diagnosis: &Diagnosis) -> Vec<String> {
    let mut named = diagnosis.which[0].effects.clone();
    named.sort();
    named
}

/// Noise that is another than nominally is no cause, and is found as large as it is, within what the log tells.
#[test]
fn what_is_noisier_than_its_simulator_has_no_gap() {
    for (noise, seed) in [([1.5, 1.4, 1.5], 1), ([1.0, 2.0, 0.6], 2)] {
        let log = log(noise, &[], seed);
        let diagnosis = real::diagnose(library(), &variants(), &log).unwrap();
        assert_eq!(diagnosis.verdict, Verdict::None, "{noise:?}: {:?}", diagnosis.which);
        assert!(diagnosis.smallest_visible.len() >= 3, "{:?}", diagnosis.smallest_visible);
        assert!(diagnosis.astray_s.unwrap() <= 6.0, "{noise:?}: {:?}", diagnosis.astray_s);
        let noisy = library().noisy_as(&log, |_| true, &[], None).unwrap();
        let shape = &library().base.shape;
        for (group, ratio) in [(Numbers::SizeNoise, noise[1]), (Numbers::BearingNoise, noise[2])] {
            let at = shape.range(group).start;
            let found = (noisy.base.numbers[at] - library().base.numbers[at]).exp();
            assert!((found / ratio - 1.0).abs() < 0.2, "{noise:?}: {found}, not {ratio}");
        }
        let said = diagnosis.noise.unwrap();
        assert_eq!(said.lasting_share, 0.0, "{noise:?}: white noise does not last");
        // Of motion 90 s say little.
        let [size, bearing, motion] = [said.size_ratio, said.bearing_ratio, said.motion_ratio];
        for (found, ratio, most) in [(size, noise[1], 1.25), (bearing, noise[2], 1.25), (motion, noise[0], 2.5)] {
            assert!(found < most * ratio && ratio < most * found, "{noise:?}: {said:?}");
        }
    }
}

/// What each landmark's heights are off for a while is no motion of the robot's: it is found to last, about as long as it does, and
/// no gap comes of it.
#[test]
fn what_landmarks_are_off_for_a_while_lasts() {
    let (share, fades_s): (f64, f64) = (0.8, 4.0);
    let white = log([1.0; 3], &[], 50);
    let sd_px = quiet().config.sight.sigma1_px * (share / (1.0 - share)).sqrt();
    let mut rng = Seed(50).stream("real/lasting");
    // By landmark: when it was seen last, and what it was off then.
    let mut off: BTreeMap<u16, (f64, f64)> = BTreeMap::new();
    let sightings = white.sightings.iter().map(|seen| {
        let fresh: f64 = StandardNormal.sample(&mut rng);
        let kept = off.get(&seen.landmark).map_or(0.0, |(t_s, _)| (-(seen.t_s - t_s) / fades_s).exp());
        let before = off.get(&seen.landmark).map_or(0.0, |it| it.1);
        let now = kept * before + (1.0 - kept * kept).sqrt() * fresh;
        off.insert(seen.landmark, (seen.t_s, now));
        Sighting { size: Size::HeightPx(seen.size.value() + sd_px * now), ..*seen }
    });
    let log = Log { sightings: sightings.collect::<Vec<_>>().into(), ..white.clone() };
    let diagnosis = real::diagnose(library(), &variants(), &log).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::None, "{:?}", diagnosis.which);
    let said = diagnosis.noise.unwrap();
    assert!((0.6..=0.95).contains(&said.lasting_share), "{said:?}");
    assert!((1.5..=10.0).contains(&said.fades_s), "{said:?}");
    let ratio = (1.0 / (1.0 - share)).sqrt();
    assert!((said.size_ratio / ratio - 1.0).abs() < 0.3, "{said:?}");
}

/// Three things wrong at once in a noisier world: all are named, nothing else, near their sizes; and the gap closes.
fn three_are_named(seed: u64, search: Search) {
    let wrong =
        [planted("command_scale", -1.0, 0.12), planted("image_delay", 1.0, 0.08), planted("height_bias", 1.0, 1.5)];
    let log = log([1.3, 1.3, 1.4], &wrong, seed);
    let diagnosis = real::diagnose_among(library(), &variants(), &log, &Prior::NONE, search).unwrap();
    assert_eq!(named(&diagnosis), ["command_scale", "height_bias", "image_delay"], "seed {seed}");
    assert_eq!(diagnosis.verdict, Verdict::Named, "seed {seed}");
    for (name, expected) in
        [("command_scale.y_ratio", 0.88), ("image_delay.delay_s", 0.08), ("height_bias.bias_px", 1.5)]
    {
        let Some(found) = diagnosis.which[0].parameters.get(name) else { panic!("{:?}", diagnosis.which[0]) };
        assert!((found.value / expected - 1.0).abs() < 0.15, "seed {seed}: {name} {found:?}");
    }
    let closed = diagnosis.how_far.closed.unwrap();
    assert!(closed > 0.9, "seed {seed}: {closed}");
    let sum: f64 = diagnosis.which.iter().map(|cause| cause.probability).sum();
    assert!((sum - 1.0).abs() < 0.02, "seed {seed}: {sum}");
}

#[test]
fn several_effects_are_named_one_beside_another() {
    three_are_named(10, Search::Forwards);
}

#[test]
fn several_effects_are_named_both_ways() {
    three_are_named(11, Search::BothWays);
}

/// A robot that for some time does something else than it is told has nothing wrong with it otherwise: that time is said, and put
/// on no effect.
#[test]
fn where_a_robot_does_not_do_what_it_is_told_no_effect_is_blamed() {
    let log = log([1.0; 3], &[], 40);
    let overruled = |t_s: f64| (95.0..110.0).contains(&t_s);
    let told = log.commands.iter().map(|command| {
        let later = log.commands.iter().find(|it| it.t_s > command.t_s + 37.0);
        let action = later.filter(|_| overruled(command.t_s)).map_or(command.action, |it| it.action);
        Command { action, ..*command }
    });
    let log = Log { commands: told.collect::<Vec<_>>().into(), ..log };
    let diagnosis = real::diagnose(library(), &variants(), &log).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::None, "{:?}", diagnosis.which);
    let astray_s = diagnosis.astray_s.unwrap();
    // Fifteen seconds, what led to them, and until it is found again.
    assert!((9.0..=36.0).contains(&astray_s), "{astray_s}");
}

/// What nothing in the list explains is *unknown*, and its block is where it acts; not *none*.
#[test]
fn a_gap_that_no_effect_explains_is_unknown() {
    let listed: Vec<Variant> = variants().into_iter().filter(|it| it.about.name == "command_scale").collect();
    let log = log([1.0; 3], &[planted("height_bias", 1.0, 3.0)], 15);
    let diagnosis = real::diagnose(library(), &listed, &log).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::Unknown, "{:?}", diagnosis.which);
    assert_eq!(diagnosis.which[0].effects, ["unknown"]);
    assert!(matches!(diagnosis.which[0].block.as_deref(), Some("sensor" | "all")), "{:?}", diagnosis.which[0]);
    assert!(diagnosis.which.iter().all(|cause| cause.place.is_none() || cause.effects[0] == "command_scale"));
}

/// Sightings of these blocks of 20 s, twice as far off in height as they were; of the first, the third and so on.
fn noisier_by_turns(log: &Log) -> Log {
    let mut rng = Seed(20).stream("real/by_turns");
    let sd_px = 3.0_f64.sqrt() * quiet().config.sight.sigma1_px;
    let sightings = log.sightings.iter().map(|seen| {
        let off: f64 = StandardNormal.sample(&mut rng);
        let more_px = if Folds::default().of(seen.t_s) == 0 { sd_px * off } else { 0.0 };
        Sighting { size: Size::HeightPx(seen.size.value() + more_px), ..*seen }
    });
    Log { sightings: sightings.collect::<Vec<_>>().into(), ..log.clone() }
}

/// Noise is of the blocks that it is not held against.
#[test]
fn noise_is_learned_where_nothing_is_diagnosed_with_it() {
    let log = noisier_by_turns(&log([1.0; 3], &[], 20));
    let folds = Folds::default();
    let of_others = |fold: usize| library().noisy_as(&log, |t_s| folds.of(t_s) != fold, &[], None).unwrap();
    let noisy: Vec<Library> = (0..folds.count).map(of_others).collect();
    let at = library().base.shape.range(Numbers::SizeNoise).start;
    let ratio = |fold: usize| (noisy[fold].base.numbers[at] - library().base.numbers[at]).exp();
    assert!((ratio(0) - 1.0).abs() < 0.2 && (ratio(1) - 2.0).abs() < 0.4, "{} {}", ratio(0), ratio(1));
    // Each block's terms are those under its own noise.
    let crossed = Crossed::new(&log, &noisy, folds, &[]).unwrap();
    let (numbers, terms) = (crossed.numbers(&[]), crossed.terms(&crossed.numbers(&[])));
    for (fold, library) in noisy.iter().enumerate() {
        let alone = Sighted::scoring(&log, library, &[], |_| true).unwrap();
        let of_alone = alone.terms(&alone.numbers(&[]));
        // By each noise the robot may be known to be somewhere from another step on.
        let of_fold = |steps: &[Moment], terms: &[f64]| -> Vec<(Moment, f64)> {
            let all = steps.iter().copied().zip(terms.iter().copied());
            all.filter(|(step, _)| folds.of(step.t_s) == fold).collect()
        };
        let (of_alone, of_crossed) = (of_fold(alone.steps(), &of_alone), of_fold(crossed.steps(), &terms));
        assert!(of_alone.len() > 1000, "{}", of_alone.len());
        assert!(of_alone == of_crossed, "fold {fold}: {} and {} steps", of_alone.len(), of_crossed.len());
    }
    let reading = crossed.read(&numbers);
    assert_eq!(reading.log_likelihoods, terms);
    let total = crossed.beside(&numbers, &Pace::of(&reading));
    assert!((total - reading.total()).abs() < 1e-6, "{total} {}", reading.total());
}

/// Noise may be another at each distance: whatever size takes a robot a little nearer to landmarks, a log is a little likelier or less
/// likely for it. Were noise that of a band of distances, each landmark that goes from one into another would be a step.
#[test]
fn a_real_logs_likelihood_has_no_steps() {
    let log = log([1.0; 3], &[planted("command_scale", 1.0, 0.02)], 33);
    let judge = Sighted::scoring(&log, library(), &[], |_| true).unwrap();
    let shape = &library().base.shape;
    let likely = |k: u32| {
        let mut numbers = library().numbers(&[planted("command_scale", 1.0, 0.02 + 1e-5 * f64::from(k))]);
        for (i, more) in shape.range(Numbers::SizeNoise).zip([-0.5, 0.0, 0.5]) {
            numbers[i] += more;
        }
        judge.terms(&numbers).iter().sum::<f64>()
    };
    let at: Vec<f64> = (0..=300).map(likely).collect();
    // A hundredth of a nat is where what a sighting tells is taken to be linear.
    let most = at.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert!(most < 0.03, "{most}");
}

/// With one noise for all folds they are one log, whatever is in the world.
#[test]
fn folds_of_one_noise_are_one_log() {
    let planted = [planted("command_scale", -1.0, 0.1)];
    let log = log([1.0; 3], &planted, 21);
    let two = [library().clone(), library().clone()];
    let crossed = Crossed::new(&log, &two, Folds::default(), &[]).unwrap();
    let whole = Sighted::scoring(&log, library(), &[], |_| true).unwrap();
    assert_eq!(crossed.steps(), whole.steps());
    for planted in [&[][..], &planted] {
        let numbers = whole.numbers(planted);
        assert_eq!(crossed.numbers(planted), numbers);
        let (a, b) = (crossed.read(&numbers), whole.read(&numbers));
        assert_eq!((&a.log_likelihoods, &a.expected), (&b.log_likelihoods, &b.expected));
        assert_eq!((a.observations, a.innovations.len()), (b.observations, b.innovations.len()));
        assert_eq!(crossed.terms(&numbers), b.log_likelihoods);
        // Who falls behind in one fold is out there, as it would be in the whole log.
        let (pace, nominal) = (Pace::of(&b), whole.numbers(&[]));
        let beside = crossed.beside(&nominal, &pace) - whole.terms(&nominal).iter().sum::<f64>();
        assert!(beside.abs() < 1e-6 || crossed.beside(&nominal, &pace) < pace.total() - 60.0, "{beside}");
    }
    assert_eq!(crossed.regimes(), whole.regimes());
    let least = Least { nats: 10.0, share: 0.0, share_together: 0.0, late_once: true, kin: Kin::NONE };
    let found = layers(&crossed, &variants(), &least);
    assert_eq!(of_layers(&found).len(), 1, "{found:?}");
}

/// A log with more landmarks than the nominal world has says nothing of the others' places, and breaks nothing.
#[test]
fn a_log_may_have_more_landmarks_than_the_nominal_world() {
    let mut crowded = quiet();
    let mut more = crowded.field.beacons[0].clone();
    for id in 10..14 {
        more.id = id;
        more.body.x_m = 0.4 * f64::from(id) - 5.0;
        crowded.field.beacons.push(more.clone());
    }
    let log = play(&crowded, &[], Seed(1030), LENGTH_S).unwrap().log;
    let judge = library().judge(&log).unwrap();
    assert!(judge.log_likelihood(&[]).is_finite());
    assert!(judge.log_likelihood(&[planted("image_delay", 1.0, 0.05)]).is_finite());
}

/// Distances and bearings are from where the log says that the sensor sits, however the robot is turned.
#[test]
fn a_sensor_off_the_centre_sees_from_where_it_is() {
    let log = log([1.0; 3], &[], 31);
    let range_bearing = Some(RangeBearing { max_range_m: 20.0, sensor_origin_m: [0.1, 0.3] });
    let known = Known { range_bearing, ..(*log.known).clone() };
    let view = View::new(&Log { known: known.into(), ..log }, &library().base.shape.columns).unwrap();
    for theta_rad in [0.0, 1.0, -2.5_f64] {
        let (sin, cos) = theta_rad.sin_cos();
        let from = [0.2 + 0.1 * cos - 0.3 * sin, -0.4 + 0.1 * sin + 0.3 * cos];
        let sight = view.sight(0, 2, [0.2, -0.4, theta_rad], [0.0; 2]);
        let [dx, dy] = [0, 1].map(|k| view.landmarks[2][k] - from[k]);
        assert!((sight.distance_m - dx.hypot(dy)).abs() < 1e-12);
        let bearing_rad = (-dx).atan2(dy) - theta_rad;
        assert!(((sight.bearing_rad - bearing_rad) / std::f64::consts::TAU).fract().abs() < 1e-12);
        // How its place changes with the heading.
        let h = 1e-6;
        let [less, more] = [-h, h].map(|h| view.out(theta_rad + h).0);
        let swung = view.out(theta_rad).1;
        assert!((0..2).all(|k| ((more[k] - less[k]) / (2.0 * h) - swung[k]).abs() < 1e-8));
    }
}

/// Of a robot on a rail somebody puts bearings in. They say nothing, however exact a response takes them to be.
#[test]
fn bearings_that_were_not_measured_say_nothing() {
    let measured = log([1.0; 3], &[], 0);
    let put_in = measured.sightings.iter().map(|seen| Sighting { bearing_rad: 0.0, ..*seen });
    let put_in = Log { sightings: put_in.collect::<Vec<_>>().into(), ..measured.clone() };
    let said = |log: &Log, louder: f64| {
        let judge = library().judge(log).unwrap();
        let mut numbers = judge.numbers(&[]);
        library().base.shape.range(Numbers::BearingNoise).for_each(|i| numbers[i] += louder);
        judge.read(&numbers)
    };
    assert_eq!(said(&put_in, 0.0), said(&put_in, 2.0));
    assert_ne!(said(&measured, 0.0).log_likelihoods, said(&measured, 2.0).log_likelihoods);
    let of_bearings = |it: &&asami_gap::judge::Innovation| it.channel == 1;
    assert!(said(&put_in, 0.0).innovations.iter().filter(of_bearings).all(|it| it.white == 0.0));
    // No eye read them, however it is turned.
    let turned = |log: &Log| {
        let judge = library().judge(log).unwrap();
        let mut numbers = judge.numbers(&[]);
        numbers[library().base.shape.range(Numbers::Bearing).start] += 0.1;
        judge.read(&numbers)
    };
    assert_eq!(said(&put_in, 0.0), turned(&put_in));
    assert_ne!(said(&measured, 0.0).log_likelihoods, turned(&measured).log_likelihoods);
}
