//! Some iterations of EM on a log with two sightings in every step, for `benches/peers/em_linear.py` to time.
//!
//! ```text
//! cargo run --example em_iterations -- em_exact 50
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::TAU;

use asami_dataset::models::Entry;
use asami_dataset::{
    Action, ActionModel, Beacon, Command, Frame, Known, Log, Models, Noise, Rng, Seed, SensorModel, Sighting, Size,
};
use asami_learners::Learners;
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};
use asami_math::polynomial::Polynomial;
use rand_distr::{Distribution, StandardNormal};
use serde_json::json;

/// As in section 4.4.2 of Stronger (2008).
const STEPS: usize = 18_000;
const STEP_S: f64 = 0.05;
const HOLD_STEPS: usize = 100;
const ACTIONS: u16 = 40;
const BEACONS_M: [[f64; 2]; 4] = [[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]];

const SIGMA1_PX: f64 = 1.0;
const SIGMA2_RAD: f64 = 0.05;
const MOTION_SD: [f64; 3] = [0.005, 0.005, 0.02];

/// An action, then its opposite: the robot comes back to where it was, but for the noise.
fn velocity(id: u16) -> [f64; 3] {
    let sign = if id.is_multiple_of(2) { 1.0 } else { -1.0 };
    let (sin, cos) = sin_cos(TAU * f64::from(id / 2) / f64::from(ACTIONS / 2));
    [0.3 * cos, 0.4 * sin, 0.5 * sin_cos(f64::from(id / 2)).0].map(|v| sign * v)
}

fn log(seed: Seed) -> Log {
    let mut rng = seed.stream("log");
    let normal = |rng: &mut Rng| -> f64 { StandardNormal.sample(rng) };
    let [mut x_m, mut y_m, mut theta_rad] = [0.0, 0.0, 0.3];
    let (mut commands, mut frames, mut sightings) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..STEPS {
        let t_s = i as f64 * STEP_S;
        let id = (i / HOLD_STEPS % usize::from(ACTIONS)) as u16;
        let [right, forward, turn] = velocity(id);
        if i % HOLD_STEPS == 0 {
            let (ax_m_per_s, ay_m_per_s, atheta_rad_per_s) = (right, forward, turn);
            commands
                .push(Command { t_s, action: Action::Legs { id: Some(id), ax_m_per_s, ay_m_per_s, atheta_rad_per_s } });
        }
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        let (sin, cos) = sin_cos(theta_rad);
        for landmark in if i % 2 == 0 { [0, 2] } else { [1, 3] } {
            let [dx_m, dy_m] = [BEACONS_M[landmark][0] - x_m, BEACONS_M[landmark][1] - y_m];
            let size = Size::HeightPx(50.0 - 5.0 * hypot(dx_m, dy_m) + SIGMA1_PX * normal(&mut rng));
            let bearing_rad = wrap_rad(atan2(-dx_m, dy_m) - theta_rad + SIGMA2_RAD * normal(&mut rng));
            sightings.push(Sighting { t_s, landmark: landmark as u16, size, bearing_rad });
        }
        let mut moved = [right, forward, turn].map(|v| v * STEP_S);
        for (moved, sd) in moved.iter_mut().zip(MOTION_SD) {
            *moved += sd * normal(&mut rng);
        }
        x_m += cos * moved[0] - sin * moved[1];
        y_m += sin * moved[0] + cos * moved[1];
        theta_rad = wrap_rad(theta_rad + moved[2]);
    }
    let landmarks = (0..).zip(BEACONS_M).map(|(id, [x_m, y_m])| Beacon { id, x_m, y_m, height_m: Some(0.2) });
    let known = Known { robot: "plain".to_owned(), landmarks: landmarks.collect(), ..Known::default() };
    Log {
        known: known.into(),
        commands: commands.into(),
        frames: Some(frames.into()),
        sightings: sightings.into(),
        ..Log::default()
    }
}

/// Near the truth, so that no iteration is spent on finding the robot: the velocities at nine tenths.
fn given() -> Models {
    let entry = |action: u16| {
        let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] = velocity(action).map(|v| 0.9 * v);
        Entry { action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s, se: None }
    };
    Models {
        action: Some(ActionModel::Table((0..ACTIONS).map(entry).collect())),
        sensor: Some(SensorModel::HeightOfDistance(Polynomial::plain(vec![48.0, -4.5]).into())),
        noise: Noise {
            sigma1_px: Some(2.0 * SIGMA1_PX),
            sigma2_rad: Some(2.0 * SIGMA2_RAD),
            motion_sd: Some(MOTION_SD),
            ..Noise::default()
        },
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "em_exact".to_owned());
    let iterations: u32 = arguments.next().map_or(Ok(50), |text| text.parse())?;
    // Nobody stops early.
    let wanted = [("max_iterations", f64::from(iterations)), ("patience", f64::from(iterations)), ("tolerance", 0.0)];
    let about = asami_learners::catalogue().into_iter().find(|about| about.name == name);
    let about = about.ok_or_else(|| format!("there is no learner {name}"))?;
    let has = |name: &str| about.parameters.iter().any(|parameter| parameter.name == name);
    let with: BTreeMap<String, f64> =
        wanted.into_iter().filter(|(name, _)| has(name)).map(|(name, value)| (name.to_owned(), value)).collect();
    let learner = Learners::default().configured(&name, &with).map_err(|faults| format!("{name}: {faults:?}"))?;

    let log = log(Seed(1000));
    let learned = learner.learn(&log, &given(), &mut Seed(0).stream("learner"))?;
    let found = learned.iterations.unwrap_or_default();
    if found != iterations {
        return Err(format!("{name} stopped after {found} iterations, not {iterations}").into());
    }
    println!("{}", json!({ "steps": STEPS, "sightings": log.sightings.len(), "actions": ACTIONS }));
    Ok(())
}
