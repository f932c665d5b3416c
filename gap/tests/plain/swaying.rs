//! Bearings that sway as the robot steps, and as it steps backward otherwise.

use std::f64::consts::TAU;

use asami_dataset::{Command, Dataset, Frame, Log, Seed, Sighting};
use asami_gap::library::{Base, play};
use asami_gap::memory::{PACES, Sway, pace};
use asami_gap::view::View;
use asami_gap::{Library, Responds};
use asami_math::elementary::{exp, sin_cos};
use rand_distr::{Distribution, StandardNormal};

use crate::world::Plain;

/// Standard deviations of what bearings err by, and of the sway.
const WHITE_RAD: f64 = 0.03;
const SWAY_RAD: f64 = 0.08;
const FRAME_S: f64 = 0.05;
const RUN_S: f64 = 120.0;

/// The sway at a pace, fading to 1/e in two seconds.
fn of_steps(pace: usize) -> Sway {
    let hz = if backward(pace) { 4.0 } else { 2.5 };
    let (fades, turn_rad) = (exp(-FRAME_S / 2.0), TAU * hz * FRAME_S);
    let var = WHITE_RAD * WHITE_RAD + SWAY_RAD * SWAY_RAD;
    let on = [2.0 * fades * sin_cos(turn_rad).1, -fades * fades];
    Sway { share: SWAY_RAD * SWAY_RAD / var, on, scale: var.sqrt() / WHITE_RAD }
}

fn backward(pace: usize) -> bool {
    2 * pace > PACES
}

/// A run of a robot that sees well, as it was.
fn steady(seed: u64) -> Dataset {
    let mut world = Plain::default();
    world.config.sight.sigma2_rad = WHITE_RAD;
    play(&world, &[], Seed(2000 + seed), RUN_S).unwrap()
}

/// The same with a sway in its bearings.
fn swayed(mut run: Dataset, base: &Base, seed: u64) -> Dataset {
    let view = View::new(&run.log, &base.shape.columns).unwrap();
    let mut rng = Seed(seed).stream("swaying/test");
    let mut sway = [0.0; 2];
    let mut sightings = run.log.sightings.to_vec();
    for step in &view.steps {
        let of = of_steps(pace(step.attempt));
        let fresh: f64 = StandardNormal.sample(&mut rng);
        sway = [of.on[0] * sway[0] + of.on[1] * sway[1] + of.fresh_var().sqrt() * fresh, sway[0]];
        for seen in sightings.iter_mut().filter(|seen| (seen.t_s - step.t_s).abs() < 1e-6) {
            *seen = Sighting { bearing_rad: seen.bearing_rad + SWAY_RAD * sway[0], ..*seen };
        }
    }
    run.log.sightings = sightings.into();
    run
}

fn nats(base: &Base, logs: &[Dataset]) -> f64 {
    let alone = Library::new(base.clone(), Vec::new());
    let of = |run: &Dataset| alone.judge(&run.log).unwrap().log_likelihood(&[]);
    logs.iter().map(of).sum::<f64>() / logs.len() as f64
}

/// How often a second it sways.
fn hz(sway: &Sway) -> f64 {
    (0.5 * sway.on[0] / (-sway.on[1]).sqrt()).acos() / (TAU * FRAME_S)
}

/// Other logs are as likely with the sways that were found as with those that were put in: to a few nats, for the numbers come
/// from the same eight logs. (More likely, too: that a sighting is taken for a false one was learned with the sway.)
#[test]
fn sways_are_found_at_each_pace() {
    let plain: Vec<Dataset> = (0..8).map(steady).collect();
    let mut truth = Base::of(&plain).unwrap();
    let runs: Vec<Dataset> = (0..).zip(plain).map(|(seed, run)| swayed(run, &truth, seed)).collect();
    let held_out: Vec<Dataset> = (100..104).map(|seed| swayed(steady(seed), &truth, seed)).collect();
    truth.memory.sways = std::array::from_fn(|pace| [Sway::default(), of_steps(pace)]);
    let found = Base::of(&runs).unwrap();
    // At a walk slower than half of the greatest this robot hardly ever goes.
    for pace in [4, 7, 8] {
        let [sway, of_steps] = [found.memory.sways[pace][1], of_steps(pace)].map(|sway| hz(&sway));
        assert!((sway / of_steps - 1.0).abs() < 0.05, "pace {pace}: {sway} Hz, {of_steps} Hz put in");
    }
    let (under_truth, under_found) = (nats(&truth, &held_out), nats(&found, &held_out));
    assert!(under_found > under_truth - 10.0, "{under_found} nats a log, {under_truth} with what was put in");
}

/// A log of which some seconds half-way are gone, as if somebody had carried the robot meanwhile.
fn carried(run: &Dataset) -> Dataset {
    const GONE_S: f64 = 2.0;
    let half_s = 0.5 * RUN_S;
    let [before, after] = [0.0..half_s, half_s + GONE_S..RUN_S].map(|span_s| run.log.window(span_s));
    let earlier = |t_s: f64| t_s - GONE_S;
    let commands = after.commands.iter().map(|it| Command { t_s: earlier(it.t_s), ..*it });
    let sightings = after.sightings.iter().map(|it| Sighting { t_s: earlier(it.t_s), ..*it });
    let frames = before.frames.as_ref().zip(after.frames.as_ref()).map(|(before, after)| {
        let after = after.iter().map(|it| Frame { t_s: earlier(it.t_s), ..*it });
        before.iter().copied().chain(after).collect::<Vec<Frame>>().into()
    });
    let log = Log {
        commands: before.commands.iter().copied().chain(commands).collect::<Vec<Command>>().into(),
        sightings: before.sightings.iter().copied().chain(sightings).collect::<Vec<Sighting>>().into(),
        frames,
        ..run.log.clone()
    };
    Dataset { log, ..run.clone() }
}

/// Where a robot is not where it should be, that costs a log once, and not with every sighting from then on: of a filter that cannot
/// jump these four lose 200 to 6850 nats, of one that is not quicker to jump where sightings seem to be of something else up to 440.
#[test]
fn a_robot_that_was_carried_is_found_again() {
    let mut base = Base::of(&(0..8).map(steady).collect::<Vec<_>>()).unwrap();
    base.memory.sways = std::array::from_fn(|pace| [Sway::default(), of_steps(pace)]);
    for seed in 200..204 {
        let run = swayed(steady(seed), &base, seed);
        let lost = nats(&base, std::slice::from_ref(&run)) - nats(&base, &[carried(&run)]);
        assert!((3.0..150.0).contains(&lost), "{lost} nats");
    }
}
