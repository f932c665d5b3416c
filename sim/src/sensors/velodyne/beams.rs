//! Beams of a block of firings, as rays.

use asami_math::elementary::sin_cos;
use asami_raycast::Bundle;
use nalgebra::{Matrix3, Rotation3};

use super::track::Track;
use super::{Unit, VelodyneConfig};
use crate::knobs::{LaserKnobs, VelodyneKnobs};

/// Firings of a bundle: 4 lasers beside one another, 16 firings of each.
pub(super) const FIRINGS: usize = 16;
/// Lasers of a bundle.
pub(super) const LASERS: usize = 4;
/// Firings that stand next to one another in a group of 16 rays: 4 lasers by 4 firings.
pub(super) const RUN: usize = 4;

/// A laser in the turning head.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mount {
    /// Where it looks, along x at the encoder's zero.
    direction: [f32; 3],
    /// From the head's centre to it.
    origin_m: [f32; 3],
    /// Its time after its bank's first laser's.
    after_s: f32,
    /// Firings later than a laser without a rotational correction that it looks the same way.
    pub lag: isize,
}

/// Lasers as they are mounted: as their maker measured them, and as `departures` says otherwise.
pub(super) fn mounts(
    unit: &Unit,
    config: &VelodyneConfig,
    knobs: &VelodyneKnobs,
    departures: &[LaserKnobs],
) -> Vec<Mount> {
    let step_rad = std::f64::consts::TAU * turns_per_firing(config, knobs);
    let count = unit.lasers().len();
    let mount = |(i, laser): (usize, &super::Laser)| {
        let departure = departures.get(i).copied().unwrap_or_default();
        let vertical_rad = laser.vertical_rad + departure.vertical_rad;
        let ((sin_v, cos_v), (sin_h, cos_h)) = (sin_cos(vertical_rad), sin_cos(laser.horizontal_rad));
        let left_m = if i.is_multiple_of(2) { config.offset_m } else { -config.offset_m } + departure.left_m;
        Mount {
            direction: [cos_v * cos_h, cos_v * sin_h, sin_v].map(|x| x as f32),
            origin_m: [-left_m * sin_h, left_m * cos_h, departure.up_m].map(|x| x as f32),
            after_s: (config.bank_s * i as f64 / count.saturating_sub(1).max(1) as f64) as f32,
            // The head turns clockwise: a laser that looks to the left comes by later.
            lag: (laser.horizontal_rad / step_rad).round() as isize,
        }
    };
    unit.lasers().iter().enumerate().map(mount).collect()
}

/// When the head fires, and how it is turned then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    pub start_s: f64,
    pub firing_rate_hz: f64,
    pub turns_per_firing: f64,
    /// How far the times that are recorded are ahead of the track's.
    ahead_s: f64,
    /// Share of the motion since the beginning of a turn that is taken out of it.
    compensated: f64,
}

impl Clock {
    pub fn new(config: &VelodyneConfig, knobs: &VelodyneKnobs, start_s: f64) -> Self {
        Self {
            start_s,
            firing_rate_hz: config.firing_rate_hz,
            turns_per_firing: turns_per_firing(config, knobs),
            ahead_s: knobs.ahead_s,
            compensated: knobs.compensated,
        }
    }

    /// The time that is recorded.
    pub fn t_s(&self, firing: isize) -> f64 {
        self.start_s + firing as f64 / self.firing_rate_hz
    }

    /// When the sensor is where a firing sees it: when it was fired, or earlier where motion within a turn is taken out.
    pub fn seen_s(&self, firing: isize) -> f64 {
        let since_s = self.turned(firing) / (self.turns_per_firing * self.firing_rate_hz);
        self.t_s(firing) - self.ahead_s - self.compensated * since_s
    }

    /// The encoder's angle, clockwise, as a share of a turn.
    pub fn turned(&self, firing: isize) -> f64 {
        let turns = firing as f64 * self.turns_per_firing;
        turns - turns.floor()
    }
}

/// What the head turns on.
pub(super) struct Base {
    theta_b_rad: f64,
    /// A base that does not stand upright.
    sensor_from_base: Option<Matrix3<f64>>,
}

impl Base {
    pub fn new(config: &VelodyneConfig, knobs: &VelodyneKnobs) -> Self {
        let leans = knobs.pitch_rad != 0.0 || knobs.roll_rad != 0.0;
        let ((sin_p, cos_p), (sin_r, cos_r)) = (sin_cos(knobs.pitch_rad), sin_cos(knobs.roll_rad));
        // Front up about the axis to the right, then left side up about the one ahead.
        let pitched = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos_p, -sin_p, 0.0, sin_p, cos_p);
        let rolled = Matrix3::new(cos_r, 0.0, sin_r, 0.0, 1.0, 0.0, -sin_r, 0.0, cos_r);
        Self { theta_b_rad: config.base_rad, sensor_from_base: leans.then(|| pitched * rolled) }
    }
}

fn turns_per_firing(config: &VelodyneConfig, knobs: &VelodyneKnobs) -> f64 {
    config.turn_rate_hz * knobs.turn_ratio / config.firing_rate_hz
}

/// The head at each of some firings in a row, number by number.
pub(super) struct Heads {
    /// Number of the first firing; it may lie before the start.
    first: isize,
    /// The head's axes in the world: `[row][column][firing]`.
    world_from_head: [[Vec<f32>; 3]; 3],
    position_m: [Vec<f32>; 3],
    velocity_m_per_s: [Vec<f32>; 3],
    spin_rad_per_s: [Vec<f32>; 3],
}

impl Heads {
    pub fn new(track: &Track, clock: &Clock, base: &Base, firings: std::ops::Range<isize>) -> Self {
        let none = || std::array::from_fn(|_| Vec::with_capacity(firings.len()));
        let mut heads = Self {
            first: firings.start,
            world_from_head: [none(), none(), none()],
            position_m: none(),
            velocity_m_per_s: none(),
            spin_rad_per_s: none(),
        };
        let mut hint = track.find(clock.seen_s(firings.start));
        for firing in firings {
            let motion = track.at(clock.seen_s(firing), &mut hint);
            let turn_rad = base.theta_b_rad - std::f64::consts::TAU * clock.turned(firing);
            let (sin, cos) = sin_cos(turn_rad);
            let world_from_base =
                base.sensor_from_base.map_or(motion.world_from_sensor, |it| motion.world_from_sensor * it);
            let world_from_head = world_from_base * Rotation3::from_matrix_unchecked(about_z(sin, cos));
            for row in 0..3 {
                for column in 0..3 {
                    heads.world_from_head[row][column].push(world_from_head[(row, column)] as f32);
                }
                heads.position_m[row].push(motion.position_m[row] as f32);
                heads.velocity_m_per_s[row].push(motion.velocity_m_per_s[row] as f32);
                heads.spin_rad_per_s[row].push(motion.spin_rad_per_s[row] as f32);
            }
        }
        heads
    }

    /// Lays one laser's beams at [`FIRINGS`] firings from `first` into a bundle, as the `slot`-th of its [`LASERS`].
    pub fn aim(&self, mount: &Mount, first: isize, slot: usize, bundle: &mut Bundle) {
        let at = (first - self.first) as usize;
        let mut direction = [[0.0; FIRINGS]; 3];
        let mut off = [[0.0; FIRINGS]; 3];
        for axis in 0..3 {
            self.rotate(axis, at, &mount.direction, &mut direction[axis]);
            if mount.origin_m != [0.0; 3] {
                self.rotate(axis, at, &mount.origin_m, &mut off[axis]);
            }
        }
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let (position, velocity) = (run(&self.position_m[axis], at), run(&self.velocity_m_per_s[axis], at));
            let (spin_next, spin_last) = (run(&self.spin_rad_per_s[next], at), run(&self.spin_rad_per_s[last], at));
            let (mut ahead, mut origin) = ([0.0; FIRINGS], [0.0; FIRINGS]);
            for j in 0..FIRINGS {
                let turned = spin_next[j] * direction[last][j] - spin_last[j] * direction[next][j];
                ahead[j] = direction[axis][j] + mount.after_s * turned;
                origin[j] = position[j] + mount.after_s * velocity[j] + off[axis][j];
            }
            lay(&ahead, slot, &mut bundle.direction[axis]);
            lay(&origin, slot, &mut bundle.origin[axis]);
        }
    }

    /// One world coordinate of a vector of the head's, firing by firing.
    fn rotate(&self, row: usize, at: usize, v: &[f32; 3], into: &mut [f32; FIRINGS]) {
        let [x, y, z] = &self.world_from_head[row];
        let (x, y, z) = (run(x, at), run(y, at), run(z, at));
        for j in 0..FIRINGS {
            into[j] = x[j] * v[0] + y[j] * v[1] + z[j] * v[2];
        }
    }
}

/// [`FIRINGS`] numbers of a column.
fn run(column: &[f32], at: usize) -> &[f32; FIRINGS] {
    column.get(at..).and_then(|column| column.first_chunk()).unwrap_or(&[f32::NAN; FIRINGS])
}

/// Spreads a laser's numbers over its lanes of a bundle.
fn lay(numbers: &[f32; FIRINGS], slot: usize, lanes: &mut [f32; Bundle::RAYS]) {
    for (group, numbers) in numbers.chunks_exact(RUN).enumerate() {
        let lane = LASERS * RUN * group + RUN * slot;
        lanes[lane..lane + RUN].copy_from_slice(numbers);
    }
}

fn about_z(sin: f64, cos: f64) -> Matrix3<f64> {
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}
