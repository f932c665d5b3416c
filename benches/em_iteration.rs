//! EM in the plane: time per iteration and 1000 steps, and to convergence on a log of 15 minutes.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};

#[allow(dead_code)]
#[path = "../learners/tests/chapter4/synthetic.rs"]
mod synthetic;

use synthetic::{Walker, learn, published};

const ITERATIONS: f64 = 50.0;

fn iteration(criterion: &mut Criterion) {
    let walker = Walker::default();
    let log = walker.log(1000);
    let mut group = criterion.benchmark_group("em_iteration");
    group.sample_size(10).throughput(Throughput::Elements((ITERATIONS * walker.steps as f64) as u64));
    for name in ["em_published", "em_rts", "em_exact", "em_best"] {
        let with = [("max_iterations", ITERATIONS)];
        group.bench_function(name, |bencher| bencher.iter(|| learn(name, &with, black_box(&log), &published())));
    }
    group.finish();
}

fn convergence(criterion: &mut Criterion) {
    let log = Walker::default().log(1000);
    let mut group = criterion.benchmark_group("em_convergence");
    group.sample_size(10);
    for name in ["em_squarem", "em_best"] {
        group.bench_function(name, |bencher| bencher.iter(|| learn(name, &[], black_box(&log), &published())));
    }
    group.finish();
}

criterion_group!(benches, iteration, convergence);
criterion_main!(benches);
