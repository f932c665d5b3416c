//! Rays per second, on a town of 35 thousand triangles and on one of 670 thousand.

use std::hint::black_box;

use asami_raycast::{Bundle, Caster, Hits, Instructions, Packets, Parry, Ray};
use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use rayon::prelude::*;

#[path = "../tests/scenes/mod.rs"]
mod scenes;

fn cast_each(caster: &dyn Caster, bundles: &[Bundle]) -> f64 {
    let mut hits = Hits::none();
    let mut sum = 0.0;
    for bundle in bundles {
        caster.cast(black_box(bundle), 120.0, &mut hits);
        sum += f64::from(hits.range[0].min(120.0));
    }
    sum
}

/// One core; criterion's rate is rays per second.
fn one_core(criterion: &mut Criterion) {
    let bundles = scenes::drive(10);
    for fine in [false, true] {
        let scene = scenes::town(fine);
        let packets = Packets::new(&scene.vertices, &scene.triangles).expect("a mesh");
        let parry = Parry::new(&scene.vertices, &scene.triangles).expect("a mesh");
        let mut group = criterion.benchmark_group(format!("{} triangles", scene.triangles.len()));
        group.sampling_mode(SamplingMode::Flat).sample_size(10);
        group.throughput(Throughput::Elements((bundles.len() * Bundle::RAYS) as u64));
        for kind in Instructions::ALL {
            if let Some(caster) = packets.clone().with(kind) {
                let id = BenchmarkId::new("packets", format!("{kind:?}"));
                group.bench_function(id, |bencher| bencher.iter(|| cast_each(&caster, &bundles)));
            }
        }
        let some = &bundles[..bundles.len() / 10];
        group.throughput(Throughput::Elements((some.len() * Bundle::RAYS) as u64));
        group.bench_function("parry3d", |bencher| bencher.iter(|| cast_each(&parry, some)));
    }
}

/// A drive of 200 s on two threads.
fn two_cores(criterion: &mut Criterion) {
    let bundles = scenes::drive(20);
    let rounds = 100_000_000_usize.div_ceil(bundles.len() * Bundle::RAYS);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for fine in [false, true] {
        let scene = scenes::town(fine);
        let packets = Packets::new(&scene.vertices, &scene.triangles).expect("a mesh");
        let mut group = criterion.benchmark_group(format!("{} triangles", scene.triangles.len()));
        group.sampling_mode(SamplingMode::Flat).sample_size(10);
        group.bench_function("100 million rays on two threads", |bencher| {
            bencher.iter(|| {
                threads.install(|| {
                    (0..rounds)
                        .flat_map(|_| bundles.chunks(1024))
                        .collect::<Vec<_>>()
                        .into_par_iter()
                        .map(|bundles| cast_each(&packets, bundles))
                        .collect::<Vec<_>>()
                })
            });
        });
    }
}

criterion_group!(benches, one_core, two_cores);
criterion_main!(benches);
