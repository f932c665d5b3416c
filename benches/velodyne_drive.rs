//! A drive of 200 s through a town: 99.84 million rays with their poses, noise and losses, on all cores.

use asami_dataset::Seed;
use asami_sim::scenes::town::{Town, TownConfig};
use asami_sim::sensors::velodyne::{Scenery, SensorPose, Unit, Velodyne, VelodyneConfig};
use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use nalgebra::UnitQuaternion;

const UNTIL_S: f64 = 200.0;
const PHYSICS_RATE_HZ: f64 = 200.0;
const SPEED_M_PER_S: f64 = 5.0;
const SENSOR_HEIGHT_M: f64 = 2.0;

fn velodyne_drive(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("velodyne drive of 200 s");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for detail in [0.0, 0.9] {
        let town = Town::new(&TownConfig { detail, ..TownConfig::default() }, Seed(1000));
        let reflectivity = |triangle: usize| town.surface[triangle].reflectivity();
        let scenery = Scenery::new(&town.vertices, &town.triangles, reflectivity).expect("a town is a mesh");
        let velodyne = Velodyne::new(VelodyneConfig::default(), Unit::art());
        let poses: Vec<SensorPose> =
            (0..=(UNTIL_S * PHYSICS_RATE_HZ) as usize).map(|step| pose(&town, step as f64 / PHYSICS_RATE_HZ)).collect();
        group.bench_function(format!("{} triangles", town.triangles.len()), |bencher| {
            bencher.iter(|| velodyne.scan(&scenery, &poses, Seed(1000)).expect("poses in order"));
        });
    }
}

/// Along the route, pitching and rolling a little.
fn pose(town: &Town, t_s: f64) -> SensorPose {
    let way = town.route.at(SPEED_M_PER_S * t_s);
    let world_from_sensor = UnitQuaternion::from_euler_angles(0.01 * t_s.sin(), 0.01 * t_s.cos(), way.theta_rad);
    SensorPose { t_s, position_m: [way.x_m, way.y_m, SENSOR_HEIGHT_M], world_from_sensor }
}

criterion_group!(benches, velodyne_drive);
criterion_main!(benches);
