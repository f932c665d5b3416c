//! Scenes of a few boxes, and scanners of a few beams.

use std::sync::LazyLock;

use asami_dataset::{Firings, Seed};
use asami_sim::effects::Effects;
use asami_sim::scenes::town::Traffic;
use asami_sim::sensors::velodyne::{Laser, Scenery, SensorPose, Unit, Velodyne, VelodyneConfig};
use nalgebra::UnitQuaternion;

/// Level ground with a pillar every 20 m.
pub static YARD: LazyLock<Scenery> = LazyLock::new(|| {
    let pillar = |i: i32| block([f64::from(i % 8) * 20.0 - 70.0, f64::from(i / 8) * 20.0 - 70.0], 0.0);
    boxes(&(0..64).map(pillar).collect::<Vec<_>>())
});

/// A box by its least and greatest corner.
pub type Corners = [[f64; 3]; 2];

/// A pillar of 2 m by 2 m and 6 m on a foot.
pub fn block([x, y]: [f64; 2], foot_m: f64) -> Corners {
    [[x - 1.0, y - 1.0, foot_m], [x + 1.0, y + 1.0, foot_m + 6.0]]
}

/// Boxes on level ground at height 0.
pub fn boxes(boxes: &[Corners]) -> Scenery {
    let ground = [[-400.0, -400.0, -1.0], [400.0, 400.0, 0.0]];
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for corners in boxes.iter().chain([&ground]) {
        let first = vertices.len() as u32;
        vertices.extend((0..8).map(|i: usize| [0, 1, 2].map(|k| corners[i >> k & 1][k] as f32)));
        for [a, b, c, d] in [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]] {
            triangles.extend([[a, b, c], [a, c, d]].map(|triangle| triangle.map(|corner| first + corner)));
        }
    }
    Scenery::new(&vertices, &triangles, |_| 0.5).expect("a mesh")
}

/// As many cars as the effects say, on a ring of 200 m about the origin.
pub fn traffic(effects: &Effects, seed: Seed) -> Traffic {
    let per_km = effects.moving_traffic.as_ref().map_or(0.0, |it| it.per_km);
    let ring = (0..200).map(|metre| {
        let (sin, cos) = (f64::from(metre) * std::f64::consts::TAU / 200.0).sin_cos();
        [31.8 * cos, 31.8 * sin, 0.0]
    });
    Traffic::new(ring.collect(), per_km, &mut seed.stream("effect/moving_traffic"))
}

/// Forty firings a turn.
pub fn few_beams() -> VelodyneConfig {
    VelodyneConfig { firing_rate_hz: 400.0, ..VelodyneConfig::default() }
}

/// Eight of the lasers.
pub fn every_eighth() -> Unit {
    Unit::of(Unit::art().lasers().iter().step_by(8).copied().collect())
}

/// Lasers that look along the encoder's zero at these angles above the horizon.
pub fn fan(vertical_deg: &[f64]) -> Unit {
    let laser = |deg: &f64| Laser { vertical_rad: deg.to_radians(), horizontal_rad: 0.0 };
    Unit::of(vertical_deg.iter().map(laser).collect())
}

/// Exact ranges, nothing lost, the encoder's zero straight ahead.
pub fn exact() -> VelodyneConfig {
    VelodyneConfig {
        base_rad: std::f64::consts::FRAC_PI_2,
        range_sd_m: 0.0,
        dropouts: 0.0,
        half_lost_range_m: 1e5,
        ..VelodyneConfig::default()
    }
}

/// Poses every 10 ms of a sensor 2 m above the ground that moves evenly along y.
pub fn along_y(from_m: f64, speed_m_per_s: f64, until_s: f64) -> Vec<SensorPose> {
    let pose = |k: i32| {
        let t_s = f64::from(k) * 0.01;
        let position_m = [0.0, from_m + speed_m_per_s * t_s, 2.0];
        SensorPose { t_s, position_m, world_from_sensor: UnitQuaternion::identity() }
    };
    (0..=(until_s * 100.0).round() as i32).map(pose).collect()
}

/// What a scanner with effects records.
pub fn scan(config: VelodyneConfig, unit: Unit, effects: &Effects, scenery: &Scenery, poses: &[SensorPose]) -> Firings {
    let seed = Seed(1000);
    Velodyne::new(config, unit).under(effects, seed).scan(scenery, poses, seed).expect("a track")
}

/// Mean range of a laser over the firings whose bearing from straight ahead, to the left, is within 3 degrees of one.
pub fn towards_m(firings: &Firings, laser: usize, bearing_deg: f64) -> f64 {
    let near = |i: &usize| {
        let bearing_rad = firings.theta_r_rad(*i).expect("a firing");
        let off_rad = asami_math::angle::wrap_rad(bearing_rad - bearing_deg.to_radians());
        off_rad.abs() < 3.0_f64.to_radians()
    };
    let ranges: Vec<f64> = (0..firings.len()).filter(near).filter_map(|i| firings.range_m(laser, i)).collect();
    ranges.iter().sum::<f64>() / ranges.len() as f64
}
