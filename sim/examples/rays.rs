//! A town, the rays of a Velodyne that drives through it, and how long the house's caster takes for them.
//!
//! `cargo run --release -p asami-sim --example rays -- FOLDER [DETAIL]` writes `vertices.f32`, `triangles.u32`, `rays.f32`
//! (component by component: three of the origins, three of the directions) into the folder and prints one line of JSON.
//! Then, for every line on its standard input, it casts all rays with each set of instructions, prints the seconds of the thread's own time, and
//! writes the ranges to `ranges.f32`.

use std::io::{BufRead, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use asami_dataset::Seed;
use asami_raycast::{Bundle, Caster, Hits, Instructions, Packets};
use asami_sim::scenes::town::{Town, TownConfig};
use asami_sim::sensors::velodyne::{SensorPose, Unit, Velodyne, VelodyneConfig};
use nalgebra::UnitQuaternion;

/// Revolutions, one every 10 s of the drive.
const REVOLUTIONS: usize = 20;
/// Casts of all rays that are timed together: the system's account of a thread's time is some milliseconds late.
const PASSES: u32 = 5;
const SPEED_M_PER_S: f64 = 5.0;
const SENSOR_HEIGHT_M: f64 = 2.0;
const REACH_M: f32 = 120.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("rays FOLDER [DETAIL]")?);
    let detail = arguments.next().map_or(Ok(0.0), |detail| detail.parse())?;
    let town = Town::new(&TownConfig { detail, ..TownConfig::default() }, Seed(1000));
    let bundles = bundles(&town)?;

    write(&folder.join("vertices.f32"), town.vertices.iter().flatten().map(|x| x.to_le_bytes()))?;
    write(&folder.join("triangles.u32"), town.triangles.iter().flatten().map(|x| x.to_le_bytes()))?;
    let component = |of: fn(&Bundle) -> &[[f32; Bundle::RAYS]; 3], axis: usize| {
        bundles.iter().flat_map(move |bundle| of(bundle)[axis])
    };
    let origins = (0..3).flat_map(|axis| component(|bundle| &bundle.origin, axis));
    let directions = (0..3).flat_map(|axis| component(|bundle| &bundle.direction, axis));
    write(&folder.join("rays.f32"), origins.chain(directions).map(f32::to_le_bytes))?;
    let now = Instant::now();
    let packets = Packets::new(&town.vertices, &town.triangles)?;
    println!(
        r#"{{"triangles": {}, "rays": {}, "reach_m": {REACH_M}, "build_s": {:.3}}}"#,
        town.triangles.len(),
        bundles.len() * Bundle::RAYS,
        now.elapsed().as_secs_f64(),
    );

    let casters: Vec<Packets> = Instructions::ALL.into_iter().filter_map(|kind| packets.clone().with(kind)).collect();
    for line in std::io::stdin().lock().lines() {
        line?;
        let mut report = Vec::new();
        for caster in casters.iter().rev() {
            let mut hits = vec![Hits::none(); bundles.len()];
            let begun_s = thread_s();
            for _ in 0..PASSES {
                for (bundle, hits) in bundles.iter().zip(&mut hits) {
                    caster.cast(bundle, REACH_M, hits);
                }
            }
            let pass_s = (thread_s() - begun_s) / f64::from(PASSES);
            report.push(format!(r#""{:?}": {pass_s:.6}"#, caster.instructions()));
            write(&folder.join("ranges.f32"), hits.iter().flat_map(|hits| hits.range).map(f32::to_le_bytes))?;
        }
        println!("{{{}}}", report.join(", "));
    }
    Ok(())
}

fn bundles(town: &Town) -> Result<Vec<Bundle>, Box<dyn std::error::Error>> {
    let config = VelodyneConfig::default();
    let velodyne = Velodyne::new(config.clone(), Unit::art());
    let mut bundles = Vec::new();
    for revolution in 0..REVOLUTIONS {
        let start_s = 10.0 * revolution as f64;
        let pose = |t_s: f64| {
            let way = town.route.at(SPEED_M_PER_S * t_s);
            let world_from_sensor =
                UnitQuaternion::from_euler_angles(0.01 * t_s.sin(), 0.01 * t_s.cos(), way.theta_rad);
            SensorPose { t_s, position_m: [way.x_m, way.y_m, SENSOR_HEIGHT_M], world_from_sensor }
        };
        let poses: Vec<SensorPose> =
            (0..=20).map(|step| pose(start_s + f64::from(step) / (20.0 * config.turn_rate_hz))).collect();
        bundles.extend(velodyne.bundles(&poses)?);
    }
    Ok(bundles)
}

/// The processor's time that this thread has had, where the system tells; else the time of day.
fn thread_s() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat");
    let ran_ns = told.ok().and_then(|told| told.split_whitespace().next()?.parse::<f64>().ok());
    let day = || std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |since| since.as_secs_f64());
    ran_ns.map_or_else(day, |ran_ns| 1e-9 * ran_ns)
}

fn write(path: &Path, numbers: impl Iterator<Item = [u8; 4]>) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    for number in numbers {
        file.write_all(&number)?;
    }
    file.flush()
}
