//! Logs out of a kinematic robot on a line, and the dissertation's scores of what was learned.

use std::collections::BTreeMap;

use asami_dataset::models::Curve;
use asami_dataset::{Action, ActionModel, Command, Log, Models, Seed, SensorModel, Sighting, Size};
use asami_learners::{CannotLearn, Learned, Learners};
use asami_math::elementary::exp;
use asami_math::polynomial::Polynomial;
use asami_math::regression::least_squares;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// A robot that paces before a beacon of height `38.4 px / (d - 0.2 m)`.
#[derive(Clone, Debug)]
pub struct Pacer {
    pub duration_s: f64,
    pub rate_hz: f64,
    pub sigma_px: f64,
    /// Random walk of the place, metres per square root of a second.
    pub walk_m: f64,
    /// How late commands take effect.
    pub delay_s: f64,
    /// Share of sightings that are off by up to 15 px.
    pub outliers: f64,
    /// Speed at which the gait saturates; infinite: the robot does as it is told.
    pub saturates_m_per_s: f64,
}

impl Default for Pacer {
    fn default() -> Self {
        Self {
            duration_s: 150.0,
            rate_hz: 20.0,
            sigma_px: 0.5,
            walk_m: 0.02,
            delay_s: 0.0,
            outliers: 0.0,
            saturates_m_per_s: 0.2,
        }
    }
}

impl Pacer {
    /// What the robot does: `s tanh(c / s)`.
    pub fn speed(&self, c: f64) -> f64 {
        if self.saturates_m_per_s.is_infinite() {
            return c;
        }
        let e = exp(2.0 * c / self.saturates_m_per_s);
        self.saturates_m_per_s * (e - 1.0) / (e + 1.0)
    }

    pub fn height(d: f64) -> f64 {
        38.4 / (d - 0.2)
    }

    /// The log of one seed.
    pub fn log(&self, seed: u64) -> Log {
        let (mut policy, mut noise) = (Seed(seed).stream("policy"), Seed(seed).stream("noise"));
        let mut errors = Seed(seed).stream("outliers");
        let mut normal = || -> f64 { StandardNormal.sample(&mut noise) };
        let dt = 1.0 / self.rate_hz;
        let (mut d, mut forward, mut since) = (3.0, true, f64::NEG_INFINITY);
        let (mut commands, mut sightings) = (Vec::new(), Vec::new());
        for i in 0..(self.duration_s * self.rate_hz) as usize {
            let t_s = i as f64 * dt;
            let wrong = if errors.random::<f64>() < self.outliers { 30.0 * errors.random::<f64>() - 15.0 } else { 0.0 };
            let o = Self::height(d) + self.sigma_px * normal() + wrong;
            sightings.push(Sighting { t_s, landmark: 0, size: Size::HeightPx(o), bearing_rad: 0.0 });
            let turn = if forward { o > Self::height(1.3) } else { o < Self::height(3.5) };
            forward ^= turn;
            if turn || t_s - since > 3.0 - 1e-9 {
                since = t_s;
                let c = 0.3 * policy.random::<f64>() * if forward { 1.0 } else { -1.0 };
                commands.push(Command {
                    t_s,
                    action: Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s: c, atheta_rad_per_s: 0.0 },
                });
            }
            let acting = commands.iter().rev().find(|row: &&Command| row.t_s + self.delay_s <= t_s + 1e-9);
            let acting = acting.and_then(|row| row.action.forward_m_per_s()).unwrap_or(0.0);
            d -= self.speed(acting) * dt + self.walk_m * dt.sqrt() * normal();
        }
        Log { commands: commands.into(), sightings: sightings.into(), ..Log::default() }
    }
}

/// Root mean square errors after the dissertation's scaling, and the scales themselves.
#[derive(Clone, Copy, Debug)]
pub struct Score {
    pub sensor_mm: f64,
    pub action_mm_per_s: f64,
    /// `k` of `k A(c) = v`.
    pub k: f64,
    /// `b` of `a + b S(o) = d`.
    pub b: f64,
}

/// Scores against the 13 distances and 31 commands of section 3.3.2.
pub fn score(pacer: &Pacer, models: &Models) -> Score {
    let (b, sensor_mm) = sensor_error(models);
    let (k, action_mm_per_s) = action_error(pacer, models);
    Score { sensor_mm, action_mm_per_s, k, b }
}

/// The scale of the sensor model alone, and its error in mm.
pub fn sensor_error(models: &Models) -> (f64, f64) {
    let sensor = curve_of_sensor(models);
    let distances = (0..13).map(|i| 1.2 + 0.2 * f64::from(i));
    fitted(2, distances.map(|d| (vec![1.0, sensor.polynomial.at(Pacer::height(d))], d)).collect())
}

/// The scale of the action model alone, and its error in mm/s.
pub fn action_error(pacer: &Pacer, models: &Models) -> (f64, f64) {
    let action = curve_of_action(models);
    let commands = (-15..=15).map(|i| 0.02 * f64::from(i));
    fitted(1, commands.map(|c| (vec![action.polynomial.at(c)], pacer.speed(c))).collect())
}

/// Last coefficient and thousandfold root mean square residual.
pub fn fitted(unknowns: usize, rows: Vec<(Vec<f64>, f64)>) -> (f64, f64) {
    let n = rows.len() as f64;
    let fit = least_squares(unknowns, rows).solve().expect("finite models");
    (fit.coefficients[unknowns - 1], 1e3 * (fit.residual_ss / n).sqrt())
}

/// The best polynomials of some degrees: no learner of those degrees errs less.
pub fn floors(pacer: &Pacer, sensor_degree: usize, action_degree: usize) -> (f64, f64) {
    let places = (0..13).map(|i| 1.2 + 0.2 * f64::from(i)).map(|d| (Pacer::height(d), d));
    let speeds = (-15..=15).map(|i| 0.02 * f64::from(i)).map(|c| (c, pacer.speed(c)));
    let rms = |points: Vec<(f64, f64)>, degree, centre, scale| {
        let n = points.len() as f64;
        let (_, regression) = Polynomial::fit(points, degree, centre, scale).expect("points");
        1e3 * (regression.solve().expect("points").residual_ss / n).sqrt()
    };
    (rms(places.collect(), sensor_degree, 25.0, 13.0), rms(speeds.collect(), action_degree, 0.0, 0.3))
}

pub fn curve_of_action(models: &Models) -> &Curve {
    match &models.action {
        Some(ActionModel::Polynomial(curve)) => curve,
        other => panic!("no polynomial action model: {other:?}"),
    }
}

pub fn curve_of_sensor(models: &Models) -> &Curve {
    match &models.sensor {
        Some(SensorModel::DistanceOfHeight(curve)) => curve,
        other => panic!("no inverse sensor model: {other:?}"),
    }
}

/// Runs a learner of the list with some parameters set.
pub fn learn(name: &str, with: &[(&str, f64)], log: &Log, given: &Models) -> Result<Learned, CannotLearn> {
    let with: BTreeMap<String, f64> = with.iter().map(|(name, value)| ((*name).to_string(), *value)).collect();
    let learner = Learners::default().configured(name, &with).expect("a learner of the list");
    learner.learn(log, given, &mut Seed(0).stream("learner"))
}

/// The three starting models of Table 3.1.
pub fn starting(name: &str) -> Models {
    let polynomial = |coefficients| ActionModel::Polynomial(Polynomial::plain(coefficients).into());
    let action = match name {
        "c" => polynomial(vec![0.0, 1.0]),
        "sgn" => ActionModel::Sign,
        _ => polynomial(vec![1.0]),
    };
    Models { action: Some(action), ..Models::default() }
}

/// A log of the same motion in other units.
pub fn scaled(log: &Log, by_c: f64, by_o: f64, later_s: f64) -> Log {
    let commands: Vec<Command> = log
        .commands
        .iter()
        .map(|row| Command {
            t_s: row.t_s + later_s,
            action: Action::Wheels {
                id: None,
                v_m_per_s: by_c * row.action.forward_m_per_s().unwrap(),
                omega_rad_per_s: 0.0,
            },
        })
        .collect();
    let sightings: Vec<Sighting> = log
        .sightings
        .iter()
        .map(|row| Sighting { t_s: row.t_s + later_s, size: Size::HeightPx(by_o * row.size.value()), ..*row })
        .collect();
    Log { commands: commands.into(), sightings: sightings.into(), ..Log::default() }
}
