//! Fits to runs that were made up with known numbers.

use asami_dataset::{Action, Beacon, Command, Dataset, Frame, Known, Log, Seed, Sighting, Size, TruePose, Truth};
use asami_math::angle::wrap_rad;
use asami_math::elementary::exp;
use asami_sim::effects::turn_step::lacks_rad_per_s;
use rand_distr::{Distribution, StandardNormal};

use super::{Free, as_fine_as_shown, changed, motion_alone, nominal, shape};
use crate::columns::Group;
use crate::rhythm::Rhythm;
use crate::shape::{CHANGING, Numbers, STANDING, Shape};
use crate::touch::Touch;

const FRAME_S: f64 = 0.05;
const HOLD_S: f64 = 3.0;
const FASTEST_M_PER_S: f64 = 0.3;
/// In a second, along the way.
const STEADY_M2: f64 = 2e-5;
/// The same, more, where the command becomes another by the greatest speed.
const CHANGING_M2: f64 = 4e-4;

/// A robot that goes along the y axis before a landmark at the origin, at commands of some seconds each, by which it moves as
/// `answers` says: commands now and before, and seconds since it changed, to metres per second and their variance.
fn answering(seed: u64, commands: &[f64], answers: impl Fn(f64, f64, f64) -> (f64, f64)) -> Dataset {
    let mut rng = Seed(seed).stream("fit/tests");
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let (mut log, mut frames, mut sightings, mut track) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut y_m = -2.5;
    for n in 0..6000_u32 {
        let t_s = FRAME_S * f64::from(n);
        let (held, since_s) = ((t_s / HOLD_S + 1e-9) as usize, (t_s + 1e-9) % HOLD_S);
        let [now, before] = [held, held.max(1) - 1].map(|i| commands[i % commands.len()]);
        if since_s < FRAME_S - 1e-6 {
            let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: now, atheta_rad_per_s: 0.0 };
            log.push(Command { t_s, action });
        }
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        track.push(TruePose { t_s, x_m: 0.0, y_m, theta_rad: 0.0, v_m_per_s: None });
        let size = Size::RangeM(-y_m + 0.01 * normal());
        sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad: 0.01 * normal() });
        let (speed_m_per_s, variance_m2) = answers(now, before, since_s + 0.5 * FRAME_S);
        y_m += FRAME_S * speed_m_per_s + (FRAME_S * variance_m2).sqrt() * normal();
    }
    recorded(0.0, log, frames, sightings, track)
}

/// A run before a landmark so far ahead of the origin.
fn recorded(
    ahead_m: f64,
    commands: Vec<Command>,
    frames: Vec<Frame>,
    sightings: Vec<Sighting>,
    track: Vec<TruePose>,
) -> Dataset {
    let landmarks = vec![Beacon { id: 0, x_m: 0.0, y_m: ahead_m, height_m: None }];
    let known = Known { robot: "plain".to_owned(), landmarks, ..Known::default() };
    let log = Log {
        known: known.into(),
        commands: commands.into(),
        frames: Some(frames.into()),
        sightings: sightings.into(),
        ..Log::default()
    };
    Dataset { log, truth: Truth { track: track.into(), survey: None }, provenance: None }
}

/// To and fro, a second after another command as before.
fn run(seed: u64) -> Dataset {
    answering(seed, &[0.3, -0.1, 0.2, -0.3, 0.1, -0.2], |now, before, since_s| {
        let jump = (now - before).abs() / FASTEST_M_PER_S;
        let changing = jump * (1.0 - since_s / 0.7).max(0.0);
        (now, STEADY_M2 + changing * CHANGING_M2)
    })
}

/// Commands of any size, all of them about as often.
fn any(seed: u64) -> Vec<f64> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    (0..100_u32).map(|i| FASTEST_M_PER_S * (2.0 * (golden * f64::from(i) + 0.13 * seed as f64).fract() - 1.0)).collect()
}

/// Forward numbers of the curve.
fn curve(shape: &Shape, runs: &[Dataset]) -> Vec<f64> {
    let columns = &shape.columns;
    motion_alone(shape, runs)[columns.len()..][columns.range(Group::Curve)].to_vec()
}

/// A gait that stalls below a fifth of its greatest command and gains nothing beyond two thirds is foretold by finer knots; one
/// in proportion to its command is not, and keeps the fewest.
#[test]
fn curves_are_as_fine_as_runs_call_for() {
    let stalls = |now: f64| now.signum() * (now.abs() - 0.06).clamp(0.0, 0.14);
    let knots = |answer: &dyn Fn(f64) -> f64| {
        let runs: Vec<Dataset> =
            (0..4).map(|seed| answering(seed, &any(seed), |now, _, _| (answer(now), STEADY_M2))).collect();
        let shape = as_fine_as_shown(shape(&runs).expect("a landmark is seen"), &runs);
        let curve = curve(&shape, &runs);
        let last = (curve.len() - 1) as f64;
        let at = |i: usize| FASTEST_M_PER_S * (2.0 * i as f64 / last - 1.0);
        // A knot's neighbours are on the same straight line as it but at the four bends.
        let off = (0..curve.len()).map(|i| (curve[i] - answer(at(i))).abs()).fold(0.0, f64::max);
        assert!(off < 0.01, "{off}: {curve:?}");
        curve.len()
    };
    let [fine, coarse] = [knots(&stalls), knots(&|now| 0.7 * now)];
    assert!(fine > coarse, "{fine} {coarse}");
    assert_eq!(coarse, 13);
}

/// Where a robot slips as it sets off, and not as it stops, what it does ever after is known all the same.
#[test]
fn what_happens_as_commands_change_does_not_bend_what_comes_of_them() {
    let slips = |now: f64, before: f64, since_s: f64| {
        let slipped = if now.abs() > before.abs() && since_s < 0.5 { 0.2 * now } else { 0.0 };
        (now - slipped, STEADY_M2 + if since_s < 0.5 { CHANGING_M2 } else { 0.0 })
    };
    let runs: Vec<Dataset> = (0..4).map(|seed| answering(seed, &any(seed), slips)).collect();
    let shape = shape(&runs).expect("a landmark is seen");
    let curve = curve(&shape, &runs);
    // Unweighed, 0.3 m/s would be taken for less by a few mm/s.
    let off_m_per_s = [curve[0] + FASTEST_M_PER_S, curve[curve.len() - 1] - FASTEST_M_PER_S];
    assert!(off_m_per_s.iter().all(|it| it.abs() < 0.003), "{off_m_per_s:?}");
}

/// A gait meets a command somewhere in its stride: what comes of that is noise for as long as it lasts, and no other.
#[test]
fn noise_while_commands_change_is_told_from_noise_that_is_always_there() {
    let runs: Vec<Dataset> = (0..6).map(run).collect();
    let plain = shape(&runs).expect("a landmark is seen");
    let shape = Shape { columns: plain.columns.knowing(&motion_alone(&plain, &runs)), ..plain };
    let numbers = nominal(&shape, &Rhythm::default(), &runs);
    let forward = |class: usize| exp(numbers[shape.range(Numbers::MotionNoise).start + 3 * class + 1]);
    // About 400 blocks have a change in them, and 300 none.
    let (steady, changing) = (forward(2), forward(CHANGING));
    assert!((steady / STEADY_M2 - 1.0).abs() < 0.35, "{steady}");
    assert!((changing / CHANGING_M2 - 1.0).abs() < 0.35, "{changing}");
}

/// A robot on legs that stands scatters as little as it does; how much one on wheels does that still rolls, a nominal one does not show.
#[test]
fn wheels_that_stand_take_after_those_that_go() {
    let rests = |seed: u64| {
        answering(seed, &[0.3, 0.3, 0.0, 0.0, -0.1, -0.1, 0.0, 0.0, 0.2, 0.2, 0.0, 0.0], |now, _, _| {
            (now, if now == 0.0 { 1e-3 * STEADY_M2 } else { STEADY_M2 })
        })
    };
    let rolling = |mut run: Dataset| {
        let wheels = |(i, command): (usize, &Command)| {
            let Action::Legs { ay_m_per_s: v_m_per_s, .. } = command.action else { panic!("it has legs") };
            let omega_rad_per_s = if v_m_per_s == 0.0 { 0.0 } else { 0.2 * ((i / 4 % 3) as f64 - 1.0) };
            Command { action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s }, ..*command }
        };
        run.log.commands = run.log.commands.iter().enumerate().map(wheels).collect::<Vec<_>>().into();
        run
    };
    let standing = |runs: Vec<Dataset>| {
        let plain = shape(&runs).expect("a landmark is seen");
        let shape = Shape { columns: plain.columns.knowing(&motion_alone(&plain, &runs)), ..plain };
        let numbers = nominal(&shape, &Rhythm::default(), &runs);
        exp(numbers[shape.range(Numbers::MotionNoise).start + 3 * STANDING + 1])
    };
    let legs = standing((0..4).map(rests).collect());
    let wheels = standing((0..4).map(rests).map(rolling).collect());
    assert!(legs < 0.1 * STEADY_M2, "{legs}");
    assert!((wheels / STEADY_M2 - 1.0).abs() < 0.35, "{wheels}");
}

/// A robot on two wheels that is told to turn at any rate, one in thirty of them a slight one, and makes a share of what that lacks of a whole step.
fn turning(seed: u64, share: f64) -> Dataset {
    let mut rng = Seed(seed).stream("fit/tests");
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let told = |held: usize| {
        let of = 2.0 * (golden * held as f64 + 0.13 * seed as f64).fract() - 1.0;
        if held.is_multiple_of(30) { 0.03 * of } else { 0.5 * of }
    };
    let (mut commands, mut frames, mut sightings, mut track) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut theta_rad = 0.0;
    for n in 0..6000_u32 {
        let t_s = FRAME_S * f64::from(n);
        let omega_rad_per_s = told((t_s / HOLD_S + 1e-9) as usize);
        let action = Action::Wheels { id: None, v_m_per_s: 0.1, omega_rad_per_s };
        commands.push(Command { t_s, action });
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        track.push(TruePose { t_s, x_m: 0.0, y_m: 0.0, theta_rad: wrap_rad(theta_rad), v_m_per_s: None });
        let size = Size::RangeM(2.0 + 0.01 * normal());
        let bearing_rad = wrap_rad(-theta_rad + 0.01 * normal());
        sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad });
        let made = omega_rad_per_s + share * lacks_rad_per_s(0.1, omega_rad_per_s);
        theta_rad += FRAME_S * made + (FRAME_S * 3e-4).sqrt() * normal();
    }
    recorded(2.0, commands, frames, sightings, track)
}

/// What an effect changes of turns alone is not taken for chance beside all that it leaves of the curve.
#[test]
fn what_is_of_turns_alone_keeps_its_size() {
    let [nominal_runs, with] = [0.0, 0.8].map(|share| (0..4).map(|seed| turning(seed, share)).collect::<Vec<_>>());
    let plain = shape(&nominal_runs).expect("a landmark is seen");
    let shape = Shape { columns: plain.columns.knowing(&motion_alone(&plain, &nominal_runs)), ..plain };
    let base = nominal(&shape, &Rhythm::default(), &nominal_runs);
    let free = Free { wear: false };
    let changes = changed(&shape, (&Rhythm::default(), &base), &[(1.0, &with)], free, Touch::Motion, true);
    let lacks = 2 * shape.columns.len() + shape.columns.in_turns().expect("it is on two wheels").end - 1;
    let made = changes[0][lacks] / 0.5;
    assert!((made / 0.8 - 1.0).abs() < 0.1, "{made}");
}
