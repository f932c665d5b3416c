//! Logs out of a kinematic robot on the field, after section 4.4.2 of the dissertation.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asami_dataset::log::Frame;
use asami_dataset::models::Entry;
use asami_dataset::{
    Action, ActionModel, Beacon, Command, Known, Log, Models, Noise, Seed, SensorModel, Sighting, Size,
};
use asami_learners::{CannotLearn, Learned, Learners};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, cos, hypot, sin, sin_cos};
use asami_math::polynomial::Polynomial;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// A robot that walks about among four beacons, 40 actions of 5 s each in turn.
#[derive(Clone, Debug)]
pub struct Walker {
    pub steps: usize,
    pub dt_s: f64,
    pub sigma1_px: f64,
    pub sigma2_rad: f64,
    /// Right, forward, turn, a step.
    pub motion_sd: [f64; 3],
    /// Where the sensor sits: right, forward.
    pub sensor_origin_m: [f64; 2],
    /// How far off the camera's axis beacons are seen.
    pub view_rad: f64,
    /// Share of the bearings' variance that those of one frame have in common.
    pub common_share: f64,
    /// Share of sightings replaced by anything.
    pub false_share: f64,
    /// Degree of the true f; 0: the camera's, `38.4 / (d - 0.1) - 1`.
    pub cubic: bool,
    /// Which of the beacons there are.
    pub beacons: Vec<u16>,
    pub actions: u16,
    /// Factor on all velocities.
    pub speed: f64,
}

impl Default for Walker {
    fn default() -> Self {
        Self {
            steps: 18_000,
            dt_s: 0.05,
            sigma1_px: 1.0,
            sigma2_rad: 0.5,
            motion_sd: [0.005, 0.005, 0.02],
            sensor_origin_m: [0.0; 2],
            view_rad: 0.4966,
            common_share: 0.0,
            false_share: 0.0,
            cubic: false,
            beacons: vec![0, 1, 2, 3],
            actions: 40,
            speed: 1.0,
        }
    }
}

pub const BEACONS: [[f64; 2]; 4] = [[-1.8, -2.7], [1.8, -2.7], [1.8, 2.7], [-1.8, 2.7]];

impl Walker {
    /// Attempted velocities: eqs 4.29 to 4.31, scaled.
    pub fn attempted(id: u16) -> [f64; 3] {
        let omega = [-0.5, -1.0 / 6.0, 0.0, 1.0 / 6.0, 0.5][usize::from(id / 8) % 5];
        let psi = PI / 4.0 * f64::from(id % 8);
        let along = f64::sqrt(1.0 - omega * omega);
        [0.33 * cos(psi) * along, 0.4 * sin(psi) * along, 2.8 * omega]
    }

    /// True velocities: the attempted ones, bent irregularly.
    pub fn velocity(id: u16) -> [f64; 3] {
        let [x, y, t] = Self::attempted(id);
        let k = f64::from(id);
        [
            1.05 * x + 0.03 * y + 0.02 * sin(3.7 * k),
            1.02 * y - 0.02 * x + 0.025 * sin(2.3 * k + 1.0) - 0.02,
            1.08 * t + 0.09 * sin(5.1 * k + 2.0) + 0.05,
        ]
    }

    pub fn height(&self, d: f64) -> f64 {
        if self.cubic {
            Polynomial { coefficients: vec![14.0, -8.0, 4.0, -2.0], centre: 2.7, scale: 1.45 }.at(d)
        } else {
            38.4 / (d - 0.1) - 1.0
        }
    }

    /// The log of one seed.
    pub fn log(&self, seed: u64) -> Log {
        self.walk(seed).0
    }

    /// The log of one seed, and the pose at each of its frames.
    pub fn walk(&self, seed: u64) -> (Log, Vec<[f64; 3]>) {
        let mut poses = Vec::with_capacity(self.steps);
        let mut policy = Seed(seed).stream("policy");
        let (mut motion, mut sight) = (Seed(seed).stream("motion"), Seed(seed).stream("sight"));
        let mut head = Seed(seed).stream("head");
        let normal = |rng: &mut asami_dataset::Rng| -> f64 { StandardNormal.sample(rng) };
        let mut pose = [0.0, 0.0, 0.3];
        let mut executed = vec![0u32; usize::from(self.actions)];
        let (mut commands, mut frames, mut sightings) = (Vec::new(), Vec::new(), Vec::new());
        let hold = (5.0 / self.dt_s).round() as usize;
        let mut action = 0;
        for i in 0..self.steps {
            let t_s = i as f64 * self.dt_s;
            if i % hold == 0 {
                action = choose(&pose, &executed, &mut policy);
                executed[usize::from(action)] += 1;
                let [ax_m_per_s, ay_m_per_s, atheta_rad_per_s] = Self::attempted(action);
                let legs = Action::Legs { id: Some(action), ax_m_per_s, ay_m_per_s, atheta_rad_per_s };
                commands.push(Command { t_s, action: legs });
            }
            let pan = 1.4 * sin(TAU * t_s / 2.0);
            frames.push(Frame { t_s, head_pan_rad: pan });
            poses.push(pose);
            let head_error = normal(&mut head);
            for (id, place) in (0..).zip(BEACONS) {
                let (e1, own): (f64, f64) = (normal(&mut sight), normal(&mut sight));
                let e2 = self.common_share.sqrt() * head_error + (1.0 - self.common_share).sqrt() * own;
                let (odd, recognised) = (sight.random::<f64>(), sight.random::<f64>() < 0.86);
                let (s, c) = sin_cos(pose[2]);
                let (dx, dy) = (place[0] - pose[0], place[1] - pose[1]);
                let x = c * dx + s * dy - self.sensor_origin_m[0];
                let y = c * dy - s * dx - self.sensor_origin_m[1];
                let (d, bearing) = (hypot(x, y), atan2(-x, y));
                let seen = wrap_rad(bearing - pan).abs() < self.view_rad && (1.275..4.175).contains(&d);
                if !(seen && recognised && self.beacons.contains(&id)) {
                    continue;
                }
                let (size, bearing_rad) = if odd < self.false_share {
                    (8.0 + 25.0 * e1.abs().min(1.0), wrap_rad(3.0 * e2))
                } else {
                    (self.height(d) + self.sigma1_px * e1, wrap_rad(bearing + self.sigma2_rad * e2))
                };
                sightings.push(Sighting { t_s, landmark: id, size: Size::HeightPx(size), bearing_rad });
            }
            let v = Self::velocity(action).map(|v| self.speed * v);
            let moved: [f64; 3] = std::array::from_fn(|k| v[k] * self.dt_s + self.motion_sd[k] * normal(&mut motion));
            let (s, c) = sin_cos(pose[2]);
            pose[0] += c * moved[0] - s * moved[1];
            pose[1] += s * moved[0] + c * moved[1];
            pose[2] += moved[2];
        }
        let log = Log {
            known: Arc::new(self.known()),
            commands: commands.into(),
            frames: Some(frames.into()),
            sightings: sightings.into(),
            ..Log::default()
        };
        (log, poses)
    }

    fn known(&self) -> Known {
        let landmarks = (0..).zip(BEACONS).map(|(id, [x_m, y_m])| Beacon { id, x_m, y_m, height_m: Some(0.2) });
        let sensor_origin_m = self.sensor_origin_m;
        Known {
            robot: "plain".into(),
            landmarks: landmarks.collect(),
            range_bearing: Some(asami_dataset::log::RangeBearing { max_range_m: 10.0, sensor_origin_m }),
            ..Known::default()
        }
    }
}

/// The rarest of the actions that keep the robot on the field, or the one that leaves it least.
fn choose(pose: &[f64; 3], executed: &[u32], rng: &mut asami_dataset::Rng) -> u16 {
    let beyond = |id: u16| {
        let v = Walker::attempted(id);
        let (mut x, mut y, mut worst) = (pose[0], pose[1], 0.0f64);
        for k in 0..20 {
            let (s, c) = sin_cos(pose[2] + v[2] * 0.25 * (f64::from(k) + 0.5));
            x += 0.25 * (c * v[0] - s * v[1]);
            y += 0.25 * (s * v[0] + c * v[1]);
            worst = worst.max(x.abs() - 1.5).max(y.abs() - 2.4);
        }
        worst
    };
    let cost = |id: u16, draw: f64| 8.0 * beyond(id) + f64::from(executed[usize::from(id)]) + draw;
    let costs: Vec<(f64, u16)> =
        (0..executed.len() as u16).map(|id| (cost(id, 2.0 * rng.random::<f64>()), id)).collect();
    costs.iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("actions").1
}

/// Root mean square errors of the velocities (mm/s, mm/s, rad/s) and of f over 1.275 to 4.175 m (px).
#[derive(Clone, Copy, Debug)]
pub struct Score {
    pub velocity: [f64; 3],
    pub sensor_px: f64,
    pub sigma1_px: f64,
    pub sigma2_rad: f64,
    /// Share of the velocities within 1.96 standard errors of the truth; NaN without any.
    pub covered: f64,
}

pub fn score(walker: &Walker, models: &Models) -> Score {
    let (Some(ActionModel::Table(entries)), Some(SensorModel::HeightOfDistance(curve))) =
        (&models.action, &models.sensor)
    else {
        panic!("{models:?}");
    };
    let mut squares = [0.0; 3];
    let (mut within, mut of) = (0.0, 0.0);
    for entry in entries {
        let truth = Walker::velocity(entry.action);
        let e = [entry.vx_m_per_s - truth[0], entry.vy_m_per_s - truth[1], entry.vtheta_rad_per_s - truth[2]];
        for i in 0..3 {
            squares[i] += e[i] * e[i] / entries.len() as f64;
            if let Some(se) = entry.se {
                of += 1.0;
                within += f64::from(u8::from(e[i].abs() < 1.96 * se[i]));
            }
        }
    }
    let distances = (0..30).map(|i| 1.275 + 0.1 * f64::from(i));
    let sensor: f64 = distances.map(|d| (curve.polynomial.at(d) - walker.height(d)).powi(2) / 30.0).sum();
    Score {
        velocity: [1e3 * squares[0].sqrt(), 1e3 * squares[1].sqrt(), squares[2].sqrt()],
        sensor_px: sensor.sqrt(),
        sigma1_px: models.noise.sigma1_px.unwrap(),
        sigma2_rad: models.noise.sigma2_rad.unwrap(),
        covered: within / of,
    }
}

/// The published starting models: no motion, a poor line for f, much noise.
pub fn published() -> Models {
    let f = Polynomial::plain(vec![50.0, -10.0]);
    Models {
        action: Some(ActionModel::Table(Vec::new())),
        sensor: Some(SensorModel::HeightOfDistance(f.into())),
        noise: Noise {
            sigma1_px: Some(10.0),
            sigma2_rad: Some(0.2),
            motion_sd: Some([0.01, 0.01, 0.1]),
            ..Noise::default()
        },
    }
}

/// The true models.
pub fn truth(walker: &Walker) -> Models {
    let entry = |action: u16| {
        let [vx_m_per_s, vy_m_per_s, vtheta_rad_per_s] = Walker::velocity(action);
        Entry { action, vx_m_per_s, vy_m_per_s, vtheta_rad_per_s, se: None }
    };
    let points = (0..30).map(|i| 1.275 + 0.1 * f64::from(i)).map(|d| (d, walker.height(d)));
    let f = Polynomial::fit(points, 3, 2.7, 1.45).expect("points").0;
    Models {
        action: Some(ActionModel::Table((0..walker.actions).map(entry).collect())),
        sensor: Some(SensorModel::HeightOfDistance(f.into())),
        noise: Noise {
            sigma1_px: Some(walker.sigma1_px),
            sigma2_rad: Some(walker.sigma2_rad),
            motion_sd: Some(walker.motion_sd),
            ..Noise::default()
        },
    }
}

/// Runs a learner of the list with some parameters set.
pub fn learn(name: &str, with: &[(&str, f64)], log: &Log, given: &Models) -> Result<Learned, CannotLearn> {
    let with: BTreeMap<String, f64> = with.iter().map(|(name, value)| ((*name).to_string(), *value)).collect();
    let learner = Learners::default().configured(name, &with).expect("a learner of the list");
    learner.learn(log, given, &mut Seed(0).stream("learner"))
}
