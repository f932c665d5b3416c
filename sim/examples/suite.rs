//! Measures the Aibo's velocities under the 40 actions of chapter 4, and searches gaits by random changes.
//!
//! ```text
//! cargo run --example suite                    # the default gait
//! cargo run --example suite -- robot.toml      # another robot: the tables [aibo] and [suite]
//! cargo run --example suite -- robot.toml 300 7 # after 300 tries at bettering it, drawn from seed 7
//! cargo run --example suite -- robot.toml 0 7 30 # over 30 s each
//! ```

mod searching;

use std::error::Error;

use asami_dataset::parameters::Parameters;
use asami_dataset::{Action, Rng, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::config::HeadingHold;
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, BuildError, Start};
use asami_sim::scenes::field::Field;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::survey::mean_velocity;
use asami_sim::world::{Record, World};
use serde::Deserialize;

use searching::{Searched, tried};

/// Seeds below 1000 belong to the experiments.
const SEED: u64 = 1000;
const WARM_UP_S: f64 = 1.2;
/// Velocities are means over arcs of so many strides.
const STRIDES: f64 = 3.0;

/// What a file may set.
#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Robot {
    aibo: AiboConfig,
    suite: Suite,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut robot: Robot = match arguments.next().as_deref() {
        None | Some("-") => Robot::default(),
        Some(path) => toml::from_str(&std::fs::read_to_string(path)?)?,
    };
    robot.aibo.heading_hold = HeadingHold { gain_per_s: 0.0, ..HeadingHold::default() };
    let tries: u32 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(SEED), |text| text.parse())?;
    let measure_s: f64 = arguments.next().map_or(Ok(6.0), |text| text.parse())?;
    if tries > 0 {
        search(&mut robot, tries, &mut Seed(seed).stream("suite"))?;
        println!("[aibo.gait]\n{}[suite]\n{}", toml::to_string(&robot.aibo.gait)?, toml::to_string(&robot.suite)?);
    }
    println!("action  attempted mm/s, rad/s     measured mm/s, rad/s       sway  least up");
    let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
    let mut squares = 0.0;
    for action in robot.suite.actions() {
        let Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s } = action else { continue };
        let walk = walk(&robot.aibo, action, seed, measure_s)?;
        let [right, forward, turn] = walk.velocity;
        for (i, velocity) in walk.velocity.into_iter().enumerate() {
            low[i] = low[i].min(velocity);
            high[i] = high[i].max(velocity);
        }
        squares += (turn - atheta_rad_per_s).powi(2);
        println!(
            "{:4}  {:7.0} {:7.0} {:7.2}   {:7.1} {:7.1} {:7.3}   {:6.3} {:6.3}",
            id.unwrap_or_default(),
            1e3 * ax_m_per_s,
            1e3 * ay_m_per_s,
            atheta_rad_per_s,
            1e3 * right,
            1e3 * forward,
            turn,
            walk.turn_sd,
            walk.least_up
        );
    }
    println!(
        "ranges {:.0} mm/s, {:.0} mm/s, {:.2} rad/s",
        1e3 * (high[0] - low[0]),
        1e3 * (high[1] - low[1]),
        high[2] - low[2]
    );
    println!("attempted turns are off by {:.3} rad/s RMS", (squares / 40.0).sqrt());
    Ok(())
}

/// One steady walk.
struct Walk {
    /// Velocity in the robot frame: rightward, forward, counter-clockwise.
    velocity: [f64; 3],
    /// Standard deviation of the heading about an even turn.
    turn_sd: f64,
    /// Least vertical component of the torso's upward axis; below 0.5 it has fallen.
    least_up: f64,
}

fn walk(config: &AiboConfig, action: Action, seed: u64, measure_s: f64) -> Result<Walk, BuildError> {
    // Nothing to see, so seldom looked for.
    let camera = CameraConfig { frame_rate_hz: 1.0, ..CameraConfig::default() };
    let mut world =
        AiboWorld::new(config, &Field::default(), &camera, &Effects::default(), Start::default(), Seed(seed))?;
    let mut record = Record::default();
    let mut track: Vec<TruePose> = Vec::new();
    let mut least_up: f64 = 1.0;
    while world.t_s() < WARM_UP_S + measure_s && !world.has_fallen() {
        world.tick(action, &mut record);
        if world.t_s() > WARM_UP_S {
            track.push(world.pose());
        }
        least_up = least_up.min((world.body().world_from_torso() * nalgebra::Vector3::z()).z);
    }
    let velocity = mean_velocity(&track, STRIDES * config.gait.period_s);
    let mut turned_rad = 0.0;
    let off = track.windows(2).map(|pair| {
        let lasted_s = pair[1].t_s - pair[0].t_s;
        turned_rad += wrap_rad(pair[1].theta_rad - pair[0].theta_rad) - velocity[2] * lasted_s;
        turned_rad * turned_rad
    });
    let turn_sd = (off.sum::<f64>() / track.len() as f64).sqrt();
    Ok(Walk { velocity, turn_sd, least_up })
}

/// The ranges searched.
const SEARCHED: [Searched; 9] = [
    ("swing_easing", 0.0, 1.0),
    ("period_s", 0.3, 0.9),
    ("duty", 0.5, 0.62),
    ("lift_m", 0.012, 0.05),
    ("fore_height_m", 0.065, 0.125),
    ("hind_height_m", 0.070, 0.13),
    ("fore_offset_m", -0.02, 0.06),
    ("hind_offset_m", -0.06, 0.03),
    ("outward_offset_m", 0.0, 0.03),
];

fn search(robot: &mut Robot, tries: u32, rng: &mut Rng) -> Result<(), BuildError> {
    let mut least = f64::INFINITY;
    for n in 0..tries {
        let mut other = robot.clone();
        other.aibo.gait = tried(&robot.aibo.gait, &SEARCHED, n, rng);
        let cost = cost(&other, least)?;
        if cost < least {
            least = cost;
            *robot = other;
            eprintln!("{n}: {least:.3} {:.4?}", robot.aibo.gait.values());
        }
    }
    Ok(())
}

/// How far the measured velocities fall short of the attempted ones, and how much the body tilts and sways.
fn cost(robot: &Robot, least: f64) -> Result<f64, BuildError> {
    let scale = [robot.suite.max_right_m_per_s, robot.suite.max_forward_m_per_s, robot.suite.max_turn_rad_per_s];
    let mut cost = 0.0;
    // One half; the other is its mirror image.
    for id in [18, 22, 16, 17, 21, 34, 38, 32, 36, 33, 37, 39, 35] {
        let action = robot.suite.actions()[id];
        let Action::Legs { ax_m_per_s, ay_m_per_s, atheta_rad_per_s, .. } = action else { continue };
        let walk = walk(&robot.aibo, action, SEED, 3.0)?;
        if walk.least_up < 0.5 {
            return Ok(f64::INFINITY);
        }
        for ((got, wanted), scale) in
            walk.velocity.into_iter().zip([ax_m_per_s, ay_m_per_s, atheta_rad_per_s]).zip(scale)
        {
            cost += ((got - wanted) / scale).powi(2);
        }
        cost += (walk.turn_sd / 0.2).powi(2) + 4.0 * (0.96 - walk.least_up).max(0.0);
        if cost > least {
            return Ok(f64::INFINITY);
        }
    }
    Ok(cost)
}
