//! One engine step of the walking Aibo.

mod walk;

use asami_sim::robots::aibo::engine::Engine as _;
use criterion::{Criterion, criterion_group, criterion_main};

fn physics_step(criterion: &mut Criterion) {
    let mut walk = walk::Walk::new().expect("the shipped body");
    let (settle_steps, steps_per_tick) =
        ((walk.config.physics.settle_s / walk.config.physics.time_step_s) as u64, walk.config.physics.steps_per_tick);
    for _ in 0..settle_steps {
        walk.body.step();
    }
    let mut steps = 0;
    criterion.bench_function("physics step, walking", |bencher| {
        bencher.iter(|| {
            if steps % steps_per_tick == 0 {
                walk.aim();
            }
            steps += 1;
            walk.body.step();
        });
    });
}

criterion_group!(benches, physics_step);
criterion_main!(benches);
