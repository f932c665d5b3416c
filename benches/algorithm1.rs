//! Algorithm 1 over a log of 150 s, and its time per observation.

use std::hint::black_box;
use std::sync::Arc;

use asami_dataset::models::Curve;
use asami_dataset::{Action, ActionModel, Command, Known, Log, Models, Seed, Sighting, Size};
use asami_learners::Learner;
use asami_learners::algorithm1::Algorithm1;
use asami_math::polynomial::Polynomial;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;

const OBSERVATIONS: u32 = 3000;

/// To and fro between 1.3 and 3.5 m at random speeds of 3 s each, seen 20 times a second.
fn log() -> Log {
    let mut rng = Seed(0).stream("bench");
    let (mut place_m, mut forward, mut speed_m_per_s) = (2.4, true, 0.0);
    let (mut commands, mut sightings) = (Vec::new(), Vec::new());
    for i in 0..OBSERVATIONS {
        let t_s = f64::from(i) / 20.0;
        let turn = if forward { place_m < 1.3 } else { place_m > 3.5 };
        forward ^= turn;
        if turn || i % 60 == 0 {
            speed_m_per_s = rng.random::<f64>() * if forward { 0.3 } else { -0.3 };
            let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: speed_m_per_s, atheta_rad_per_s: 0.0 };
            commands.push(Command { t_s, action });
        }
        let size = Size::HeightPx(38.3887 / place_m + rng.random::<f64>() - 0.5);
        sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad: 0.0 });
        place_m -= 0.8 * speed_m_per_s / 20.0;
    }
    let known = Arc::new(Known { robot: "aibo".to_owned(), ..Known::default() });
    Log { known, commands: commands.into(), sightings: sightings.into(), ..Log::default() }
}

fn algorithm1(criterion: &mut Criterion) {
    let log = log();
    let start = ActionModel::Polynomial(Curve::from(Polynomial::plain(vec![0.0, 1.0])));
    let given = Models { action: Some(start), ..Models::default() };
    let learner = Algorithm1::default();
    let mut rng = Seed(0).stream("learner");
    let mut group = criterion.benchmark_group("algorithm1");
    group.throughput(Throughput::Elements(u64::from(OBSERVATIONS)));
    group.bench_function("150 s", |bencher| bencher.iter(|| learner.learn(black_box(&log), &given, &mut rng)));
    group.finish();
}

criterion_group!(benches, algorithm1);
criterion_main!(benches);
