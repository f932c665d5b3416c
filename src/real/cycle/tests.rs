use asami_dataset::{Beacon, Known, Seed, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, exp, hypot, sin_cos};
use rand::RngExt;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::*;
use crate::real::clock::Clock;

const LENGTH_S: f64 = 600.0;
const PERIOD_S: f64 = 0.216;
const LATE_S: f64 = 0.08;
const STEP: f64 = 0.01;

/// A robot at the origin that is told to turn now and then for a fraction of a second, either way. Its wheels are told in cycles that are
/// longer or shorter by 2 %, or, where there are none, lag by 0.2 s. Gives the log, and how far it had turned at every hundredth of
/// a second.
fn log(cycles: bool, seed: u64) -> (Log, Vec<f64>) {
    worse(cycles, seed, 0.02, 0.005)
}

/// The same with cycles that are longer or shorter by this share, and bearings that are so far off.
fn worse(cycles: bool, seed: u64, wanders: f64, off_rad: f64) -> (Log, Vec<f64>) {
    let driver = if cycles { Driver::Whenever } else { Driver::Lagging };
    driven(driver, None, seed, wanders, off_rad)
}

/// Who tells the robot to turn.
#[derive(Clone, Copy, PartialEq)]
enum Driver {
    /// For anything between 0.05 and 0.6 s; its wheels have no cycles.
    Lagging,
    /// The same of one whose wheels have.
    Whenever,
    /// Until 0.12 s, give or take 0.03 s, after the look that takes the turn up, and at times until a look later.
    Reacting,
}

/// Pictures are taken by a clock, or when they are looked at.
fn driven(driver: Driver, camera: Option<Clock>, seed: u64, wanders: f64, off_rad: f64) -> (Log, Vec<f64>) {
    let mut rng = Seed(seed).stream("cycle");
    let mut looks_s = vec![0.1];
    while looks_s[looks_s.len() - 1] < LENGTH_S + 2.0 {
        let cycle_s = PERIOD_S * (1.0 + wanders * rng.sample::<f64, _>(StandardNormal));
        looks_s.push(looks_s[looks_s.len() - 1] + cycle_s);
    }
    let (mut commands, mut t_s) = (Vec::new(), 0.0);
    while t_s < LENGTH_S {
        for omega_rad_per_s in [0.0, if rng.random::<bool>() { 0.4 } else { -0.4 }] {
            commands.push(Command { t_s, action: Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s } });
            t_s = match driver {
                _ if omega_rad_per_s == 0.0 => t_s + 0.3 + 1.2 * rng.random::<f64>(),
                Driver::Reacting => {
                    let look = looks_s.partition_point(|it| *it < t_s) + usize::from(rng.random::<f64>() < 0.2);
                    looks_s[look] + 0.12 + 0.03 * rng.sample::<f64, _>(StandardNormal)
                }
                _ => t_s + 0.05 + 0.55 * rng.random::<f64>(),
            };
        }
    }
    let told =
        |t_s: f64| commands[commands.partition_point(|it| it.t_s <= t_s).max(1) - 1].action.velocity().unwrap()[1];
    let (mut headings, mut heading, mut omega, mut look) = (Vec::new(), 0.0, 0.0, 0);
    for step in 0..(LENGTH_S / STEP) as usize {
        let t_s = step as f64 * STEP;
        headings.push(heading);
        if driver == Driver::Lagging {
            omega += (1.0 - exp(-STEP / 0.2)) * (told(t_s) - omega);
        } else if t_s >= looks_s[look] + LATE_S {
            omega = told(looks_s[look]);
            look += 1;
        }
        heading += STEP * omega;
    }
    let place = |i: u16| {
        let (sin, cos) = sin_cos(f64::from(i));
        Beacon { id: i, x_m: -3.0 * sin, y_m: 3.0 * cos, height_m: None }
    };
    let landmarks: Vec<Beacon> = (0..6).map(place).collect();
    let mut sightings = Vec::new();
    for frame in 1..(LENGTH_S / 0.233) as usize - 2 {
        let t_s = 0.233 * frame as f64;
        let taken_s = camera.map_or(t_s, |camera| camera.taken_s(t_s).max(0.0));
        let heading_rad = headings[(taken_s / STEP).round() as usize];
        for Beacon { id: landmark, x_m, y_m, .. } in landmarks.iter().copied() {
            let error_rad = off_rad * rng.sample::<f64, _>(StandardNormal);
            let bearing_rad = wrap_rad(atan2(-x_m, y_m) - heading_rad + error_rad);
            if bearing_rad.abs() < 0.5 {
                sightings.push(Sighting { t_s, landmark, size: Size::RangeM(hypot(x_m, y_m)), bearing_rad });
            }
        }
    }
    let known = Known { landmarks, ..Known::default() };
    (Log { commands: commands.into(), sightings: sightings.into(), known: known.into(), ..Log::default() }, headings)
}

/// How far off turns within 0.3 s are by commands that act behind a lag and a delay.
fn off_rad(log: &Log, headings: &[f64], lag_s: f64, delay_s: f64) -> f64 {
    let turning = crate::real::commanded::Commanded::new(&log.commands, lag_s, 1.0);
    let one = |k: usize| {
        let (a, b) = (300 * k / 10, 300 * k / 10 + 30);
        let told = turning.over(a as f64 * STEP - delay_s, 30.0 * STEP)[1];
        (headings[b] - headings[a] - told).powi(2)
    };
    ((10..1900).map(one).sum::<f64>() / 1890.0).sqrt()
}

/// How far off turns are by commands as they were taken up, by bearings alone and by habits as well.
fn off_by_habits(driver: Driver, seed: u64) -> [f64; 2] {
    let (log, headings) = driven(driver, None, seed, 0.04, 0.02);
    let found = heard(&log, 0.2).unwrap();
    let by_bearings = evidence::Evidence::of(&log).unwrap().by_cycle(&found.cycle).probable;
    [Heard { phases: by_bearings, ..found.clone() }, found]
        .map(|it| off_rad(&it.taken_up(&log), &headings, 0.0, it.cycle.late_s))
}

/// Where who drives reacts to what the robot does, how long it is told to turn says when that was taken up; where it does not, nothing is
/// made of it.
#[test]
fn who_reacts_shows_when_the_looks_are() {
    for seed in 21..24 {
        let [alone, both] = off_by_habits(Driver::Reacting, seed);
        assert!(both < 0.75 * alone, "{seed}: {both}, by bearings alone {alone}");
        let [alone, both] = off_by_habits(Driver::Whenever, seed);
        assert!(both < 1.05 * alone, "{seed}: {both}, by bearings alone {alone}");
    }
}

/// Of a robot whose bearings are too poor to tell its camera's clock where wheels are thought to lag, others of its make tell how fast the
/// camera is, and commands as they are taken up when pictures are; where what is seen is as old as it is dated, it stays so.
#[test]
fn others_of_its_make_say_how_fast_a_camera_is() {
    let camera = Clock { period_s: 0.100_04, first_s: 0.031 };
    (31..33).into_par_iter().for_each(|seed: u64| {
        let (log, _) = driven(Driver::Reacting, Some(camera), seed, 0.04, 0.025);
        assert_eq!(crate::real::clock::dated(&log, 10.0).period_s, None, "{seed}");
        let told = dated_like_others(&log, 0.100_042, PERIOD_S).unwrap();
        let right = log.sightings.iter().filter(|it| {
            let taken_s = camera.taken_s(it.t_s);
            told.log.sightings.iter().any(|told| told.landmark == it.landmark && (told.t_s - taken_s).abs() < 0.02)
        });
        let share = right.count() as f64 / log.sightings.len() as f64;
        assert!(share > 0.8, "{seed}: {share} {}", told.said);
        let (log, _) = driven(Driver::Reacting, None, seed, 0.04, 0.025);
        assert_eq!(dated_like_others(&log, 0.100_042, PERIOD_S).map(|it| it.said), None, "{seed}");
    });
}

/// Length and lateness are those of the robot's software; commands as they were taken up turn the robot as it turned, twice as well as
/// those that were given do behind the lag that suits them best.
#[test]
fn a_cycle_is_heard_and_commands_are_given_as_they_were_taken_up() {
    let (log, headings) = log(true, 1);
    let found = heard(&log, 0.2).unwrap();
    let Cycle { period_s, late_s, turns, .. } = found.cycle;
    assert!(found.is_told() && found.nats > 100.0, "{found:?}");
    assert!((period_s / PERIOD_S - 1.0).abs() < 0.01 && (late_s - LATE_S).abs() < 0.03 && (turns - 1.0).abs() < 0.05);
    let off = |log: &Log, lag_s: f64, delay_s: f64| off_rad(log, &headings, lag_s, delay_s);
    let given = (0..10).flat_map(|lag| (0..10).map(move |delay| [0.04 * f64::from(lag), 0.04 * f64::from(delay)]));
    let given = given.map(|[lag_s, delay_s]| off(&log, lag_s, delay_s)).fold(f64::INFINITY, f64::min);
    let taken = off(&found.taken_up(&log), 0.0, late_s);
    assert!(taken < 0.5 * given, "{taken} rad in 0.3 s, as given {given}");
}

/// Where wheels lag, and where the cycle is said to be of another length, nothing is told.
#[test]
fn what_is_no_cycle_is_not_taken_for_one() {
    for seed in 2..6 {
        let found = heard(&log(false, seed).0, 0.2).unwrap();
        assert!(!found.is_told(), "{seed}: {found:?}");
    }
    let (log, _) = log(true, 7);
    let told = taken_up(&log, 0.3);
    assert!(told.period_s.is_none() && told.log == log && told.said.contains("does not tell"), "{}", told.said);
    assert_eq!(heard(&Log::default(), 0.2), None);
}

/// A log that tells cycles from wheels that lag, and not how long they are, tells when those are that others of its make have; one of wheels
/// that lag does not.
#[test]
fn others_of_its_make_say_how_long_a_cycle_is() {
    let (log_of_some, _) = worse(true, 3, 0.05, 0.025);
    let some = log_of_some.window(0.0..300.0);
    assert_eq!(taken_up(&some, 0.2).period_s, None);
    let told = taken_up_like_others(&some, PERIOD_S).unwrap();
    let period_s = told.period_s.unwrap();
    assert!((period_s / PERIOD_S - 1.0).abs() < 0.03 && told.log != some, "{period_s}");
    for seed in 2..6 {
        assert_eq!(taken_up_like_others(&log(false, seed).0, PERIOD_S).map(|it| it.said), None);
    }
}

/// Whatever is probable is in force for its share of the time; nothing is given twice, and times increase.
#[test]
fn what_is_probable_is_in_force_for_its_share() {
    let wheels = |t_s: f64, omega_rad_per_s: f64| Command {
        t_s,
        action: Action::Wheels { id: None, v_m_per_s: 0.1, omega_rad_per_s },
    };
    let log = Log {
        commands: vec![wheels(0.0, 0.0), wheels(1.0, 0.4), wheels(1.5, 0.0), wheels(4.0, 0.2)].into(),
        ..Log::default()
    };
    let cycle = Cycle { period_s: 0.5, late_s: 0.0, turns: 1.0, wanders: 0.05, off_rad: 0.01 };
    let heard = Heard { cycle, nats: 0.0, by_chance_nats: 0.0, phases: vec![[1.0 / PHASES as f64; PHASES]; 9] };
    let taken = heard.taken_up(&log);
    let rising = taken.commands.windows(2).all(|it| it[1].t_s > it[0].t_s && it[1].action != it[0].action);
    assert!(rising && taken.commands.len() > 10, "{:?}", taken.commands);
    assert_eq!(
        taken.commands.last().map(|it| it.action),
        Some(wheels(4.0, 0.2).action),
        "the last is taken up as well"
    );
    let turning = crate::real::commanded::Commanded::new(&taken.commands, 0.0, 1.0);
    let all = turning.over(0.5, 2.0)[1];
    assert!((all - 0.2).abs() < 0.01, "{all}");
    // Half of the looks that show it are before the middle.
    assert!((turning.over(1.0, 0.5)[1] - 0.1).abs() < 0.01);
}
