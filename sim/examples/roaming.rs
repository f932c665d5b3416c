//! Lets the Aibo explore a field and prints how it fared: falls, what it sees, how well heights and bearings fit
//! the places of beacons and body, and what it costs.
//!
//! ```text
//! cargo run --example roaming -- robot.toml 900 3   # the tables [aibo], [camera], [field], [suite] and [drive]
//! ```

use std::error::Error;
use std::time::Instant;

use asami_dataset::{Dataset, Seed, Size, TruePose};
use asami_math::angle::wrap_rad;
use asami_sim::drives::explore::{Explore, Exploring};
use asami_sim::drives::suite::Suite;
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, Start};
use asami_sim::scenes::field::Field;
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::run;
use serde::Deserialize;

/// Seeds below 1000 belong to the experiments.
const FIRST_SEED: u64 = 1000;

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Robot {
    aibo: AiboConfig,
    camera: CameraConfig,
    field: Field,
    suite: Suite,
    drive: Exploring,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let robot: Robot = match arguments.next() {
        None => Robot::default(),
        Some(path) => toml::from_str(&std::fs::read_to_string(path)?)?,
    };
    let until_s: f64 = arguments.next().map_or(Ok(900.0), |text| text.parse())?;
    let logs: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    for seed in (FIRST_SEED..FIRST_SEED + logs).map(Seed) {
        let (start, effects) = (Start::default(), Effects::default());
        let mut world = AiboWorld::new(&robot.aibo, &robot.field, &robot.camera, &effects, start, seed)?;
        let mut drive = Explore::new(robot.drive.clone(), robot.suite.actions(), seed.stream("drive"));
        let began = Instant::now();
        let dataset = run(&mut world, &mut drive, until_s);
        let took_s = began.elapsed().as_secs_f64();
        println!("seed {}: fallen {}, {took_s:.1} s", seed.0, world.has_fallen());
        report(&robot, &dataset);
    }
    Ok(())
}

/// One sighting against the truth.
struct Residual {
    landmark: u16,
    distance_m: f64,
    height_px: f64,
    bearing_rad: f64,
    pan_rad: f64,
}

fn report(robot: &Robot, dataset: &Dataset) {
    let track = &dataset.truth.track;
    let frames = dataset.log.frames.as_deref().unwrap_or_default();
    let mut residuals = vec![];
    let mut next = 0;
    for sighting in dataset.log.sightings.iter() {
        while track[next].t_s < sighting.t_s {
            next += 1;
        }
        let pose: &TruePose = &track[next];
        let Some(beacon) = robot.field.beacons.iter().find(|beacon| beacon.id == sighting.landmark) else { continue };
        let Size::HeightPx(height_px) = sighting.size else { continue };
        let (dx, dy) = (beacon.body.x_m - pose.x_m, beacon.body.y_m - pose.y_m);
        let bearing_rad = wrap_rad(sighting.bearing_rad - wrap_rad((-dx).atan2(dy) - pose.theta_rad));
        let pan_rad = frames[next].head_pan_rad;
        residuals.push(Residual { landmark: beacon.id, distance_m: dx.hypot(dy), height_px, bearing_rad, pan_rad });
    }
    let seen = |id: u16| residuals.iter().filter(|residual| residual.landmark == id).count();
    let by_beacon: Vec<usize> = robot.field.beacons.iter().map(|beacon| seen(beacon.id)).collect();
    let gone = residuals.iter().filter(|residual| residual.bearing_rad.abs() > 0.2).count();
    println!("{} frames, {} sightings {by_beacon:?}, {gone} of them false", track.len(), residuals.len());
    let farthest = |of: &dyn Fn(&TruePose) -> f64| track.iter().map(|pose| of(pose).abs()).fold(0.0, f64::max);
    println!("within x +-{:.2} m, y +-{:.2} m", farthest(&|pose| pose.x_m), farthest(&|pose| pose.y_m));
    residuals.retain(|residual| residual.bearing_rad.abs() <= 0.2);
    println!("   m    n  height px  analytic    sd | bearing: mean     sd");
    for tenth in 5..50 {
        let low_m = 0.1 * f64::from(tenth);
        let here: Vec<&Residual> = residuals.iter().filter(|r| (low_m..low_m + 0.1).contains(&r.distance_m)).collect();
        if here.len() < 5 {
            continue;
        }
        let (height, _) = mean_sd(here.iter().map(|r| r.height_px));
        let (analytic, _) = mean_sd(here.iter().map(|r| 38.3887 / r.distance_m));
        let (_, sd) = mean_sd(here.iter().map(|r| r.height_px - height * low_m / r.distance_m));
        let (bias, bearing_sd) = mean_sd(here.iter().map(|r| r.bearing_rad));
        println!("{low_m:4.1} {:5} {height:9.2} {analytic:9.2} {sd:6.2} |   {bias:9.4} {bearing_sd:7.4}", here.len());
    }
    let (bias, sd) = mean_sd(residuals.iter().map(|r| r.bearing_rad));
    println!("bearing residual over all: mean {bias:.4} sd {sd:.4}");
    for pan in -8..8 {
        let low = 0.2 * f64::from(pan);
        let here = residuals.iter().filter(|r| (low..low + 0.2).contains(&r.pan_rad));
        let (bias, sd) = mean_sd(here.clone().map(|r| r.bearing_rad));
        println!("pan {low:5.1}: {:5} bearing mean {bias:8.4} sd {sd:7.4}", here.count());
    }
}

fn mean_sd(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt())
}
