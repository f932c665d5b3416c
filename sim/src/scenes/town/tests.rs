use std::collections::BTreeMap;

use asami_math::elementary::sin_cos;
use rapier3d::prelude::{Pose, Ray, SharedShape, Vector};

use super::*;

fn town(detail: f64, seed: u64) -> Town {
    Town::new(&TownConfig { detail, ..TownConfig::default() }, Seed(seed))
}

#[test]
fn same_seed_same_town_other_seed_another() {
    let (a, b, c) = (town(0.0, 1000), town(0.0, 1000), town(0.0, 1001));
    assert!(a.vertices == b.vertices && a.triangles == b.triangles && a.surface == b.surface && a.solids == b.solids);
    assert_ne!(a.vertices, c.vertices);
    assert_ne!(a.route, c.route);
}

#[test]
fn detail_adds_triangles_and_changes_no_draw() {
    let towns = [0.0, 0.1, 0.4, 1.0].map(|detail| town(detail, 1000));
    let counts = towns.each_ref().map(|it| it.triangles.len());
    assert!(counts.is_sorted(), "{counts:?}");
    assert!(counts[0] < 40_000 && (600_000..800_000).contains(&counts[3]), "{counts:?}");
    for it in &towns {
        assert_eq!(it.surface.len(), it.triangles.len());
        assert_eq!(it.solids, towns[0].solids);
        assert_eq!(it.route, towns[0].route);
    }
}

/// Every edge of the ground has a triangle on either side, those of the town's limits apart.
#[test]
fn the_ground_has_no_cracks() {
    for detail in [0.0, 0.1, 0.5] {
        let ground = town(detail, 1002).ground();
        let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for triangle in &ground.triangles {
            for i in 0..3 {
                let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
                *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        let bound = |axis: usize| ground.vertices.iter().map(move |it| it[axis]);
        let limits = [0, 1].map(|axis| [bound(axis).fold(f32::MAX, f32::min), bound(axis).fold(f32::MIN, f32::max)]);
        for (edge, _) in edges.iter().filter(|(_, sides)| **sides != 0) {
            let at_limit = |axis: usize| {
                let [a, b] = edge.map(|at| ground.vertices[at as usize][axis]);
                a == b && limits[axis].contains(&a)
            };
            assert!(at_limit(0) || at_limit(1), "an open edge at {:?}", ground.vertices[edge[0] as usize]);
        }
    }
}

/// Every vertex of an object is one: no two in the ground are at one place.
#[test]
fn vertices_are_welded() {
    let ground = town(0.1, 1000).ground();
    let mut places: Vec<[u32; 3]> = ground.vertices.iter().map(|it| it.map(f32::to_bits)).collect();
    places.sort_unstable();
    places.dedup();
    assert_eq!(places.len(), ground.vertices.len());
}

#[test]
fn the_route_is_closed_smooth_and_turns_left_once_round() {
    let route = town(0.0, 1003).route;
    assert!((route.turn_rad() - std::f64::consts::TAU).abs() < 1e-9);
    let (first, last) = (route.at(0.0), route.at(route.length_m() - 1e-9));
    assert!((first.x_m - last.x_m).hypot(first.y_m - last.y_m) < 1e-6);
    let step_m = 0.01;
    for i in 0..(route.length_m() / step_m) as usize {
        let (a, b) = (route.at(i as f64 * step_m), route.at((i + 1) as f64 * step_m));
        let (dx, dy) = (b.x_m - a.x_m, b.y_m - a.y_m);
        // A chord of an arc points along the tangent at its middle.
        assert!((dx.hypot(dy) - step_m).abs() < 1e-6);
        let along = dx * a.ahead()[0] + dy * a.ahead()[1];
        assert!((along - step_m).abs() < 1e-6, "at {} m", i as f64 * step_m);
        let here_m = route.along_m([a.x_m + 0.4 * a.right()[0], a.y_m + 0.4 * a.right()[1]], i as f64 * step_m - 3.0);
        if i % 100 == 0 {
            assert!((here_m - i as f64 * step_m).abs() < 1e-6, "{here_m}");
        }
    }
}

/// A car of 1.8 m drives it without touching anything.
#[test]
fn the_route_is_clear() {
    for seed in [1000, 1001, 1002] {
        let town = town(0.0, seed);
        for i in 0..town.route.length_m() as usize {
            let at = town.route.at(i as f64);
            for solid in &town.solids {
                let [dx, dy] = [at.x_m - solid.centre_m[0], at.y_m - solid.centre_m[1]];
                let [cos, sin] = solid.along;
                let (x, y) = (dx * cos + dy * sin, dy * cos - dx * sin);
                let outside = |offset: f64, half_m: f64| (offset.abs() - half_m).max(0.0);
                let clear_m = outside(x, solid.half_m[0]).hypot(outside(y, solid.half_m[1]));
                assert!(clear_m > 1.2, "{clear_m} m at {i} m of the route of seed {seed}");
            }
        }
    }
}

/// What the correlation of adjacent lasers lives on: the ranges of each of the lowest 16 lasers, along the route,
/// vary by more than 0.3 m. On bare flat ground they vary by about a centimetre.
#[test]
fn low_lasers_see_relief() {
    for seed in [1000, 1001] {
        let town = town(0.1, seed);
        let vertices = town.vertices.iter().map(|&[x, y, z]| Vector::new(x, y, z)).collect();
        let shape = SharedShape::trimesh(vertices, town.triangles.clone()).unwrap();
        let cast = |from: [f64; 3], along: [f64; 3]| {
            let vector = |it: [f64; 3]| Vector::new(it[0] as f32, it[1] as f32, it[2] as f32);
            shape.cast_ray(&Pose::IDENTITY, &Ray::new(vector(from), vector(along)), 120.0, false).map(f64::from)
        };
        for laser in 0..16 {
            let (rise, flat) = sin_cos((-24.7 + 0.512 * f64::from(laser)).to_radians());
            let mut ranges_m = Vec::new();
            for step in 0..(town.route.length_m() / 10.0) as usize {
                let at = town.route.at(10.0 * step as f64);
                let height_m = 22.0 - cast([at.x_m, at.y_m, 20.0], [0.0, 0.0, -1.0]).unwrap();
                for azimuth in 0..90 {
                    let (sin, cos) = sin_cos(f64::from(4 * azimuth).to_radians());
                    ranges_m.extend(cast([at.x_m, at.y_m, height_m], [flat * cos, flat * sin, rise]));
                }
            }
            let n = ranges_m.len() as f64;
            let mean = ranges_m.iter().sum::<f64>() / n;
            let sd = (ranges_m.iter().map(|it| (it - mean) * (it - mean)).sum::<f64>() / n).sqrt();
            assert!(sd > 0.3, "seed {seed}, laser {laser}: sd {sd} m");
        }
    }
}

#[test]
fn parts_that_do_not_fit_are_faults() {
    let mut faults = Vec::new();
    TownConfig::default().check_fit("town", &mut faults);
    assert_eq!(faults, []);
    TownConfig { corner_radius_m: 5.0, verge_m: 3.0, pavement_m: 3.0, ..TownConfig::default() }
        .check_fit("town", &mut faults);
    TownConfig { street_width_m: 7.0, ..TownConfig::default() }.check_fit("town", &mut faults);
    let paths: Vec<&str> = faults.iter().map(|it| it.path.as_str()).collect();
    assert_eq!(paths, ["town.corner_radius_m", "town.street_width_m"]);
}
