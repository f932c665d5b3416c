//! How visible each effect on the car, its scanner apart, is, from a tenth of the least to the greatest size of the law by which it is
//! planted.
//!
//! A nominal drive of 200 s through a town gives commands; they are played on a level plane with the effect and
//! without. What parts the two, step by step of half a second, is weighed against what a diagnosis without a map has
//! to take for noise: odometry's errors and the town's hills. Beside it, whether the driver still keeps to the street.
//!
//! ```text
//! cargo run --example visible -- 2 road_grade drag   # number of seeds from 1000 on, effects; all if none
//! ```

mod planting;

use std::error::Error;

use asami_dataset::truth::pose_at;
use asami_dataset::{Action, Command, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_sim::drives::driver::{Driver, Driving, Feel};
use asami_sim::effect::{About, Place};
use asami_sim::effects::{Effects, catalogue};
use asami_sim::robots::car::{CarConfig, CarWorld, Start};
use asami_sim::scenes::solid::Ground;
use asami_sim::scenes::town::{Town, TownConfig};
use asami_sim::world::{Drive, Seen, run};
use nalgebra::{DMatrix, DVector};
use planting::sizes;

/// Seeds below 1000 belong to the experiments.
const FIRST_SEED: u64 = 1000;
const DRIVE_S: f64 = 200.0;
/// Step of the dissertation's scans.
const STEP_S: f64 = 0.5;
/// Errors of scan matching: of a way, in m, and of an angle, in rad.
const ODOMETRY: [f64; 2] = [0.011, 0.0003];
/// What a level plane leaves out of a town, of accelerations and of yaw rates: sizes and correlation times, after the
/// lines that are printed first.
const TERRAIN: [f64; 2] = [0.12, 0.003];
const TERRAIN_S: [f64; 2] = [2.0, 4.0];

/// A town, accelerations and yaw rates of a drive through it, and its commands.
type Nominal = (Town, [Vec<f64>; 2], Vec<Command>);

/// Plays commands again.
struct Replay(Vec<Command>);

impl Drive for Replay {
    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let next = self.0.partition_point(|command| command.t_s <= t_s + 5e-7);
        let none = Action::Pedals { throttle: 0.0, brake: 0.3, steering: 0.0 };
        next.checked_sub(1).map_or(none, |last| self.0[last].action)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let wanted: Vec<String> = arguments.collect();
    let fits = |about: &&About| {
        let moves = matches!(about.place, Place::Actuation | Place::Dynamics);
        about.fits.contains(&"car") && moves && (wanted.is_empty() || wanted.iter().any(|it| it == about.name))
    };
    let drives: Vec<Nominal> =
        (FIRST_SEED..FIRST_SEED + seeds).map(|seed| nominal(Seed(seed))).collect::<Result<_, _>>()?;
    let level: Vec<[Vec<f64>; 2]> =
        drives.iter().map(|(_, _, commands)| played(commands, &Effects::default())).collect::<Result<_, _>>()?;
    for ((_, town, _), level) in drives.iter().zip(&level) {
        let print = |k: usize| {
            let apart: Vec<f64> = town[k].iter().zip(&level[k]).map(|(a, b)| a - b).collect();
            let product =
                |lag: usize| apart.iter().zip(&apart[lag..]).map(|(a, b)| a * b).sum::<f64>() / apart.len() as f64;
            format!("{:.4} {:.2?}", product(0).sqrt(), [1, 4, 20, 60].map(|lag| product(lag) / product(0)))
        };
        println!("the town: accelerations {} m/s^2, yaw rates {} rad/s, sd and memory", print(0), print(1));
    }
    let whiten = whiteners(level[0][0].len());
    println!(
        "effect                     size        nats: speed      turn | most off the route, way of the driven drive"
    );
    for about in catalogue().into_iter().filter(fits) {
        for (size, effects) in sizes(about) {
            let mut nats = [0.0; 2];
            for ((_, _, commands), plain) in drives.iter().zip(&level) {
                let other = played(commands, &effects)?;
                for k in 0..2 {
                    let apart =
                        DVector::from_iterator(plain[k].len(), other[k].iter().zip(&plain[k]).map(|(a, b)| a - b));
                    nats[k] += 0.5 * (&whiten[k] * &apart).dot(&apart) / drives.len() as f64;
                }
            }
            let (aside_m, way_m) = driven(&drives[0].0, &effects)?;
            println!("{:22} {size:11.4} {:18.1} {:9.1} | {aside_m:5.2} {way_m:5.0} m", about.name, nats[0], nats[1]);
        }
    }
    Ok(())
}

fn nominal(seed: Seed) -> Result<Nominal, Box<dyn Error>> {
    let town = Town::new(&TownConfig::default(), seed);
    let (mut car, mut driver) = (in_town(&town, &Effects::default(), seed)?, at_the_wheel(&town, seed));
    let drive = run(&mut car, &mut driver, DRIVE_S);
    Ok((town, steps(&drive.truth.track), drive.log.commands.to_vec()))
}

fn in_town(town: &Town, effects: &Effects, seed: Seed) -> Result<CarWorld, Box<dyn Error>> {
    Ok(CarWorld::new(&CarConfig::default(), &town.ground(), None, effects, town.route.at(0.0).into(), seed)?)
}

fn at_the_wheel(town: &Town, seed: Seed) -> Driver {
    Driver::new(Driving::default(), Feel::default(), town.route.clone(), 0.0, seed.stream("drive"))
}

/// How far off the route a driver gets who does not know of the effect, and how far along it.
fn driven(town: &Town, effects: &Effects) -> Result<(f64, f64), Box<dyn Error>> {
    let seed = Seed(FIRST_SEED);
    let (mut car, mut driver) = (in_town(town, effects, seed)?, at_the_wheel(town, seed));
    let track = run(&mut car, &mut driver, DRIVE_S).truth.track;
    let (mut aside_m, mut along_m) = (0.0_f64, 0.0);
    for pose in track.iter() {
        along_m = town.route.along_m([pose.x_m, pose.y_m], along_m);
        let at = town.route.at(along_m);
        aside_m = aside_m.max((pose.x_m - at.x_m).hypot(pose.y_m - at.y_m));
    }
    Ok((aside_m, driver.along_m()))
}

/// Accelerations and yaw rates, step by step, of commands on a level plane.
fn played(commands: &[Command], effects: &Effects) -> Result<[Vec<f64>; 2], Box<dyn Error>> {
    let (config, ground) = (CarConfig::default(), Ground::level(3000.0));
    let mut car = CarWorld::new(&config, &ground, None, effects, Start::default(), Seed(FIRST_SEED))?;
    Ok(steps(&run(&mut car, &mut Replay(commands.to_vec()), DRIVE_S).truth.track))
}

/// Accelerations and yaw rates, step by step.
fn steps(track: &[TruePose]) -> [Vec<f64>; 2] {
    let poses: Vec<TruePose> =
        (0..=(DRIVE_S / STEP_S) as usize).filter_map(|i| pose_at(track, (i as f64 * STEP_S).min(DRIVE_S))).collect();
    let motions: Vec<[f64; 2]> = poses
        .windows(2)
        .map(|pair| {
            let turn = wrap_rad(pair[1].theta_rad - pair[0].theta_rad);
            let heading = pair[0].theta_rad + 0.5 * turn;
            let forward = (pair[1].y_m - pair[0].y_m) * heading.cos() - (pair[1].x_m - pair[0].x_m) * heading.sin();
            [forward / STEP_S, turn / STEP_S]
        })
        .collect();
    let accelerations = motions.windows(2).map(|pair| (pair[1][0] - pair[0][0]) / STEP_S).collect();
    [accelerations, motions[1..].iter().map(|it| it[1]).collect()]
}

/// Inverse covariances of what is taken for noise, of accelerations and of yaw rates.
fn whiteners(count: usize) -> [DMatrix<f64>; 2] {
    let slow = |k: usize, i: usize, j: usize| {
        TERRAIN[k] * TERRAIN[k] * (-(i.abs_diff(j) as f64) * STEP_S / TERRAIN_S[k]).exp()
    };
    let [way, angle] = [ODOMETRY[0] / (STEP_S * STEP_S), ODOMETRY[1] / STEP_S];
    let of = |k: usize| {
        let at = |i: usize, j: usize| match (k, i.abs_diff(j)) {
            (0, 0) => 2.0 * way * way,
            (0, 1) => -way * way,
            (1, 0) => angle * angle,
            _ => 0.0,
        };
        let covariance = DMatrix::from_fn(count, count, |i, j| at(i, j) + slow(k, i, j));
        covariance.cholesky().map_or_else(|| DMatrix::zeros(count, count), |it| it.inverse())
    };
    [of(0), of(1)]
}
