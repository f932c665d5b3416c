//! Fits to runs that were made up with known numbers.

use asami_dataset::{Action, Beacon, Command, Dataset, Frame, Known, Log, Seed, Sighting, Size, TruePose, Truth};
use asami_math::elementary::exp;
use rand_distr::{Distribution, StandardNormal};

use super::{motion_alone, nominal, shape};
use crate::rhythm::Rhythm;
use crate::shape::{CHANGING, Numbers, Shape};

const FRAME_S: f64 = 0.05;
const HOLD_S: f64 = 3.0;
const FASTEST_M_PER_S: f64 = 0.3;
/// In a second, along the way.
const STEADY_M2: f64 = 2e-5;
/// The same, more, where the command becomes another by the greatest speed.
const CHANGING_M2: f64 = 4e-4;

/// A robot that goes to and fro along the y axis before a landmark at the origin, a second after another command as before.
fn run(seed: u64) -> Dataset {
    let mut rng = Seed(seed).stream("fit/tests");
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let speeds = [0.3, -0.1, 0.2, -0.3, 0.1, -0.2];
    let (mut commands, mut frames, mut sightings, mut track) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut y_m = -2.5;
    for n in 0..6000_u32 {
        let t_s = FRAME_S * f64::from(n);
        let (held, since_s) = ((t_s / HOLD_S + 1e-9) as usize, (t_s + 1e-9) % HOLD_S);
        let [now, before] = [held, held.max(1) - 1].map(|i| speeds[i % speeds.len()]);
        if since_s < FRAME_S - 1e-6 {
            let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: now, atheta_rad_per_s: 0.0 };
            commands.push(Command { t_s, action });
        }
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        track.push(TruePose { t_s, x_m: 0.0, y_m, theta_rad: 0.0, v_m_per_s: None });
        let size = Size::RangeM(-y_m + 0.01 * normal());
        sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad: 0.01 * normal() });
        let jump = (now - before).abs() / FASTEST_M_PER_S;
        let changing = jump * (1.0 - (since_s + 0.5 * FRAME_S) / 0.7).max(0.0);
        y_m += FRAME_S * now + (FRAME_S * (STEADY_M2 + changing * CHANGING_M2)).sqrt() * normal();
    }
    let landmarks = vec![Beacon { id: 0, x_m: 0.0, y_m: 0.0, height_m: None }];
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
