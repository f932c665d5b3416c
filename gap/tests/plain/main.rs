//! Diagnoses of the plain robot, whose truth is known exactly.

use std::sync::OnceLock;

use asami_dataset::{Channel, Log, Seed, Sighting, Size};
use asami_gap::answer::experiment::{Course, best, promise};
use asami_gap::answer::how_far::misfit;
use asami_gap::blocks;
use asami_gap::library::{Budget, play};
use asami_gap::race::Pace;
use asami_gap::shape::Numbers;
use asami_gap::touch::Touch;
use asami_gap::weigh::evidence::{CLOSE, Weighed, weigh};
use asami_gap::{Calibration, Diagnoser, Library, Planted, Responds, Variant};

mod sizes;
mod swaying;
#[path = "../world/mod.rs"]
mod world;

const NAMES: [&str; 6] =
    ["command_scale", "false_sightings", "height_bias", "image_delay", "missed_sightings", "vision_noise"];

fn variants() -> Vec<Variant> {
    world::kinds(&NAMES)
}

fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let budget = Budget { nominal_runs: 64, runs: 6, sizes: 4, run_s: 120.0 };
        Library::learn(&world::Plain::default(), &variants(), &budget).unwrap()
    })
}

fn planted(name: &str, sign: f64, size: f64) -> Planted {
    let variant = variants().into_iter().find(|it| it.about.name == name && it.sign == sign).unwrap();
    Planted { variant, size }
}

fn log(planted: &[Planted], seed: u64) -> Log {
    play(&world::Plain::default(), planted, Seed(1000 + seed), 120.0).unwrap().log
}

/// A library that one thread learned is, to the bit, the one that several learned, and so is what it makes of a log.
#[test]
fn one_thread_learns_what_several_learn() {
    let kinds = world::kinds(&["image_delay", "vision_noise"]);
    let budget = Budget { nominal_runs: 16, runs: 2, sizes: 3, run_s: 120.0 };
    let log = log(&[planted("image_delay", 1.0, 0.1)], 5);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let library = Library::learn(&world::Plain::default(), &kinds, &budget).unwrap();
            let calibration = Calibration::default();
            let diagnoser = Diagnoser { library: &library, calibration: &calibration, variants: &kinds, courses: &() };
            (serde_json::to_string(&diagnoser.diagnose(&log).unwrap()).unwrap(), library)
        })
    };
    let [alone, several] = [1, 3].map(on);
    assert!(alone == several, "{}\n{}", alone.0, several.0);
}

/// `-log p(o_t | past) - h_t` is a martingale difference in the world that made the log, of variance 1 a sighting for
/// its two squares (chi-squared with 2 degrees of freedom, halved).
#[test]
fn nominal_logs_fit_the_nominal_world() {
    for seed in 0..6 {
        let log = log(&[], seed);
        let judge = library().judge(&log).unwrap();
        let reading = judge.read(&judge.numbers(&[]));
        let n = reading.observations as f64;
        assert!(n > 500.0);
        let off = misfit(&reading) * n.sqrt();
        assert!(off.abs() < 4.0, "seed {seed}: {off} standard errors");
        let of = |k: usize| reading.innovations.iter().filter(move |it| it.channel == k);
        let squares = |k: usize| of(k).map(|it| it.white * it.white).sum::<f64>();
        for k in 0..2 {
            assert!((squares(k) - n).abs() < 4.5 * (2.0 * n).sqrt(), "seed {seed}: {} of {n}", squares(k));
        }
    }
}

/// A robot that has seen one landmark only may be anywhere around it: its start is sought by what it sees later.
#[test]
fn nobody_is_lost_who_sees_only_one_landmark_for_long() {
    for seed in 0..12 {
        let mut log = log(&[], seed);
        let first = log.sightings.iter().next().expect("one").landmark;
        let mut sightings = log.sightings.to_vec();
        sightings.retain(|it| it.landmark == first || it.t_s > 25.0);
        (log.sightings, log.frames) = (sightings.into(), None);
        let judge = library().judge(&log).unwrap();
        let reading = judge.read(&judge.numbers(&[]));
        let n = reading.observations as f64;
        let squares = reading.innovations.iter().map(|it| it.white * it.white).sum::<f64>();
        assert!((squares - 2.0 * n).abs() < 4.5 * (4.0 * n).sqrt(), "seed {seed}: {squares} of {}", 2.0 * n);
    }
}

/// An effect may lead the nominal filter so far astray that it says nothing of where landmarks should be: to see, or miss, them
/// costs the true cause no more than elsewhere.
#[test]
fn a_robot_that_is_lost_nominally_is_not_lost_under_the_truth() {
    let truth = [planted("height_bias", -1.0, 3.0)];
    for seed in 0..24 {
        let with = log(&truth, 300 + seed);
        let without = Log { frames: None, ..with.clone() };
        let [with, without] = [with, without].map(|log| library().judge(&log).unwrap().log_likelihood(&truth));
        assert!(with - without > -400.0, "seed {seed}: {with} with what was missed, {without} without");
    }
}

#[test]
fn no_effect_is_evident_in_nominal_logs() {
    for seed in 0..6 {
        let log = log(&[], seed);
        let judge = library().judge(&log).unwrap();
        for weighed in weigh(&*judge, &variants(), &[], CLOSE) {
            // Where an effect is absent, evidence of e^9 has probability e^-9 at most (Markov): of the 36 looked at, one
            // reaches it in 220 such tests.
            assert!(weighed.evidence_nats < 9.0, "seed {seed}: {weighed:?}");
        }
        for block in blocks::fit(&*judge, &judge.numbers(&[]), &|_| true) {
            assert!(block.evidence_nats < 9.0, "seed {seed}: {} {}", block.block, block.evidence_nats);
        }
    }
}

#[test]
fn a_planted_effect_is_the_most_evident_and_its_size_lies_in_the_interval_or_near() {
    let cases = [
        ("command_scale", -1.0, 0.1),
        ("height_bias", 1.0, 0.8),
        ("image_delay", 1.0, 0.08),
        ("vision_noise", 1.0, 0.4),
    ];
    for (name, sign, size) in cases {
        let log = log(&[planted(name, sign, size)], 50);
        let judge = library().judge(&log).unwrap();
        let best = weigh(&*judge, &variants(), &[], CLOSE)
            .into_iter()
            .reduce(|a, b| if b.evidence_nats > a.evidence_nats { b } else { a })
            .unwrap();
        assert_eq!(best.effect, name);
        assert_eq!(best.best.variant.sign, sign);
        let [low, high] = best.interval;
        let width = high - low;
        assert!(low - width < size && size < high + width, "{name}: {size} in {low}..{high}");
        assert!(best.evidence_nats > 10.0 && best.evidence_nats < best.gain_nats, "{best:?}");
    }
}

/// Under the same seed a robot goes the same way, bit for bit, whatever is wrong with its camera or the landmarks: what a
/// library takes out of these effects' changes is nothing that they do.
#[test]
fn what_acts_on_sensing_leaves_the_way_as_it_is() {
    let way = |planted: &[Planted]| play(&world::Plain::default(), planted, Seed(1060), 20.0).unwrap().truth.track;
    let nominal = way(&[]);
    let mut motions = 0;
    for variant in Variant::all("plain", 4, &[]) {
        let touch = Touch::of(&variant);
        let size = variant.sizes().1;
        let changed = way(&[Planted { variant: variant.clone(), size }]) != nominal;
        assert_eq!(changed, touch == Touch::Motion, "{}", variant.name());
        motions += usize::from(changed);
    }
    assert!(motions > 4, "{motions} change the way");
}

/// Whatever is taken for a landmark that is far outside of the image bends no curve there: an effect of motion, of timing or of
/// the lens by which it would come into view gains next to nothing beside the truth. The share is found within three times the
/// scatter of so many events.
#[test]
fn many_false_sightings_speak_for_nothing_besides() {
    let share = 0.08;
    let truth = planted("false_sightings", 1.0, share);
    let names = ["image_delay", "slope", "landmark_moved", "lens_distortion"];
    let others: Vec<Variant> = variants().into_iter().filter(|it| names.contains(&it.about.name)).collect();
    for seed in 100..104 {
        let log = log(std::slice::from_ref(&truth), seed);
        let events = share * log.frames.as_ref().map_or(0, |frames| frames.len()) as f64;
        let judge = library().judge(&log).unwrap();
        for beside in weigh(&*judge, &others, std::slice::from_ref(&truth), CLOSE) {
            assert!(beside.gain_nats < 10.0, "seed {seed}: {beside:?}");
        }
        let found = weigh(&*judge, std::slice::from_ref(&truth.variant), &[], CLOSE).remove(0).best.size;
        assert!((found / share).ln().abs() < 3.0 / events.sqrt(), "seed {seed}: {found}");
    }
}

/// An effect of one direction shows in its block nearly as clearly as by its name: what no direction asks for is not paid.
#[test]
fn a_block_pays_for_the_directions_that_it_needs() {
    for seed in 200..206 {
        let truth = planted("height_bias", 1.0, 0.3);
        let log = log(std::slice::from_ref(&truth), seed);
        let judge = library().judge(&log).unwrap();
        let named = weigh(&*judge, std::slice::from_ref(&truth.variant), &[], CLOSE).remove(0).evidence_nats;
        let blocks = blocks::fit(&*judge, &judge.numbers(&[]), &|_| true);
        let sensor = blocks.iter().find(|it| it.block == "sensor").expect("tried").evidence_nats;
        // One kind of subset in four and one direction of a dozen cost 4 nats, and a prior that is wider than that of the size
        // as many; all directions together would cost 58.
        assert!(sensor > named - 12.0 && sensor < named + 4.0, "seed {seed}: {named} {sensor}");
    }
}

/// Whoever hears only a part of what a filter finds hears the same: steps' log-likelihoods; their sum, as far as it is
/// within 60 nats of another response's; and of what is out only that it is far behind.
#[test]
fn a_log_says_the_same_in_few_words_as_in_many() {
    let effects = [planted("image_delay", 1.0, 0.05)];
    let log = log(&effects, 7);
    let judge = library().judge(&log).unwrap();
    let nominal = judge.read(&judge.numbers(&[]));
    let pace = Pace::of(&nominal);
    assert!((pace.total() - nominal.total()).abs() < 1e-9);
    for (name, sign, size) in [("image_delay", 1.0, 0.05), ("height_bias", 1.0, 0.1), ("vision_noise", 1.0, 0.05)] {
        let numbers = judge.numbers(&[planted(name, sign, size)]);
        let whole = judge.read(&numbers);
        assert_eq!(judge.terms(&numbers), whole.log_likelihoods, "{name}");
        assert!((judge.beside(&numbers, &pace) - whole.total()).abs() < 1e-9, "{name}");
    }
    let absurd = judge.numbers(&[planted("height_bias", 1.0, 20.0)]);
    let (found, whole) = (judge.beside(&absurd, &pace), judge.read(&absurd).total());
    assert!(whole < pace.total() - 1000.0 && found < pace.total() - 60.0, "{found} {whole} {}", pace.total());
}

#[test]
fn a_diagnosis_says_where_which_and_how_far_and_says_it_twice_alike() {
    let (calibration, variants) = (Calibration::default(), variants());
    let diagnoser = Diagnoser { library: library(), calibration: &calibration, variants: &variants, courses: &() };
    let log = log(&[planted("height_bias", 1.0, 1.5)], 51);
    let diagnosis = diagnoser.diagnose(&log).unwrap();
    assert_eq!(diagnosis.which[0].effects, ["height_bias"], "{diagnosis:?}");
    assert_eq!(diagnosis.places[0].channel, "height_px");
    let closed = diagnosis.how_far.closed.unwrap();
    assert!((0.8..1.1).contains(&closed), "{closed}");
    assert!(diagnosis.how_far.misfit_before > 4.0 * diagnosis.how_far.misfit_after.abs());
    let rms = diagnosis.how_far.channels["height_px"];
    assert!(rms.rms_after < rms.rms_before);
    let value = diagnosis.which[0].parameters["height_bias.bias_px"];
    assert!((value.value - 1.5).abs() < 0.2, "{value:?}");
    assert_eq!(diagnoser.diagnose(&log).unwrap(), diagnosis);
    let text = serde_json::to_string(&diagnosis).unwrap();
    assert_eq!(serde_json::from_str::<asami_gap::Diagnosis>(&text).unwrap(), diagnosis);
}

#[test]
fn without_a_gap_nothing_is_named_and_what_would_have_shown_is_said() {
    let (calibration, variants) = (Calibration::default(), variants());
    let diagnoser = Diagnoser { library: library(), calibration: &calibration, variants: &variants, courses: &() };
    let diagnosis = diagnoser.diagnose(&log(&[], 52)).unwrap();
    assert_eq!(diagnosis.verdict, asami_gap::answer::diagnosis::Verdict::None);
    assert!(diagnosis.places.is_empty());
    // A bias shows in the mean of n heights of standard deviation 1 px: n b^2 / 2 = 12 nats, a little later where the
    // pose must be found from the same heights.
    let n = log(&[], 52).sightings.len() as f64;
    let visible = diagnosis.smallest_visible["height_bias.bias_px"];
    let alone = (24.0 / n).sqrt();
    assert!(visible > alone && visible < 5.0 * alone, "{visible} against {alone}");
}

#[test]
fn logs_that_show_nothing_are_refused_and_odd_ones_survived() {
    let (calibration, variants) = (Calibration::default(), variants());
    let diagnoser = Diagnoser { library: library(), calibration: &calibration, variants: &variants, courses: &() };
    let whole = log(&[], 53);
    let blind = Log { sightings: Channel::default(), ..whole.clone() };
    let short = whole.window(0.0..0.5);
    for (log, needs) in [(Log::default(), "0 frames"), (blind, "0 of them"), (short, "at least")] {
        let error = diagnoser.diagnose(&log).unwrap_err().to_string();
        assert!(error.contains(needs), "{error}");
    }
    let unmoved = Log { commands: Channel::default(), ..whole.clone() };
    let mut frames = whole.frames.clone().unwrap().to_vec();
    let mut sightings = whole.sightings.to_vec();
    frames.iter_mut().filter(|it| it.t_s > 60.0).for_each(|it| it.t_s += 600.0);
    sightings.iter_mut().filter(|it| it.t_s > 60.0).for_each(|it| it.t_s += 600.0);
    let torn = Log { frames: Some(frames.into()), sightings: sightings.into(), ..whole.clone() };
    let missless = Log { frames: None, ..whole };
    for log in [unmoved, torn, missless] {
        let diagnosis = diagnoser.diagnose(&log).unwrap();
        let sum: f64 = diagnosis.which.iter().map(|it| it.probability).sum();
        assert!(sum > 0.99 && sum < 1.0 + 1e-9, "{sum}");
    }
}

/// A wrong place to start from costs thousands of nats: the robot is then thought to be elsewhere for the rest of the log.
#[test]
fn a_log_that_begins_with_false_sightings_is_about_as_likely_as_with_the_true_ones() {
    for seed in 20..26 {
        let log = log(&[], seed);
        let mut sightings = log.sightings.to_vec();
        let other = |landmark: u16| (landmark + 2) % 4;
        let mistaken = |seen: &Sighting| Sighting {
            landmark: other(seen.landmark),
            size: Size::HeightPx(0.5 * seen.size.value()),
            ..*seen
        };
        let likely = |sightings: &[Sighting]| {
            let log = Log { sightings: sightings.to_vec().into(), ..log.clone() };
            library().judge(&log).unwrap().log_likelihood(&[])
        };
        let as_it_was = likely(&sightings);
        for seen in &mut sightings[..3] {
            *seen = mistaken(seen);
        }
        // They are not scored; what starts a little later has settled a little less.
        let lost = as_it_was - likely(&sightings);
        assert!(lost.abs() < 15.0, "seed {seed}: {lost} nats");
    }
}

/// What is in the image is seen as often, whatever else is taken for a landmark now and then.
#[test]
fn false_sightings_change_neither_curves_nor_what_is_seen_of_landmarks_in_the_image() {
    let library = library();
    let shape = &library.base.shape;
    let (without, with) = (library.numbers(&[]), library.numbers(&[planted("false_sightings", 1.0, 0.1)]));
    let change = |group: Numbers| shape.range(group).map(|i| with[i] - without[i]).collect::<Vec<_>>();
    for group in [Numbers::Motion, Numbers::MotionNoise, Numbers::Size, Numbers::Bearing] {
        assert!(change(group).iter().all(|it| *it == 0.0), "{group:?}");
    }
    // Of eight bins of the angle off the centre six lie well within the image: there the landmark itself, or an impostor, is
    // reported.
    for of_distance in change(Numbers::Detection).chunks(8) {
        assert!(of_distance[..6].iter().all(|it| it.abs() < 0.5), "{of_distance:?}");
    }
    // A tenth of the frames, in which else six landmarks in ten frames are seen.
    let share = 1.0 / (1.0 + (-with[shape.range(Numbers::False).start]).exp());
    let log = log(&[planted("false_sightings", 1.0, 0.1)], 30);
    let expected = 0.1 * log.frames.as_ref().unwrap().len() as f64 / log.sightings.len() as f64;
    assert!((share / expected - 1.0).abs() < 0.25, "{share} of sightings, {expected} expected");
}

/// By how many nats logs of a course part two effects, whichever of them it is: as promised, and as it comes out.
fn parted(hold_s: f64, tied: &[Weighed; 2]) -> (Course, f64, f64) {
    let mut driven = world::Plain::default();
    driven.exploring.hold_s = hold_s;
    let played = |planted: &[Planted], seed: u64| play(&driven, planted, Seed(2000 + seed), 120.0).unwrap().log;
    let course = Course { words: format!("held for {hold_s} s"), keys: String::new(), logs: vec![played(&[], 100)] };
    let judge = library().judge(&course.logs[0]).unwrap();
    let promised = promise(&*judge, &tied.each_ref().map(|it| (it, 0.5))).leading_nats;
    let found = |truth: &Weighed, other: &Weighed| {
        let of = |seed: u64| {
            let judge = library().judge(&played(std::slice::from_ref(&truth.best), seed)).unwrap();
            let rival = weigh(&*judge, std::slice::from_ref(&other.best.variant), &[], CLOSE).remove(0);
            let gain = judge.log_likelihood(std::slice::from_ref(&truth.best)) - judge.log_likelihood(&[]);
            gain - rival.gain_nats.max(0.0)
        };
        (0..LOGS).map(of).sum::<f64>() / LOGS as f64
    };
    let [a, b] = tied;
    (course, promised, found(a, b).min(found(b, a)))
}

/// So many logs of each.
const LOGS: u64 = 10;

#[test]
fn the_course_that_promises_most_keeps_its_promise() {
    let late = planted("image_delay", 1.0, 0.04);
    let of = |planted: &Planted| Weighed {
        effect: planted.variant.about.name,
        evidence_nats: 10.0,
        best: planted.clone(),
        gain_nats: 12.0,
        interval: [planted.size; 2],
    };
    let (weighed, rival) = (of(&late), of(&planted("command_scale", -1.0, 0.05)));
    let both = [weighed, rival];
    let [own, short] = [5.0, 0.5].map(|hold_s| parted(hold_s, &both));
    for (course, promised, found) in [&own, &short] {
        // A log-likelihood ratio of mean J has variance 2 J; promises hold to second order.
        let room = 4.0 * (2.0 * promised / LOGS as f64).sqrt() + 0.3 * promised;
        assert!((found - promised).abs() < room, "{}: {promised} promised, {found} found", course.words);
    }
    let tied = both.each_ref().map(|it| (it, 0.5));
    // What parts them is how far the robot moves between turns: after short holds long ones are advised, after long ones
    // nothing.
    let courses = [own.0.clone(), short.0.clone()];
    let chosen = |after: &Course| {
        let judge = library().judge(&after.logs[0]).unwrap();
        best(library(), &courses, promise(&*judge, &tied), &tied).map(|(course, _)| course.words.clone())
    };
    assert!(own.1 > 2.0 * short.1, "{} {}", own.1, short.1);
    assert_eq!((chosen(&short.0), chosen(&own.0)), (Some(own.0.words.clone()), None));
}
