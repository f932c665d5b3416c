//! What a hit is, where that is not obvious: both casters, all widths.

use asami_raycast::{Bundle, Caster, Hit, Instructions, MeshError, Packets, Parry, Ray, weld};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

mod scenes;

fn casters(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<(String, Box<dyn Caster>)> {
    let packets = Packets::new(vertices, triangles).expect("a mesh");
    let wide = Instructions::ALL.into_iter().filter_map(|kind| packets.clone().with(kind));
    let wide = wide.map(|caster| (format!("{:?}", caster.instructions()), Box::new(caster) as Box<dyn Caster>));
    let parry = Parry::new(vertices, triangles).expect("a mesh");
    wide.chain([("parry".to_owned(), Box::new(parry) as Box<dyn Caster>)]).collect()
}

/// A square of side 2 in the plane z = 0.
const SQUARE: [[f32; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn down(x: f32, y: f32, z: f32) -> Ray {
    Ray { origin: [x, y, z], direction: [0.0, 0.0, -1.0] }
}

#[test]
fn a_mesh_without_triangles_is_never_met() {
    for (name, caster) in casters(&[], &[]) {
        assert_eq!(caster.cast_all(&[down(0.0, 0.0, 1.0)], 10.0), [None], "{name}");
    }
}

#[test]
fn triangles_without_area_are_never_met_and_keep_their_numbers() {
    let triangles = [[0, 0, 0], [0, 1, 1], [0, 1, 0], HALVES[0], [2, 2, 2], HALVES[1]];
    for (name, caster) in casters(&SQUARE, &triangles) {
        let hits = caster.cast_all(&[down(0.5, -0.5, 2.0), down(-0.5, 0.5, 3.0), down(5.0, 0.0, 1.0)], 10.0);
        let at = |range: f32, triangle: u32| Some(Hit { range, triangle });
        assert_eq!(hits, [at(2.0, 3), at(3.0, 5), None], "{name}");
    }
    for (name, caster) in casters(&SQUARE, &triangles[..3]) {
        assert_eq!(caster.cast_all(&[down(0.0, 0.0, 1.0)], 10.0), [None], "{name}");
    }
}

#[test]
fn rays_that_are_none_meet_nothing_and_leave_the_others_alone() {
    let good = down(0.5, -0.5, 2.0);
    let mut rays = vec![good];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for k in 0..3 {
            let mut ray = good;
            ray.origin[k] = bad;
            rays.push(ray);
            let mut ray = good;
            ray.direction[k] = bad;
            rays.push(ray);
        }
    }
    rays.extend([Ray { direction: [0.0; 3], ..good }, good]);
    for (name, caster) in casters(&SQUARE, &HALVES) {
        let hits = caster.cast_all(&rays, 10.0);
        let met: Vec<usize> = (0..hits.len()).filter(|i| hits[*i].is_some()).collect();
        assert_eq!(met, [0, rays.len() - 1], "{name}");
        for reach in [f32::NAN, 0.0, -1.0, 1.9] {
            assert!(caster.cast_all(&rays, reach).iter().all(Option::is_none), "{name} {reach}");
        }
        for reach in [2.0, f32::INFINITY] {
            assert_eq!(caster.cast_all(&rays, reach)[0], Some(Hit { range: 2.0, triangle: 0 }), "{name} {reach}");
        }
    }
}

#[test]
fn both_sides_are_met_but_nothing_behind_or_at_the_start() {
    for (name, caster) in casters(&SQUARE, &HALVES) {
        let up = Ray { origin: [0.5, -0.5, -2.0], direction: [0.0, 0.0, 1.0] };
        let hits = caster.cast_all(&[up, down(0.5, -0.5, -2.0), down(0.5, -0.5, 0.0)], 10.0);
        assert_eq!(hits, [Some(Hit { range: 2.0, triangle: 0 }), None, None], "{name}");
    }
}

/// Ranges are in lengths of the direction, whatever that is; far away and long or short rays go another way inside.
#[test]
fn a_ray_may_come_from_afar_and_have_any_length() {
    for (name, caster) in casters(&SQUARE, &HALVES).into_iter().filter(|(name, _)| name != "parry") {
        for length in [1e-20_f32, 1e-5, 0.1, 1.0, 30.0, 1e6, 1e20] {
            let ray = Ray { origin: [0.5, -0.5, 2.0], direction: [0.0, 0.0, -length] };
            let Some(hit) = caster.cast_all(&[ray], f32::INFINITY)[0] else { panic!("{name} {length}") };
            assert!((hit.range * length - 2.0).abs() < 1e-5 && hit.triangle == 0, "{name} {length} {hit:?}");
        }
        for far in [100.0_f32, 1e4, 1e7] {
            let ray = down(0.5, -0.5, far);
            let Some(hit) = caster.cast_all(&[ray], f32::INFINITY)[0] else { panic!("{name} {far}") };
            assert!((hit.range / far - 1.0).abs() < 1e-6, "{name} {far} {hit:?}");
            assert_eq!(caster.cast_all(&[ray], 0.99 * far), [None], "{name} {far}");
            let past = Ray { direction: [0.1, 0.0, -1.0], ..ray };
            assert_eq!(caster.cast_all(&[past], f32::INFINITY), [None], "{name} {far}");
        }
    }
}

#[test]
fn of_triangles_in_one_place_the_first_is_met() {
    let triangles: Vec<[u32; 3]> = (0..40).map(|_| HALVES[0]).collect();
    let packets = Packets::new(&SQUARE, &triangles).expect("a mesh");
    for kind in Instructions::ALL {
        let Some(caster) = packets.clone().with(kind) else { continue };
        let rays: Vec<Ray> = (0..64).map(|i| down(0.9, -0.9 + 0.02 * i as f32, 1.0)).collect();
        assert!(caster.cast_all(&rays, 10.0).iter().all(|hit| hit.is_some_and(|hit| hit.triangle == 0)), "{kind:?}");
    }
}

/// Neither its companions nor its lane change what a ray meets.
#[test]
fn company_does_not_matter() {
    let scene = scenes::soup(3000, 40.0, 1002);
    let mut rays = scenes::rays(6400, 40.0, 1003);
    rays.extend(scenes::drive(1).iter().flat_map(|bundle| (0..Bundle::RAYS).map(|lane| bundle.ray(lane))));
    let mut order: Vec<usize> = (0..rays.len()).collect();
    order.shuffle(&mut ChaCha8Rng::seed_from_u64(1004));
    let shuffled: Vec<Ray> = order.iter().map(|i| rays[*i]).collect();
    let packets = Packets::new(&scene.vertices, &scene.triangles).expect("a mesh");
    for kind in Instructions::ALL {
        let Some(caster) = packets.clone().with(kind) else { continue };
        let (hits, mixed) = (caster.cast_all(&rays, 100.0), caster.cast_all(&shuffled, 100.0));
        for (place, i) in order.iter().enumerate() {
            assert_eq!(mixed[place], hits[*i], "{kind:?}");
        }
    }
}

#[test]
fn a_mesh_without_meaning_is_refused() {
    let corner = MeshError::Corner { triangle: 1, corners: [0, 2, 4], vertices: 4 };
    assert_eq!(Packets::new(&SQUARE, &[[0, 1, 2], [0, 2, 4]]).err(), Some(corner));
    for bad in [f32::NAN, f32::INFINITY, 2e6] {
        let mut vertices = SQUARE;
        vertices[2][1] = bad;
        let refused = Packets::new(&vertices, &HALVES).err();
        assert!(matches!(refused, Some(MeshError::Vertex { vertex: 2, .. })), "{refused:?}");
        assert!(Parry::new(&vertices, &HALVES).is_err());
    }
}

/// Two squares whose common edge is off by a tenth of a millimetre: rays slip through until they are welded.
#[test]
fn welding_closes_cracks() {
    let gap = 1e-4;
    let right = SQUARE.map(|[x, y, z]| [x + 2.0 + gap, y, z]);
    let vertices: Vec<[f32; 3]> = SQUARE.into_iter().chain(right).collect();
    let triangles: Vec<[u32; 3]> = HALVES.into_iter().chain(HALVES.map(|corners| corners.map(|c| c + 4))).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(1005);
    let rays: Vec<Ray> =
        (0..200).map(|_| down(1.0 + gap * rng.random_range(0.1..0.9), rng.random_range(-0.9..0.9), 1.0)).collect();
    let met = |vertices: &[[f32; 3]], triangles: &[[u32; 3]]| {
        let caster = Packets::new(vertices, triangles).expect("a mesh");
        caster.cast_all(&rays, 10.0).iter().flatten().count()
    };
    assert_eq!(met(&vertices, &triangles), 0);
    let (welded, same) = weld(&vertices, &triangles, 1e-3);
    assert_eq!((welded.len(), same.len()), (6, 4));
    assert_eq!(met(&welded, &same), 200);
}
