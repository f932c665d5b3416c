//! A drive among boxes and poles, every ray cast by the definition: no physics, no mesh.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asami_dataset::log::Velodyne;
use asami_dataset::{Action, Command, Firings, Known, Log, Models, Seed};
use asami_learners::{CannotLearn, Learned, Learners};
use rand::{Rng, RngExt};

/// A wall from one place to another, and its height above ground.
type Wall = ([f64; 2], [f64; 2], f64);

const SENSOR_HEIGHT_M: f64 = 2.0;

/// A drive to be simulated.
pub struct Ride {
    pub lasers: usize,
    pub turns: usize,
    /// Firings in a turn of 0.1 s.
    pub firings: usize,
    /// c5 to c10 of the car.
    pub c: [f64; 6],
    /// Angle of the unit's base to the car.
    pub theta_b_rad: f64,
    /// Lasers sit so far off the axis, by turns to the left and to the right.
    pub offset_m: f64,
    /// The nose is so far up.
    pub pitch_rad: f64,
    pub seed: u64,
}

impl Default for Ride {
    fn default() -> Self {
        let c = [0.2, 4.0, -0.3, -0.6, 0.001, 0.09];
        let theta_b_rad = 89.1f64.to_radians();
        Self { lasers: 12, turns: 150, firings: 780, c, theta_b_rad, offset_m: 0.0, pitch_rad: 0.0, seed: 1000 }
    }
}

/// What was driven.
pub struct Driven {
    pub log: Log,
    /// theta_l + theta_b.
    pub angles_rad: Vec<f64>,
    /// Pose at each firing: x, y, theta (0 faces +y), and speed and turning rate.
    pub track: Vec<[f64; 5]>,
}

impl Ride {
    pub fn drive(&self) -> Driven {
        let mut rng = Seed(self.seed).stream("test");
        let (dt_s, n) = (0.1 / self.firings as f64, self.turns * self.firings);
        let angles_rad: Vec<f64> =
            (0..self.lasers).map(|_| self.theta_b_rad + (rng.random::<f64>() - 0.5) * 0.3).collect();
        let elevations: Vec<f64> = (0..self.lasers).map(|l| (-4.0 + 0.5 * l as f64).to_radians()).collect();
        let commands = pedals(&mut rng, n as f64 * dt_s);
        let track = self.track(&commands, n, dt_s);
        let walls = town(&mut rng);
        let mut firings = Firings {
            t_s: (0..n).map(|i| i as f64 * dt_s).collect(),
            encoder_cdeg: (0..n).map(|i| ((i % self.firings) * 36_000 / self.firings) as u16).collect(),
            range_2mm: vec![vec![0; n]; self.lasers],
            intensity: Vec::new(),
        };
        for (i, [x, y, theta, ..]) in track.iter().enumerate() {
            let turned = (i % self.firings) as f64 / self.firings as f64 * TAU;
            for l in 0..self.lasers {
                // theta of the car counts from +y, the laser's angle from the car's x axis.
                let looks = theta + angles_rad[l] - turned;
                let aside = if l % 2 == 0 { self.offset_m } else { -self.offset_m };
                let from = [x - aside * looks.sin(), y + aside * looks.cos()];
                // As a small rotation sees it: up ahead, down behind.
                let pitched = self.pitch_rad * (looks - theta - PI / 2.0).cos();
                let range_m = cast(&walls, from, looks, elevations[l] + pitched) + 0.02 * (rng.random::<f64>() - 0.5);
                let lost = rng.random::<f64>() < 0.02 || range_m > 120.0;
                firings.range_2mm[l][i] = if lost { 0 } else { (range_m / 0.002).round() as u16 };
            }
        }
        let velodyne = Velodyne {
            vertical_angles_rad: elevations,
            firing_rate_hz: 1.0 / dt_s,
            turn_rate_hz: 10.0,
            sensor_height_m: SENSOR_HEIGHT_M,
            left_m: Vec::new(),
            up_m: Vec::new(),
        };
        let known = Known { robot: "car".into(), velodyne: Some(velodyne), ..Known::default() };
        let log =
            Log { known: known.into(), commands: commands.into(), firings: Some(Arc::new(firings)), ..Log::default() };
        Driven { log, angles_rad, track }
    }

    /// Equations 2.30 to 2.34 in steps of one firing.
    fn track(&self, commands: &[Command], n: usize, dt_s: f64) -> Vec<[f64; 5]> {
        let ([mut x, mut y, mut theta, mut v], c) = ([0.0, 0.0, 0.0, 3.0], self.c);
        (0..n)
            .map(|i| {
                let at = commands.partition_point(|command| command.t_s <= i as f64 * dt_s + 1e-9);
                let Action::Pedals { throttle, brake, steering } = commands[at.max(1) - 1].action else {
                    unreachable!()
                };
                let omega = c[4] * v + c[5] * v * steering;
                let now = [x, y, theta, v, omega];
                x -= v * theta.sin() * dt_s;
                y += v * theta.cos() * dt_s;
                theta += omega * dt_s;
                v += (c[0] + c[1] * throttle + c[2] * v + c[3] * v * brake) * dt_s;
                now
            })
            .collect()
    }
}

/// Pedals at 20 Hz, held for a second or two; the wheel turns slowly.
fn pedals(rng: &mut impl Rng, until_s: f64) -> Vec<Command> {
    let (mut throttle, mut brake, mut target, mut steering, mut next) = (0.3, 0.0, 0.0, 0.0, 0);
    (0..(until_s * 20.0).ceil() as usize)
        .map(|i| {
            if i == next {
                let braking = rng.random::<f64>() < 0.3;
                throttle = if braking { 0.0 } else { 0.15 + 0.5 * rng.random::<f64>() };
                brake = if braking { 0.6 * rng.random::<f64>() } else { 0.0 };
                target = 0.8 * (rng.random::<f64>() - 0.4);
                next += 20 + rng.random_range(0..20);
            }
            let turn: f64 = 0.1 * (target - steering);
            steering += turn.clamp(-0.03, 0.03);
            Command { t_s: i as f64 * 0.05, action: Action::Pedals { throttle, brake, steering } }
        })
        .collect()
}

/// Boxes and poles of all heights about the way, none on it.
fn town(rng: &mut impl Rng) -> Vec<Wall> {
    let mut walls = Vec::new();
    for _ in 0..90 {
        let (x, y) = (120.0 * (rng.random::<f64>() - 0.5), 120.0 * (rng.random::<f64>() - 0.2));
        let (turn, tall) = (rng.random::<f64>() * PI, 1.0 + 7.0 * rng.random::<f64>());
        let size = if rng.random::<f64>() < 0.5 { [0.3, 0.3] } else { [2.0 + 6.0 * rng.random::<f64>(), 4.0] };
        // The car stays within a bent strip; what would stand there is moved aside.
        let x = if x.abs() < 12.0 { x + 24.0f64.copysign(x) } else { x };
        let corner = |sx: f64, sy: f64| {
            let (dx, dy) = (sx * size[0], sy * size[1]);
            [x + turn.cos() * dx - turn.sin() * dy, y + turn.sin() * dx + turn.cos() * dy]
        };
        let corners = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
        walls.extend((0..4).map(|k| (corners[k], corners[(k + 1) % 4], tall)));
    }
    walls
}

/// Range to the nearest wall or the ground.
fn cast(walls: &[Wall], from: [f64; 2], looks: f64, elevation: f64) -> f64 {
    let (d, slope) = ([looks.cos(), looks.sin()], elevation.tan());
    let mut nearest = if slope < 0.0 { SENSOR_HEIGHT_M / -slope } else { f64::INFINITY };
    for (a, b, tall) in walls {
        let (e, w) = ([b[0] - a[0], b[1] - a[1]], [a[0] - from[0], a[1] - from[1]]);
        let cross = d[0] * e[1] - d[1] * e[0];
        let (t, s) = ((w[0] * e[1] - w[1] * e[0]) / cross, (w[0] * d[1] - w[1] * d[0]) / cross);
        if t > 0.0 && t < nearest && (0.0..=1.0).contains(&s) && SENSOR_HEIGHT_M + t * slope < *tall {
            nearest = t;
        }
    }
    nearest / elevation.cos()
}

pub fn learn(name: &str, log: &Log) -> Result<Learned, CannotLearn> {
    let learner = Learners::default().configured(name, &std::collections::BTreeMap::new()).unwrap();
    learner.learn(log, &Models::default(), &mut Seed(1000).stream("learner"))
}
