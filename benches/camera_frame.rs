//! One camera frame: taking the picture, and making sightings of it.

use std::hint::black_box;

use asami_dataset::Seed;
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::sensors::camera::{Camera, CameraConfig};
use asami_sim::sensors::vision::{Neck, Pattern, Vision};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

fn camera_frame(criterion: &mut Criterion) {
    let bands = [Colour::Pink, Colour::Yellow];
    let body = Cylinder { x_m: 0.0, y_m: 1.5, radius_m: 0.05, base_m: 0.1, height_m: 0.2, bands };
    let field = Field { beacons: vec![Landmark { id: 0, body }], clutter: vec![] };
    let config = CameraConfig::default();
    let mut camera = Camera::new(&config, &field, Seed(0).stream("camera"));
    let neck = Neck { axis_ahead_m: 0.1, camera_ahead_m: 0.1 };
    let mut vision = Vision::new(&config, neck, field.beacons.iter().map(Pattern::from).collect());

    // Looking along world +y from 0.2 m above the ground, nodding and rolling a little.
    let pose = |nod_rad: f64| {
        let turn = UnitQuaternion::from_euler_angles(-std::f64::consts::FRAC_PI_2 + nod_rad, 0.02, 0.0);
        Isometry3::from_parts(Translation3::new(0.0, 0.0, 0.2), turn)
    };
    let (open, close) = (pose(0.0), pose(0.004));
    criterion.bench_function("camera frame", |bencher| {
        bencher.iter(|| {
            camera.look(black_box(&open), black_box(&close));
        });
    });
    let image = camera.look(&open, &close).clone();
    assert_eq!(vision.sight(&image, 0.0).len(), 1, "the beacon is in sight");
    criterion.bench_function("vision of one frame", |bencher| bencher.iter(|| vision.sight(black_box(&image), 0.0)));
}

criterion_group!(benches, camera_frame);
criterion_main!(benches);
