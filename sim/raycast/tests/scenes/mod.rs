//! Things to cast at, and rays to cast: for the tests and the benches.

#![allow(dead_code, reason = "each user takes its part")]

use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Bundle, Ray};

/// Side of a block, street included.
const BLOCK_M: f64 = 80.0;
const BLOCKS: [usize; 2] = [7, 6];
/// Firings of one revolution.
const FIRINGS: usize = 780;

/// Vertices and triangles.
#[derive(Default)]
pub struct Scene {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// A place to build at: turned and moved.
#[derive(Clone, Copy)]
struct Site {
    at: [f64; 3],
    turn: [f64; 2],
}

impl Site {
    fn new(at: [f64; 3], yaw: f64) -> Self {
        Self { at, turn: [yaw.cos(), yaw.sin()] }
    }

    fn point(&self, [x, y, z]: [f64; 3]) -> [f32; 3] {
        let [c, s] = self.turn;
        [self.at[0] + c * x - s * y, self.at[1] + s * x + c * y, self.at[2] + z].map(|x| x as f32)
    }
}

impl Scene {
    pub fn polygon(&mut self, corners: &[[f32; 3]]) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.triangles.extend((2..corners.len() as u32).map(|k| [first, first + k - 1, first + k]));
    }

    fn cuboid(&mut self, site: &Site, [x, y]: [f64; 2], [low, high]: [f64; 2]) {
        let around = [[-x, -y], [x, -y], [x, y], [-x, y]];
        for i in 0..4 {
            let ([ax, ay], [bx, by]) = (around[i], around[(i + 1) % 4]);
            let corners = [[ax, ay, low], [bx, by, low], [bx, by, high], [ax, ay, high]];
            self.polygon(&corners.map(|corner| site.point(corner)));
        }
        for z in [low, high] {
            self.polygon(&around.map(|[x, y]| site.point([x, y, z])));
        }
    }

    /// A wall from `a` to `b`, with windows let into it if it is `fine`.
    fn wall(&mut self, site: &Site, a: [f64; 2], b: [f64; 2], height: f64, fine: bool) {
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let at = |u: f64, z: f64, deep: f64| {
            site.point([a[0] + along[0] * u - along[1] * deep, a[1] + along[1] * u + along[0] * deep, z])
        };
        if !fine {
            return self.polygon(&[
                at(0.0, 0.0, 0.0),
                at(length, 0.0, 0.0),
                at(length, height, 0.0),
                at(0.0, height, 0.0),
            ]);
        }
        let [columns, floors] = [length / 3.2, height / 2.8].map(|count| count.floor().max(1.0) as usize);
        let (wide, high) = (length / columns as f64, height / floors as f64);
        for (i, j) in (0..columns).flat_map(|i| (0..floors).map(move |j| (i, j))) {
            let us = [0.0, 0.3, 0.7, 1.0].map(|share| (i as f64 + share) * wide);
            let zs = [0.0, 0.3, 0.8, 1.0].map(|share| (j as f64 + share) * high);
            let mut panel = |u: [f64; 2], z: [f64; 2], deep: [f64; 4]| {
                self.polygon(&[
                    at(u[0], z[0], deep[0]),
                    at(u[1], z[0], deep[1]),
                    at(u[1], z[1], deep[2]),
                    at(u[0], z[1], deep[3]),
                ]);
            };
            let flat = [0.0; 4];
            panel([us[0], us[3]], [zs[0], zs[1]], flat);
            panel([us[0], us[3]], [zs[2], zs[3]], flat);
            panel([us[0], us[1]], [zs[1], zs[2]], flat);
            panel([us[2], us[3]], [zs[1], zs[2]], flat);
            let deep = 0.2;
            panel([us[1], us[2]], [zs[1], zs[2]], [deep; 4]);
            panel([us[1], us[2]], [zs[1], zs[1]], [0.0, 0.0, deep, deep]);
            panel([us[1], us[2]], [zs[2], zs[2]], [0.0, 0.0, deep, deep]);
            panel([us[1], us[1]], [zs[1], zs[2]], [0.0, deep, deep, 0.0]);
            panel([us[2], us[2]], [zs[1], zs[2]], [0.0, deep, deep, 0.0]);
        }
    }

    /// A rough ball; `power` below 1 makes it boxy.
    fn ball(&mut self, site: &Site, radii: [f64; 3], rings: usize, power: f64, rough: f64, rng: &mut ChaCha8Rng) {
        let (first, around) = (self.vertices.len() as u32, 2 * rings as u32);
        let bent = |x: f64| x.signum() * x.abs().powf(power);
        for (ring, i) in (0..=rings).flat_map(|ring| (0..around).map(move |i| (ring, i))) {
            let (up, turn) = (PI * ring as f64 / rings as f64 - PI / 2.0, TAU * f64::from(i) / f64::from(around));
            let r = 1.0 + rough * (2.0 * rng.random::<f64>() - 1.0);
            let [x, y, z] = [bent(up.cos()) * bent(turn.cos()), bent(up.cos()) * bent(turn.sin()), bent(up.sin())];
            self.vertices.push(site.point([r * radii[0] * x, r * radii[1] * y, r * radii[2] * z]));
        }
        for (ring, i) in (0..rings as u32).flat_map(|ring| (0..around).map(move |i| (ring, i))) {
            let (a, b) = (first + ring * around + i, first + ring * around + (i + 1) % around);
            self.triangles.extend([[a, b, b + around], [a, b + around, a + around]]);
        }
    }

    fn house(&mut self, site: &Site, [x, y]: [f64; 2], height: f64, fine: bool, rng: &mut ChaCha8Rng) {
        let around = [[-x, -y], [x, -y], [x, y], [-x, y]];
        for i in 0..4 {
            self.wall(site, around[i], around[(i + 1) % 4], height, fine);
        }
        let top = height + rng.random_range(1.5..3.5);
        let (over, eaves) = (0.4, height - 0.1);
        for side in [-1.0, 1.0] {
            let roof = [
                [-x - over, side * (y + over), eaves],
                [x + over, side * (y + over), eaves],
                [x + over, 0.0, top],
                [-x - over, 0.0, top],
            ];
            self.polygon(&roof.map(|corner| site.point(corner)));
            let gable = [[side * x, -y, height], [side * x, y, height], [side * x, 0.0, top]];
            self.polygon(&gable.map(|corner| site.point(corner)));
        }
        if fine {
            self.cuboid(site, [0.4, 0.4], [height, top + 0.8]);
        }
    }

    /// One side of a block: houses with fences, poles, trees and cars in front.
    fn side(&mut self, centre: [f64; 2], yaw: f64, fine: bool, rng: &mut ChaCha8Rng) {
        let (half, [c, s]) = (BLOCK_M / 2.0, [yaw.cos(), yaw.sin()]);
        let site = |along: f64, deep: f64, z: f64| {
            let out = half - deep;
            Site { at: [centre[0] + c * along + s * out, centre[1] + s * along - c * out, z], turn: [c, s] }
        };
        let mut along = -half + 10.0 + rng.random_range(0.0..2.0);
        while along < half - 19.0 {
            let [wide, deep, set_back] =
                [rng.random_range(7.0..14.0), rng.random_range(7.0..11.0), rng.random_range(8.0..12.5)];
            let height = 2.8 * f64::from(rng.random_range(1..=3)) + rng.random_range(0.0..0.6);
            self.house(
                &site(along + wide / 2.0, set_back + deep / 2.0, 0.12),
                [wide / 2.0, deep / 2.0],
                height,
                fine,
                rng,
            );
            if rng.random_bool(0.5) {
                let fence = rng.random_range(0.8..1.4);
                if fine {
                    for k in 0..(wide / 0.3) as usize {
                        let picket = site(along + 0.3 * k as f64, 7.3, 0.12);
                        self.polygon(
                            &[[0.0, 0.0], [0.16, 0.0], [0.16, fence], [0.0, fence]]
                                .map(|[x, z]| picket.point([x, 0.0, z])),
                        );
                    }
                } else {
                    self.cuboid(&site(along + wide / 2.0, 7.3, 0.12), [wide / 2.0, 0.04], [0.0, fence]);
                }
            }
            along += wide + rng.random_range(2.0..6.0);
        }
        let (rings, poles) = if fine { (8, 2) } else { (3, 1) };
        for k in 0..poles {
            self.cuboid(
                &site(-half + 12.0 + 33.0 * f64::from(k) + rng.random_range(-3.0..3.0), 5.6, 0.12),
                [0.1, 0.1],
                [0.0, 7.0],
            );
        }
        for _ in 0..2 {
            let (along, trunk, crown) =
                (rng.random_range(-half + 12.0..half - 14.0), rng.random_range(1.8..2.6), rng.random_range(1.2..2.4));
            self.cuboid(&site(along, 6.4, 0.12), [0.15, 0.15], [0.0, trunk + 0.3]);
            self.ball(&site(along, 6.4, 0.12 + trunk + crown), [crown; 3], rings, 1.0, 0.15, rng);
        }
        for _ in 0..2 {
            let along = rng.random_range(-half + 14.0..half - 14.0);
            if fine {
                self.ball(&site(along, 4.0, 0.65), [2.2, 0.88, 0.45], 10, 0.4, 0.0, rng);
                self.ball(&site(along, 4.0, 1.15), [1.2, 0.78, 0.35], 8, 0.5, 0.0, rng);
            } else {
                self.cuboid(&site(along, 4.0, 0.0), [2.2, 0.88], [0.2, 0.95]);
                self.cuboid(&site(along, 4.0, 0.0), [1.2, 0.78], [0.95, 1.48]);
            }
        }
    }
}

/// A town of 42 blocks, of some 35 thousand triangles, or if it is `fine` of some 670 thousand.
pub fn town(fine: bool) -> Scene {
    let (mut scene, mut rng) = (Scene::default(), ChaCha8Rng::seed_from_u64(42));
    let size = BLOCKS.map(|count| count as f64 * BLOCK_M);
    let cells = if fine { 190 } else { 1 };
    let ground = |i: usize, j: usize| {
        let wave = if fine { 0.02 * ((i as f64 * 0.7).sin() + (j as f64 * 0.9).cos()) } else { 0.0 };
        let at = |i: usize, size: f64| -100.0 + (size + 200.0) * i as f64 / f64::from(cells);
        [at(i, size[0]), at(j, size[1]), wave].map(|x| x as f32)
    };
    for (i, j) in (0..cells as usize).flat_map(|i| (0..cells as usize).map(move |j| (i, j))) {
        scene.polygon(&[ground(i, j), ground(i + 1, j), ground(i + 1, j + 1), ground(i, j + 1)]);
    }
    for (i, j) in (0..BLOCKS[0]).flat_map(|i| (0..BLOCKS[1]).map(move |j| (i, j))) {
        let centre = [(i as f64 + 0.5) * BLOCK_M, (j as f64 + 0.5) * BLOCK_M];
        let half = BLOCK_M / 2.0 - 5.0;
        scene.cuboid(&Site::new([centre[0], centre[1], 0.0], 0.0), [half, half], [-0.1, 0.12]);
        for side in 0..4 {
            scene.side(centre, f64::from(side) * PI / 2.0, fine, &mut rng);
        }
    }
    scene
}

/// Triangles of all sizes anywhere within `size_m` of the middle.
pub fn soup(count: usize, size_m: f32, seed: u64) -> Scene {
    let (mut scene, mut rng) = (Scene::default(), ChaCha8Rng::seed_from_u64(seed));
    for _ in 0..count {
        let at: [f32; 3] = std::array::from_fn(|_| rng.random_range(-size_m..size_m));
        let spread = size_m * rng.random_range(0.0_f32..0.6).powi(3);
        let corner = |rng: &mut ChaCha8Rng| at.map(|x| x + spread * rng.random_range(-1.0_f32..1.0));
        let corners = [corner(&mut rng), corner(&mut rng), corner(&mut rng)];
        scene.polygon(&corners);
    }
    scene
}

/// Rays from anywhere to anywhere within `size_m` of the middle.
pub fn rays(count: usize, size_m: f32, seed: u64) -> Vec<Ray> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut point = || -> [f32; 3] { std::array::from_fn(|_| rng.random_range(-size_m..size_m)) };
    let between = |a: [f32; 3], b: [f32; 3]| Ray { origin: a, direction: unit(std::array::from_fn(|k| b[k] - a[k])) };
    (0..count).map(|_| between(point(), point())).collect()
}

pub fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = v.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>().sqrt();
    v.map(|x| (f64::from(x) / length) as f32)
}

/// Revolutions of a Velodyne on a drive through the town, 4 lasers and 16 firings to a bundle; groups of 16 are 4 by 4.
pub fn drive(revolutions: usize) -> Vec<Bundle> {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let corrections: Vec<f64> = (0..64).map(|_| rng.random_range(-9.0_f64..9.0).to_radians()).collect();
    let step = TAU / FIRINGS as f64;
    let elevation = |l: usize| {
        let l = l as f64;
        (if l < 32.0 { -24.7 + 15.8 * l / 31.0 } else { -8.5 + 10.5 * (l - 32.0) / 31.0 }).to_radians()
    };
    let ray = |laser: usize, firing: f64| {
        let along = firing / FIRINGS as f64 * 0.76;
        let (leg, rest) = ((along / 400.0).floor(), along % 400.0);
        let origin = [80.0 + rest, 80.0 + 80.0 * leg + 1.5, 2.0].map(|x| x as f32);
        let turn = firing * step + corrections[laser];
        let up = elevation(laser);
        Ray { origin, direction: [up.cos() * turn.cos(), up.cos() * turn.sin(), up.sin()].map(|x| x as f32) }
    };
    let mut bundles = Vec::new();
    // Every 90th revolution, so that they see different streets.
    for revolution in 0..revolutions {
        let start = (90 * revolution * FIRINGS) as f64;
        for (block, lasers) in (0..FIRINGS.div_ceil(16)).flat_map(|block| (0..16).map(move |lasers| (block, lasers))) {
            let mut bundle = Bundle::empty();
            for lane in 0..Bundle::RAYS {
                let (group, within) = (lane / 16, lane % 16);
                let (laser, firing) = (4 * lasers + within / 4, 16 * block + 4 * group + within % 4);
                let shift = (corrections[laser] / step).round();
                if firing < FIRINGS {
                    bundle.put(lane, &ray(laser, start + firing as f64 - shift));
                }
            }
            bundles.push(bundle);
        }
    }
    bundles
}
