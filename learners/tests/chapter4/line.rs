//! EM in one dimension (section 4.4.3 of the dissertation), on a pacing robot.

use std::sync::Arc;

use asami_dataset::log::Frame;
use asami_dataset::{Action, ActionModel, Beacon, Command, Known, Log, Seed, SensorModel, Sighting, Size};
use asami_math::elementary::sin;
use asami_math::regression::least_squares;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::synthetic::{learn, published};

fn height(d: f64) -> f64 {
    38.4 / (d - 0.1) - 1.0
}

/// Forward speed of the actions -10 to 10.
fn speed(id: u16) -> f64 {
    let u = f64::from(id) / 10.0 - 1.0;
    0.39 * u * (1.0 - 0.2 * u.abs()) + 0.01 * sin(3.0 * f64::from(id))
}

/// Eight minutes to and fro between the heights of 1.3 m and 3.5 m, a new action every three seconds.
fn log(seed: u64) -> Log {
    let (mut policy, mut noise) = (Seed(seed).stream("policy"), Seed(seed).stream("noise"));
    let mut normal = || -> f64 { StandardNormal.sample(&mut noise) };
    let (mut d, mut forward, mut since, mut action) = (3.0, true, 0, 0);
    let (mut commands, mut frames, mut looks) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..9_600 {
        let t_s = 0.05 * f64::from(i);
        let o = height(d) + normal();
        frames.push(Frame { t_s, head_pan_rad: 0.0 });
        looks.push(Sighting { t_s, landmark: 0, size: Size::HeightPx(o), bearing_rad: 0.0 });
        let turn = if forward { d < 1.3 } else { d > 3.5 };
        forward ^= turn;
        if turn || i == 0 || i - since == 60 {
            since = i;
            let size = policy.random_range(0..=10u16);
            action = if forward { 10 + size } else { 10 - size };
            let ay_m_per_s = 0.04 * f64::from(action) - 0.4;
            let legs = Action::Legs { id: Some(action), ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 };
            commands.push(Command { t_s, action: legs });
        }
        d -= speed(action) * 0.05 + 0.003 * normal();
    }
    let known = Known { landmarks: vec![Beacon { id: 0, x_m: 0.0, y_m: 4.0, height_m: None }], ..Known::default() };
    Log {
        known: Arc::new(known),
        commands: commands.into(),
        frames: Some(frames.into()),
        sightings: looks.into(),
        ..Log::default()
    }
}

#[test]
fn both_models_are_learned_in_units_that_agree() {
    let learned = learn("em_1d_published", &[("patience", 20.0)], &log(1000), &published()).unwrap();
    let (Some(ActionModel::Table(entries)), Some(SensorModel::HeightOfDistance(f))) =
        (&learned.models.action, &learned.models.sensor)
    else {
        panic!("{:?}", learned.models)
    };
    assert!(entries.len() == 21 && entries.iter().all(|e| e.vx_m_per_s == 0.0 && e.vtheta_rad_per_s == 0.0));
    // k A(c) = v.
    let rows = entries.iter().map(|e| (vec![e.vy_m_per_s], speed(e.action)));
    let fit = least_squares(1, rows).solve().unwrap();
    let k = fit.coefficients[0];
    let error = (fit.residual_ss / 21.0).sqrt();
    assert!(error < 0.028 * 0.7, "{error}");
    // f(a + b d) = height: the learned f inverted, on a line over d.
    let inverse = |o: f64| {
        let (near, far) =
            (f.polynomial.centre - 2.0 * f.polynomial.scale, f.polynomial.centre + 2.0 * f.polynomial.scale);
        let steps = 10_000;
        let at = |i: i32| near + (far - near) * f64::from(i) / f64::from(steps);
        (0..=steps)
            .map(at)
            .min_by(|a, b| (f.polynomial.at(*a) - o).abs().total_cmp(&(f.polynomial.at(*b) - o).abs()))
            .unwrap()
    };
    let distances = (0..13).map(|i| 1.3 + 0.18 * f64::from(i));
    let rows = distances.map(|d| (vec![1.0, d], inverse(height(d))));
    let b = least_squares(2, rows).solve().unwrap().coefficients[1];
    assert!((k * b - 1.0).abs() < 0.09, "{k} {b}");
    let noise = learned.models.noise;
    assert!((noise.sigma1_px.unwrap() - 1.0).abs() < 0.06 && noise.sigma2_rad.is_none(), "{noise:?}");
    // In units agreed on, speeds are known to centimetres a second.
    let errors: Vec<f64> = entries.iter().filter_map(|e| e.se).map(|se| se[1]).collect();
    assert!(errors.len() == 21 && errors.iter().all(|se| (1e-4..0.05).contains(se)), "{errors:?}");
}
