//! Drives the car round its town and prints, for every seed, the ranges of acceleration, speed and yaw rate by steps
//! of half a second, how well equations 2.30 and 2.31 fit them, and what it costs. Draws the first drive.
//!
//! ```text
//! cargo run --example driving -- out 15 car.toml   # folder, number of seeds from 1000 on, [car], [town], [driving]
//! ```

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use asami_dataset::truth::pose_at;
use asami_dataset::{Action, Dataset, Seed};
use asami_math::angle::wrap_rad;
use asami_sim::drives::driver::{Driver, Driving, Feel};
use asami_sim::effects::Effects;
use asami_sim::robots::car::{CarConfig, CarWorld};
use asami_sim::scenes::town::{Town, TownConfig};
use asami_sim::sensors::velodyne::SensorPose;
use asami_sim::world::{dataset, record};
use nalgebra::{DMatrix, DVector, Vector3};
use serde::Deserialize;

/// Seeds below 1000 belong to the experiments.
const FIRST_SEED: u64 = 1000;
const DRIVE_S: f64 = 200.0;
/// Step of the dissertation's scans.
const STEP_S: f64 = 0.5;

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Setup {
    car: CarConfig,
    town: TownConfig,
    driving: Driving,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| ".".to_owned());
    let seeds: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let setup: Setup = match arguments.next() {
        None => Setup::default(),
        Some(path) => toml::from_str(&std::fs::read_to_string(path)?)?,
    };
    println!(
        "seed  acceleration       speed      yaw rate    way turns stops aside | 2.30  roll-out  2.31 | town drive"
    );
    for seed in (FIRST_SEED..FIRST_SEED + seeds).map(Seed) {
        let began = Instant::now();
        let town = Town::new(&setup.town, seed);
        let built_s = began.elapsed().as_secs_f64();
        let began = Instant::now();
        let start = town.route.at(0.0).into();
        let mut world = CarWorld::new(&setup.car, &town.ground(), None, &Effects::default(), start, seed)?;
        let mut driver =
            Driver::new(setup.driving.clone(), Feel::default(), town.route.clone(), 0.0, seed.stream("drive"));
        let mut made = record(&mut world, &mut driver, DRIVE_S);
        let drove_s = began.elapsed().as_secs_f64();
        let poses = std::mem::take(&mut made.sensor_poses);
        let drive = dataset(&world, made);
        let steps = steps(&drive);
        let range = |of: fn(&Step) -> f64| {
            let (low, high) = steps.iter().map(of).fold((f64::MAX, f64::MIN), |(l, h), it| (l.min(it), h.max(it)));
            format!("{low:6.3}..{high:5.3} = {:5.3}", high - low)
        };
        let turned: f64 = steps.iter().map(|step| step.yaw_rate * STEP_S).sum::<f64>().to_degrees();
        let (mut aside, mut along_m) = (0.0_f64, 0.0);
        for pose in drive.truth.track.iter() {
            along_m = town.route.along_m([pose.x_m, pose.y_m], along_m);
            let at = town.route.at(along_m);
            aside = aside.max((pose.x_m - at.x_m).hypot(pose.y_m - at.y_m));
        }
        let stops = steps.windows(2).filter(|pair| pair[0].speed >= 0.2 && pair[1].speed < 0.2).count();
        let ([a, v, w], modelled) = fit(&steps);
        println!(
            "{} {} {} {} {:4.0} m {turned:4.0} {stops} {aside:.2} | {a:.3} {v:.3} {w:.4} | {built_s:.2} {drove_s:.2} s",
            seed.0,
            range(|step| step.acceleration),
            range(|step| step.speed),
            range(|step| step.yaw_rate),
            driver.along_m(),
        );
        if seed.0 == FIRST_SEED {
            std::fs::write(Path::new(&folder).join("driving.svg"), picture(&drive, &poses, &steps, &modelled)?)?;
        }
    }
    Ok(())
}

/// What chapter 5 sees of a drive.
struct Step {
    t_s: f64,
    speed: f64,
    yaw_rate: f64,
    acceleration: f64,
    /// Mean throttle, brake and steering.
    pedals: [f64; 3],
}

fn steps(drive: &Dataset) -> Vec<Step> {
    let count = (DRIVE_S / STEP_S) as usize;
    let at = |i: usize| pose_at(&drive.truth.track, (i as f64 * STEP_S).min(DRIVE_S));
    let mut steps: Vec<Step> = (0..count)
        .filter_map(|i| {
            let (a, b) = (at(i)?, at(i + 1)?);
            let (dx, dy) = (b.x_m - a.x_m, b.y_m - a.y_m);
            let turn = wrap_rad(b.theta_rad - a.theta_rad);
            let heading = a.theta_rad + 0.5 * turn;
            let speed = (-dx * heading.sin() + dy * heading.cos()) / STEP_S;
            let t_s = i as f64 * STEP_S;
            let within = drive.log.commands.iter().filter(|it| (t_s..t_s + STEP_S).contains(&it.t_s));
            let (mut pedals, mut n) = ([0.0; 3], 0.0_f64);
            for command in within {
                if let Action::Pedals { throttle, brake, steering } = command.action {
                    pedals = [pedals[0] + throttle, pedals[1] + brake, pedals[2] + steering];
                    n += 1.0;
                }
            }
            let pedals = pedals.map(|it| it / n.max(1.0));
            Some(Step { t_s, speed, yaw_rate: turn / STEP_S, acceleration: 0.0, pedals })
        })
        .collect();
    for i in 1..steps.len() {
        steps[i - 1].acceleration = (steps[i].speed - steps[i - 1].speed) / STEP_S;
    }
    steps.pop();
    steps
}

/// Root-mean-square errors of acceleration and speed, rolled out, and of yaw rate, of equations 2.30 and 2.31 fitted
/// to the truth (Table 5.1's From-Truth: 0.254 m/s^2, 0.64 m/s, 0.013 rad/s).
fn fit(steps: &[Step]) -> ([f64; 3], Vec<[f64; 3]>) {
    let solve = |rows: Vec<Vec<f64>>, out: Vec<f64>| -> Option<DVector<f64>> {
        let a = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
        let b = DVector::from_vec(out);
        (a.transpose() * &a).cholesky().map(|it| it.solve(&(a.transpose() * b)))
    };
    let long = |v: f64, step: &Step| vec![1.0, step.pedals[0], v, v * step.pedals[1]];
    let turn = |v: f64, step: &Step| vec![v, v * step.pedals[2]];
    let c =
        solve(steps.iter().map(|it| long(it.speed, it)).collect(), steps.iter().map(|it| it.acceleration).collect());
    let k = solve(steps.iter().map(|it| turn(it.speed, it)).collect(), steps.iter().map(|it| it.yaw_rate).collect());
    let (Some(c), Some(k)) = (c, k) else { return ([f64::NAN; 3], Vec::new()) };
    let dot = |row: &[f64], c: &DVector<f64>| row.iter().zip(c.iter()).map(|(a, b)| a * b).sum::<f64>();
    let mut speed = steps.first().map_or(0.0, |it| it.speed);
    let mut sums = [0.0; 3];
    let mut modelled = Vec::new();
    for step in steps {
        let acceleration = dot(&long(speed, step), &c);
        modelled.push([speed, acceleration, dot(&turn(speed, step), &k)]);
        sums[0] += (acceleration - step.acceleration).powi(2);
        sums[1] += (speed - step.speed).powi(2);
        sums[2] += (dot(&turn(speed, step), &k) - step.yaw_rate).powi(2);
        speed += acceleration * STEP_S;
    }
    (sums.map(|it| (it / steps.len() as f64).sqrt()), modelled)
}

/// Curves over time, red the fitted model's, and the way from above.
fn picture(
    drive: &Dataset,
    poses: &[SensorPose],
    steps: &[Step],
    modelled: &[[f64; 3]],
) -> Result<String, Box<dyn Error>> {
    let track = &drive.truth.track;
    let pedal = |of: fn(f64, f64, f64) -> f64| -> Vec<[f64; 2]> {
        let value = |action: Action| match action {
            Action::Pedals { throttle, brake, steering } => of(throttle, brake, steering),
            Action::Legs { .. } | Action::Wheels { .. } => f64::NAN,
        };
        drive.log.commands.iter().map(|it| [it.t_s, value(it.action)]).collect()
    };
    let angle = |axis: Vector3<f64>| -> Vec<[f64; 2]> {
        let rise = |it: &SensorPose| (it.world_from_sensor * axis).z.asin().to_degrees();
        poses.iter().step_by(20).map(|it| [it.t_s, rise(it)]).collect()
    };
    let curves: Vec<(&str, Vec<[f64; 2]>)> = vec![
        ("speed m/s", track.iter().step_by(5).map(|it| [it.t_s, it.v_m_per_s.unwrap_or(f64::NAN)]).collect()),
        ("acceleration m/s2", steps.iter().map(|it| [it.t_s, it.acceleration]).collect()),
        ("throttle", pedal(|throttle, _, _| throttle)),
        ("brake", pedal(|_, brake, _| brake)),
        ("steering", pedal(|_, _, steering| steering)),
        ("yaw rate rad/s", steps.iter().map(|it| [it.t_s, it.yaw_rate]).collect()),
        ("pitch deg (nose up)", angle(Vector3::y())),
        ("roll deg (right side up)", angle(Vector3::x())),
        ("height m", poses.iter().step_by(20).map(|it| [it.t_s, it.position_m[2]]).collect()),
    ];
    let mut svg = String::from(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="1200" height="1560" font-family="sans-serif" font-size="12"><rect width="1200" height="1560" fill="white"/>"#,
    );
    for (i, (name, points)) in curves.iter().enumerate() {
        let top = 20.0 + 120.0 * i as f64;
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(l, h), it| (l.min(it[1]), h.max(it[1])));
        write!(svg, r##"<rect x="40" y="{top}" width="1140" height="105" fill="none" stroke="#bbb"/>"##)?;
        write!(svg, r#"<text x="46" y="{}">{name}: {low:.3} to {high:.3}</text>"#, top + 13.0)?;
        let mut draw = |points: &[[f64; 2]], colour: &str| {
            let mut line = String::new();
            for [t_s, value] in points {
                let y = top + 100.0 - 82.0 * (value - low) / (high - low).max(1e-9);
                write!(line, "{:.1},{y:.1} ", 40.0 + 1140.0 * t_s / DRIVE_S)?;
            }
            write!(svg, r#"<polyline points="{line}" fill="none" stroke="{colour}"/>"#)
        };
        draw(points, "blue")?;
        if let Some(of) = ["speed m/s", "acceleration m/s2", "yaw rate rad/s"].iter().position(|it| it == name) {
            let model: Vec<[f64; 2]> = steps.iter().zip(modelled).map(|(step, it)| [step.t_s, it[of]]).collect();
            draw(&model, "red")?;
        }
        let zero = top + 100.0 + 82.0 * low / (high - low).max(1e-9);
        if low < 0.0 && high > 0.0 {
            write!(svg, r##"<line x1="40" x2="1180" y1="{zero:.1}" y2="{zero:.1}" stroke="#ccc"/>"##)?;
        }
    }
    let mut line = String::new();
    for pose in track.iter().step_by(10) {
        write!(line, "{:.1},{:.1} ", 600.0 + 1.7 * pose.x_m, 1320.0 - 1.7 * pose.y_m)?;
    }
    write!(svg, r##"<polyline points="{line}" fill="none" stroke="#c30"/></svg>"##)?;
    Ok(svg)
}
