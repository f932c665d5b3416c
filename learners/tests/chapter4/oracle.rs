//! The E-step and the M-step against the linear Kalman smoother, and against numerical integration.

use std::sync::Arc;

use asami_dataset::log::Frame;
use asami_dataset::models::Entry;
use asami_dataset::{
    Action, ActionModel, Beacon, Command, Known, Log, Models, Noise, Seed, SensorModel, Sighting, Size,
};
use asami_learners::em::curve::SizeCurve;
use asami_learners::em::filter::{About, Forward};
use asami_learners::em::parameters::Parameters;
use asami_learners::em::sums::Sums;
use asami_learners::em::track::Track;
use asami_learners::em::world::Problem;
use asami_learners::em::{Acceleration, Em, Expectation, MotionNoise, Outliers, smoother, two_filter};
use asami_learners::plane::Plane;
use asami_math::elementary::exp;
use asami_math::kalman::{Gaussian, Motion, Observation};
use asami_math::polynomial::Polynomial;
use nalgebra::{SMatrix, SVector, Vector1};
use rand::RngExt;

fn one(x: f64) -> SMatrix<f64, 1, 1> {
    SMatrix::<f64, 1, 1>::new(x)
}

/// A pacing robot with two actions, seen from ahead in most frames.
fn log(frames: u32, seed: u64, f: &Polynomial) -> Log {
    let mut rng = Seed(seed).stream("line");
    let (mut place, mut commands, mut looks) = (-2.5, Vec::new(), Vec::new());
    for i in 0..frames {
        let t_s = 0.1 * f64::from(i);
        let forward = (i / 10) % 2 == 0;
        if i % 10 == 0 {
            let action =
                Action::Legs { id: Some(u16::from(forward)), ax_m_per_s: 0.0, ay_m_per_s: 0.2, atheta_rad_per_s: 0.0 };
            commands.push(Command { t_s, action });
        }
        if rng.random::<f64>() < 0.7 {
            let size = f.at(-place) + 0.5 * (rng.random::<f64>() - 0.5);
            looks.push(Sighting { t_s, landmark: 0, size: Size::HeightPx(size), bearing_rad: 0.0 });
        }
        place += if forward { 0.06 } else { -0.055 } + 0.02 * (rng.random::<f64>() - 0.5);
    }
    let times = (0..frames).map(|i| Frame { t_s: 0.1 * f64::from(i), head_pan_rad: 0.0 });
    Log {
        known: Arc::new(Known {
            landmarks: vec![Beacon { id: 0, x_m: 0.0, y_m: 0.0, height_m: None }],
            ..Known::default()
        }),
        commands: commands.into(),
        frames: Some(times.collect::<Vec<_>>().into()),
        sightings: looks.into(),
        ..Log::default()
    }
}

fn lambda(f: &Polynomial) -> Parameters<1> {
    let v = |v: f64| Vector1::new(v);
    Parameters {
        velocity: vec![v(-0.5), v(0.55)],
        motion_var: vec![v(1e-4), v(2e-4)],
        f: SizeCurve::new(f, f.coefficients.len(), 2.0, 1.5),
        size_var: 0.04,
        bearing_var: 1.0,
        common_share: 0.0,
        false_share: 0.0,
        false_log_density: 0.0,
        prior: Gaussian { mean: v(-2.4), covariance: v(0.3) },
    }
}

/// The states given all data, by the library's Kalman filter and smoother, and the log-likelihood; with the
/// covariance of each state with the one before.
fn kalman(plane: &Plane, lambda: &Parameters<1>, a: f64, b: f64) -> (Vec<Gaussian<1>>, Vec<f64>, f64) {
    let (mut state, mut filtered, mut sum) = (lambda.prior, Vec::new(), 0.0);
    let motion = |t: usize| {
        let frame = &plane.frames[t];
        let length = frame.dt_s / plane.step_s;
        let drift = lambda.velocity[frame.action] * frame.dt_s;
        Motion { f: one(1.0), drift, q: lambda.motion_var[frame.action] * length }
    };
    for t in 0..plane.frames.len() {
        if t > 0 {
            state = state.predict(&motion(t - 1));
        }
        for seen in plane.seen(t) {
            // size = a + b d, d = -w.
            let seen = Observation { h: one(-b), y: one(seen.size - a), r: one(lambda.size_var) };
            let update = state.update(&seen).unwrap();
            sum += update.log_likelihood();
            state = update.state;
        }
        filtered.push(state);
    }
    let (mut smoothed, mut crosses) = (vec![state], Vec::new());
    for t in (0..filtered.len() - 1).rev() {
        let (now, cross) = filtered[t].smooth(&motion(t), smoothed.last().unwrap()).unwrap();
        smoothed.push(now);
        crosses.push(cross[0]);
    }
    smoothed.reverse();
    crosses.reverse();
    (smoothed, crosses, sum)
}

#[test]
fn on_a_linear_problem_they_are_kalmans_filter_and_smoother() {
    let f = Polynomial::plain(vec![40.0, -6.0]);
    let log = log(400, 1, &f);
    let plane = Plane::along_a_line(&log).unwrap();
    let lambda = lambda(&f);
    let (expected, crosses, log_likelihood) = kalman(&plane, &lambda, 40.0, -6.0);
    let problem = Problem { world: &Track, plane: &plane };
    let (mut forward, mut weights) = (Forward::new(400), vec![1.0; plane.sightings.len()]);
    forward.run(problem, &lambda, About::Own, &mut weights, false).unwrap();
    assert!((forward.log_likelihood - log_likelihood).abs() < 1e-8, "{} {log_likelihood}", forward.log_likelihood);

    let mut rng = Seed(1).stream("samples");
    let mut sums = Sums::new(true, &plane, lambda.f, false, &mut rng);
    let mut smoothed = forward.alpha.clone();
    smoother::backward(problem, &lambda, About::Own, &forward, &weights, &mut smoothed, Some(&mut sums)).unwrap();
    for (found, expected) in smoothed.iter().zip(&expected) {
        assert!((found.mean - expected.mean).norm() < 1e-9 && (found.covariance - expected.covariance).norm() < 1e-9);
    }
    // E D and E D^2 of each action.
    let mut d = [[0.0; 2]; 2];
    for t in 0..399 {
        let mean = expected[t + 1].mean[0] - expected[t].mean[0];
        let var = expected[t + 1].covariance[0] + expected[t].covariance[0] - 2.0 * crosses[t];
        let sums = &mut d[plane.frames[t].action];
        *sums = [sums[0] + mean, sums[1] + mean * mean + var];
    }
    for (found, expected) in sums.actions.iter().zip(d) {
        assert!((found.d[0] - expected[0]).abs() < 1e-9 && (found.d2[0] - expected[1]).abs() < 1e-9);
    }

    // Two filters are the smoother, but for what the vague start of the second says.
    let mut rng = Seed(1).stream("samples");
    let mut both = Sums::new(false, &plane, lambda.f, false, &mut rng);
    two_filter::backward(problem, &lambda, &forward, &weights, &mut both).unwrap();
    for (found, expected) in both.actions.iter().zip(d) {
        assert!((found.d[0] - expected[0]).abs() < 1e-4, "{} {}", found.d[0], expected[0]);
    }
    let first = both.first.unwrap();
    assert!((first.mean - expected[0].mean).norm() < 1e-4 && (first.covariance - expected[0].covariance).norm() < 1e-4);
}

#[test]
fn on_a_tiny_problem_they_are_the_integral() {
    // Three frames, a bent f, all states on a grid.
    let f = Polynomial { coefficients: vec![20.0, -9.0, 3.0], centre: 2.4, scale: 1.0 };
    let mut log = log(3, 5, &f);
    let look = |t_s: f64, size: f64| Sighting { t_s, landmark: 0, size: Size::HeightPx(size), bearing_rad: 0.0 };
    log.sightings = vec![look(0.0, 20.6), look(0.1, 20.1), look(0.2, 21.4)].into();
    let plane = Plane::along_a_line(&log).unwrap();
    let mut lambda = lambda(&f);
    lambda.velocity = vec![Vector1::new(0.5)];
    lambda.motion_var = vec![Vector1::new(4e-4)];
    lambda.prior = Gaussian { mean: Vector1::new(-2.4), covariance: Vector1::new(0.01) };
    let normal = |x: f64, var: f64| exp(-0.5 * x * x / var) / (std::f64::consts::TAU * var).sqrt();
    let seen: Vec<f64> = plane.sightings.iter().map(|seen| seen.size).collect();
    const CELLS: usize = 160;
    let place = |i: usize| -2.75 + 0.7 * (i as f64 + 0.5) / CELLS as f64;
    let cell = 0.7 / CELLS as f64;
    let (mut total, mut means, mut d2) = (0.0, [0.0; 3], 0.0);
    for i in 0..CELLS {
        let a = normal(place(i) + 2.4, 0.01) * normal(seen[0] - f.at(-place(i)), 0.04);
        for j in 0..CELLS {
            let b = a * normal(place(j) - place(i) - 0.05, 4e-4) * normal(seen[1] - f.at(-place(j)), 0.04);
            for k in 0..CELLS {
                let p = b * normal(place(k) - place(j) - 0.05, 4e-4) * normal(seen[2] - f.at(-place(k)), 0.04);
                total += p;
                means = [means[0] + p * place(i), means[1] + p * place(j), means[2] + p * place(k)];
                d2 += p * ((place(j) - place(i)).powi(2) + (place(k) - place(j)).powi(2));
            }
        }
    }
    let log_likelihood = asami_math::elementary::ln(total * cell.powi(3));
    let problem = Problem { world: &Track, plane: &plane };
    let (mut forward, mut weights) = (Forward::new(3), vec![1.0; 3]);
    forward.run(problem, &lambda, About::Own, &mut weights, false).unwrap();
    let mut states = forward.alpha.clone();
    let mut smoothed = states.clone();
    smoother::backward(problem, &lambda, About::Own, &forward, &weights, &mut states, None).unwrap();
    let mut rng = Seed(1).stream("samples");
    let mut sums = Sums::new(true, &plane, lambda.f, false, &mut rng);
    for sweep in 0..6 {
        let about = About::States(&states);
        forward.run(problem, &lambda, about, &mut weights, false).unwrap();
        let sums = (sweep == 5).then_some(&mut sums);
        smoother::backward(problem, &lambda, about, &forward, &weights, &mut smoothed, sums).unwrap();
        std::mem::swap(&mut states, &mut smoothed);
    }
    assert!((forward.log_likelihood - log_likelihood).abs() < 5e-3, "{} {log_likelihood}", forward.log_likelihood);
    for (found, expected) in states.iter().zip(means) {
        // A fiftieth of their standard deviation, which is 0.015 m.
        assert!((found.mean[0] - expected / total).abs() < 3e-4, "{} {}", found.mean[0], expected / total);
    }
    let d = (means[2] - means[0]) / total;
    assert!((sums.actions[0].d[0] - d).abs() < 1e-4 && (sums.actions[0].d2[0] - d2 / total).abs() < 1e-5);
}

/// The starting models for logs of [`log`].
fn given(f: &Polynomial) -> Models {
    let entry = |action, vy_m_per_s| Entry { action, vx_m_per_s: 0.0, vy_m_per_s, vtheta_rad_per_s: 0.0, se: None };
    Models {
        action: Some(ActionModel::Table(vec![entry(0, -0.3), entry(1, 0.3)])),
        sensor: Some(SensorModel::HeightOfDistance(f.clone().into())),
        noise: Noise { sigma1_px: Some(1.0), motion_sd: Some([0.02, 0.02, 0.1]), ..Noise::default() },
    }
}

fn exact(max_iterations: u32, pooled_steps: f64) -> Em {
    Em {
        expectation: Expectation::Rts,
        exact: true,
        motion: MotionNoise::Learned { pooled_steps },
        outliers: Outliers::None,
        acceleration: Acceleration::None,
        coefficients: 2,
        max_iterations,
        ..Em::default()
    }
}

#[test]
fn on_a_linear_problem_the_likelihood_never_falls() {
    let f = Polynomial::plain(vec![40.0, -6.0]);
    let learned = exact(200, 0.0).along_line(&log(600, 2, &f), &given(&f), &mut Seed(1).stream("learner")).unwrap();
    let curve: Vec<f64> = learned.history.iter().filter_map(|step| step.log_likelihood).collect();
    assert_eq!(curve.len(), 200);
    assert!(curve.windows(2).all(|two| two[1] > two[0] - 1e-7), "{curve:?}");
    assert!(curve[199] > curve[0] + 100.0);
}

#[test]
fn the_m_step_maximises_the_expected_likelihood() {
    let f = Polynomial::plain(vec![40.0, -6.0]);
    let log = log(300, 3, &f);
    let plane = Plane::along_a_line(&log).unwrap();
    let learned = exact(2, 1e15).along_line(&log, &given(&f), &mut Seed(1).stream("learner")).unwrap();
    let [before, after] = [0, 1].map(|i| parameters(&plane, &learned.history[i].models));
    // The distribution of the states under the models before, by Kalman's smoother; its prior is what the
    // learner chose: where f gives the first size, give or take a metre.
    let nearest = (1..=400).map(|i| 0.05 * f64::from(i));
    let off = |d: f64| (f.at(d) - plane.sightings[0].size).abs();
    let d = nearest.fold(1e9, |best, d| if off(d) < off(best) { d } else { best });
    let prior = Gaussian { mean: Vector1::new(-d), covariance: Vector1::new(1.0) };
    let (states, crosses, _) = kalman(&plane, &Parameters { prior, ..before }, 40.0, -6.0);
    let expected = |x: &Parameters<1>| {
        let mut sum = 0.0;
        for t in 0..plane.frames.len() {
            if t + 1 < plane.frames.len() {
                let frame = &plane.frames[t];
                let mean = states[t + 1].mean[0] - states[t].mean[0] - x.velocity[frame.action][0] * frame.dt_s;
                let var = states[t + 1].covariance[0] + states[t].covariance[0] - 2.0 * crosses[t];
                let q = x.motion_var[frame.action][0] * frame.dt_s / plane.step_s;
                sum -= 0.5 * (q.ln() + (mean * mean + var) / q);
            }
            for seen in plane.seen(t) {
                // f is a line here: E (f(d) - o)^2 is square of mean and variance.
                let (size, slope) = x.f.at(-states[t].mean[0]);
                let square = (size - seen.size).powi(2) + slope * slope * states[t].covariance[0];
                sum -= 0.5 * (x.size_var.ln() + square / x.size_var);
            }
        }
        sum
    };
    let greatest = expected(&after);
    let worse = |change: &dyn Fn(&mut Parameters<1>, f64)| {
        for by in [-1e-3, 1e-3] {
            let mut other = after.clone();
            change(&mut other, by);
            assert!(expected(&other) < greatest, "{} {greatest}", expected(&other));
        }
    };
    worse(&|x, by| x.velocity[0] += SVector::from([by]));
    worse(&|x, by| x.velocity[1] += SVector::from([by]));
    // Pooled without end, the noise of the motion is one for all actions.
    worse(&|x, by| x.motion_var.iter_mut().for_each(|q| *q *= 1.0 + by));
    worse(&|x, by| x.f.c[0] += by);
    worse(&|x, by| x.f.c[1] += by);
    worse(&|x, by| x.size_var *= 1.0 + by);
}

/// Parameters out of models.
fn parameters(plane: &Plane, models: &Models) -> Parameters<1> {
    let Some(SensorModel::HeightOfDistance(curve)) = &models.sensor else { panic!("{models:?}") };
    let f = SizeCurve::new(&curve.polynomial, 2, 2.0, 1.5);
    let prior = Gaussian { mean: Vector1::new(0.0), covariance: Vector1::new(1.0) };
    Parameters::given(plane, models, f, prior).unwrap()
}
