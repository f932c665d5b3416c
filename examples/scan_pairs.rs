//! Scans of a laser scanner, how the car moved, and how `car_lines` matches one to the next, for `benches/peers/scan_matching.py`.
//!
//! ```text
//! cargo run --example scan_pairs -- FOLDER ../shared/data/kitti_drive0005
//! cargo run --example scan_pairs -- FOLDER scenarios/car.toml 1000 40
//! ```
//!
//! Takes a folder of KITTI's, or a scenario with a seed and a number of seconds. Writes into FOLDER: of each whole turn its returns in order
//! of firing, `points.f32` (x, y, z in the scanner's frame where and when each was measured, by the lasers' true angles) and `times.f64`;
//! `turns.f64` (beginning, end and number of points); `track.f64` (time, x, y, theta: 0 faces +y). Prints a line of JSON. Then, for every line with a number of seconds on its
//! standard input, matches scans so far apart (0: every turn), each with the next, and prints seconds of the thread's own time and
//! the motions: from when, over how long, x, y and turn.

#[path = "beside_peers/mod.rs"]
mod beside_peers;

use std::error::Error;
use std::io::BufRead;
use std::path::{Path, PathBuf};

use asami::import::kitti;
use asami_dataset::Dataset;
use asami_learners::car_lines::CarLines;
use asami_learners::lidar::{AsOf, Drive, Odometry};
use serde_json::json;

use beside_peers::{simulated, thread_s, write};

/// Nearer returns are the car's own.
const NEAREST_M: f64 = 2.5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let dataset = match &arguments[..] {
        [_, source] => kitti::read(Path::new(source))?.dataset,
        [_, scenario, seed, seconds] => simulated(Path::new(scenario), seed.parse()?, seconds.parse()?)?,
        _ => return Err("scan_pairs FOLDER SOURCE, or FOLDER SCENARIO SEED SECONDS".into()),
    };
    let folder = PathBuf::from(&arguments[0]);
    let Dataset { log, truth, .. } = &dataset;
    let drive = Drive::try_from(log)?;
    let survey = truth.survey.as_ref().ok_or("nobody knows the lasers' true angles")?;
    let angles_rad = &survey.horizontal_angles_rad;
    let turns = drive.scans(0.0);
    let (mut points, mut times, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for turn in &turns {
        let mut returns = Vec::new();
        drive.returns(turn, angles_rad, f64::NEG_INFINITY, |_, firing, point| {
            if point.iter().map(|v| v * v).sum::<f64>() > NEAREST_M * NEAREST_M {
                returns.push((firing, point));
            }
        });
        returns.sort_by_key(|(firing, _)| *firing);
        let t_s = &drive.firings.t_s;
        ends.extend([turn.t_s, t_s[turn.end - 1], returns.len() as f64]);
        times.extend(returns.iter().map(|(firing, _)| t_s[*firing]));
        points.extend(returns.iter().flat_map(|(_, point)| point.map(|v| v as f32)));
    }
    let track = truth.track.iter().flat_map(|pose| [pose.t_s, pose.x_m, pose.y_m, pose.theta_rad]);
    write(&folder.join("points.f32"), points.iter().map(|v| v.to_le_bytes()))?;
    write(&folder.join("times.f64"), times.iter().map(|v| v.to_le_bytes()))?;
    write(&folder.join("turns.f64"), ends.iter().map(|v| v.to_le_bytes()))?;
    write(&folder.join("track.f64"), track.map(f64::to_le_bytes))?;
    println!("{}", json!({ "turns": turns.len(), "points": times.len() }));

    let car = CarLines::default().car();
    for line in std::io::stdin().lock().lines() {
        let scans = drive.scans(line?.trim().parse()?);
        let (cut, matching, as_of) = (car.cut, car.matching, AsOf::Middle);
        let odometry = Odometry { drive: &drive, scans: &scans, angles_rad, cut, matching, as_of };
        let begun_s = thread_s();
        let found = odometry.in_motion(&[]);
        let spent_s = thread_s() - begun_s;
        let motions: Vec<[f64; 5]> = found
            .iter()
            .flatten()
            .map(|it| {
                let step = &it.later_from_earlier;
                [it.t_s, it.dt_s, step.x, step.y, step.turn_rad]
            })
            .collect();
        println!("{}", json!({ "seconds": spent_s, "pairs": found.len(), "motions": motions }));
    }
    Ok(())
}
