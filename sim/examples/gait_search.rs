//! Measures the Aibo's curve of speed against command, and searches gaits by random changes.
//!
//! ```text
//! cargo run --example gait_search                    # the default gait's curve
//! cargo run --example gait_search -- gait.toml       # another robot's (the tables of AiboConfig)
//! cargo run --example gait_search -- gait.toml 300 7 # after 300 tries at bettering it, drawn from seed 7
//! cargo run --example gait_search -- - 300           # the default gait's
//! ```

mod searching;

use std::error::Error;

use asami_dataset::parameters::Parameters;
use asami_dataset::{Action, Rng, Seed};
use asami_math::angle::wrap_rad;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, BuildError, Start};
use asami_sim::scenes::field::Field;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::{Record, World};
use nalgebra::{DMatrix, DVector};

use searching::{Searched, tried};

/// Seeds below 1000 belong to the experiments.
const SEED: u64 = 1000;
/// Nominal walking before and during the measurement.
const WARM_UP_S: f64 = 1.2;
const MEASURE_S: f64 = 4.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut config: AiboConfig = match arguments.next().as_deref() {
        None | Some("-") => AiboConfig::default(),
        Some(path) => toml::from_str(&std::fs::read_to_string(path)?)?,
    };
    let tries: u32 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(SEED), |text| text.parse())?;
    if tries > 0 {
        search(&mut config, tries, &mut Seed(seed).stream("gait_search"))?;
        println!("[gait]\n{}", toml::to_string(&config.gait)?);
    }
    let fine: Vec<f64> = (-15..=15).map(|i| 0.02 * f64::from(i)).collect();
    let curve = fine
        .iter()
        .map(|&command| Ok((command, walk(&config, command, SEED)?)))
        .collect::<Result<Vec<_>, BuildError>>()?;
    println!("command mm/s   forward   rightward   turn deg/s   least up");
    for (command, walk) in &curve {
        let [right, forward, turn] = walk.velocity;
        println!(
            "{:12.0} {:9.1} {:11.1} {:12.2} {:10.3}",
            1e3 * command,
            1e3 * forward,
            1e3 * right,
            turn.to_degrees(),
            walk.least_up
        );
    }
    let shape = Shape::of(&curve);
    println!("range {:.0} mm/s, least slope {:.2}", 1e3 * shape.range_m_per_s, shape.least_slope);
    println!("RMS error of the best line through 0 {:.2} %,", 1e2 * shape.line_error);
    println!(
        "of the best cubic {:.2} %, of the best quartic {:.2} % of the range",
        1e2 * shape.cubic_error,
        1e2 * shape.quartic_error
    );
    Ok(())
}

/// One steady walk.
struct Walk {
    /// Mean velocity in the robot frame: rightward, forward, counter-clockwise.
    velocity: [f64; 3],
    /// Least vertical component of the torso's upward axis; below 0.5 it has fallen.
    least_up: f64,
}

fn walk(config: &AiboConfig, command_m_per_s: f64, seed: u64) -> Result<Walk, BuildError> {
    // Nothing to see, so seldom looked for.
    let camera = CameraConfig { frame_rate_hz: 1.0, ..CameraConfig::default() };
    let mut world =
        AiboWorld::new(config, &Field::default(), &camera, &Effects::default(), Start::default(), Seed(seed))?;
    let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: command_m_per_s, atheta_rad_per_s: 0.0 };
    let mut record = Record::default();
    let mut moved = [0.0; 3];
    let mut least_up: f64 = 1.0;
    let mut last = world.pose();
    while world.t_s() < WARM_UP_S + MEASURE_S && !world.has_fallen() {
        world.tick(action, &mut record);
        let pose = world.pose();
        let (sin, cos) = last.theta_rad.sin_cos();
        let (dx, dy) = (pose.x_m - last.x_m, pose.y_m - last.y_m);
        if pose.t_s > WARM_UP_S {
            moved[0] += cos * dx + sin * dy;
            moved[1] += -sin * dx + cos * dy;
            moved[2] += wrap_rad(pose.theta_rad - last.theta_rad);
        }
        least_up = least_up.min((world.body().world_from_torso() * nalgebra::Vector3::z()).z);
        last = pose;
    }
    Ok(Walk { velocity: moved.map(|sum| sum / MEASURE_S), least_up })
}

/// What counts about a curve, as shares of its range.
struct Shape {
    range_m_per_s: f64,
    least_slope: f64,
    line_error: f64,
    cubic_error: f64,
    quartic_error: f64,
}

impl Shape {
    /// Of walks in order of their commands.
    fn of(curve: &[(f64, Walk)]) -> Self {
        let (commands, speeds): (Vec<f64>, Vec<f64>) =
            curve.iter().map(|(command, walk)| (*command, walk.velocity[1])).unzip();
        let range = speeds.iter().fold(f64::MIN, |a, b| a.max(*b)) - speeds.iter().fold(f64::MAX, |a, b| a.min(*b));
        let slopes = commands.windows(2).zip(speeds.windows(2)).map(|(c, v)| (v[1] - v[0]) / (c[1] - c[0]));
        let error = |powers: &[i32]| residual(&commands, &speeds, powers) / range;
        Self {
            range_m_per_s: range,
            least_slope: slopes.fold(f64::MAX, f64::min),
            line_error: error(&[1]),
            cubic_error: error(&[0, 1, 2, 3]),
            quartic_error: error(&[0, 1, 2, 3, 4]),
        }
    }

    fn slope_cost(&self) -> f64 {
        4.0 * (0.02 - self.least_slope).max(0.0)
    }

    /// How far the curve is from the one wanted: monotone, from about -200 to 200 mm/s, bent so that a
    /// scaled line misses it by 7 % of its range, and smooth enough for a quartic.
    fn cost(&self) -> f64 {
        let over = |value: f64, most: f64| (value - most).max(0.0);
        self.slope_cost()
            + 12.0 * over(0.4, self.range_m_per_s)
            + 30.0 * (over(self.line_error, 0.078) + over(0.065, self.line_error))
            + 60.0 * over(self.quartic_error, 0.012)
    }
}

/// Root mean square residual of the best sum of powers.
fn residual(x: &[f64], y: &[f64], powers: &[i32]) -> f64 {
    let design = DMatrix::from_fn(x.len(), powers.len(), |row, column| (x[row] / 0.3).powi(powers[column]));
    let y = DVector::from_column_slice(y);
    match design.clone().svd(true, true).solve(&y, 1e-12) {
        Ok(weights) => (y - design * weights).norm() / (x.len() as f64).sqrt(),
        Err(_) => f64::INFINITY,
    }
}

/// The ranges searched.
const SEARCHED: [Searched; 9] = [
    ("swing_easing", 0.0, 1.0),
    ("period_s", 0.36, 0.9),
    ("duty", 0.5, 0.62),
    ("lift_m", 0.012, 0.04),
    ("fore_height_m", 0.065, 0.125),
    ("hind_height_m", 0.070, 0.13),
    ("fore_offset_m", -0.02, 0.06),
    ("hind_offset_m", -0.06, 0.03),
    ("outward_offset_m", 0.0, 0.02),
];

fn search(config: &mut AiboConfig, tries: u32, rng: &mut Rng) -> Result<(), BuildError> {
    // The far ends first: they fail most often.
    let commands: Vec<f64> = (1..=15).rev().flat_map(|i| [0.02 * f64::from(i), -0.02 * f64::from(i)]).collect();
    let mut least = f64::INFINITY;
    for n in 0..tries {
        let mut other = config.clone();
        other.gait = tried(&config.gait, &SEARCHED, n, rng);
        let cost = cost(&other, &commands, least)?;
        if cost < least {
            least = cost;
            *config = other;
            eprintln!("{n}: {least:.3} {:.4?}", config.gait.values());
        }
    }
    Ok(())
}

/// Turning, drifting and tilting cost in themselves; the rest is the curve's [`Shape`]. Gives up once the cost
/// exceeds `least`: the least slope of a few points is no less than that of all.
fn cost(config: &AiboConfig, commands: &[f64], least: f64) -> Result<f64, BuildError> {
    let mut curve: Vec<(f64, Walk)> = Vec::new();
    let mut gait_cost = 0.0;
    let mut shape = None;
    for &command in commands {
        let walk = walk(config, command, SEED)?;
        let [right, forward, turn] = walk.velocity;
        if walk.least_up < 0.5 || forward * command <= 0.0 {
            return Ok(f64::INFINITY);
        }
        gait_cost += (turn / 0.5).powi(2) + (right / 0.1).powi(2) + 4.0 * (0.96 - walk.least_up).max(0.0);
        let at = curve.partition_point(|(other, _)| *other < command);
        curve.insert(at, (command, walk));
        let so_far = Shape::of(&curve);
        if gait_cost + so_far.slope_cost() > least {
            return Ok(f64::INFINITY);
        }
        shape = Some(so_far);
    }
    Ok(gait_cost + shape.map_or(f64::INFINITY, |shape| shape.cost()))
}
