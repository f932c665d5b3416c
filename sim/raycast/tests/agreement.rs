//! Packets against parry3d, and a brute force in double precision where the two disagree.

use asami_raycast::{Bundle, Caster, Hits, Instructions, Packets, Parry, Ray};

mod scenes;

const REACH_M: f32 = 120.0;
/// What counts as agreement.
const APART_M: f64 = 1e-3;

/// The nearest triangle's range in double precision, by every triangle; infinite if there is none within reach.
fn brute_force(scene: &scenes::Scene, ray: &Ray) -> f64 {
    let (o, d) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut nearest = f64::INFINITY;
    for triangle in &scene.triangles {
        let [a, b, c] = triangle.map(|corner| scene.vertices[corner as usize].map(f64::from));
        let [a, b, c] = [minus(a, o), minus(b, o), minus(c, o)];
        // Volumes that the ray spans with each edge: all of one sign where it passes through.
        let sides = [dot(d, cross(b, a)), dot(d, cross(c, b)), dot(d, cross(a, c))];
        if sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0) {
            let normal = cross(minus(b, a), minus(c, a));
            let range = dot(normal, a) / dot(normal, d);
            if range > 0.0 && range <= f64::from(REACH_M) {
                nearest = nearest.min(range);
            }
        }
    }
    nearest
}

/// Rays cast, rays on which packets err by more than a millimetre, and rays on which parry3d does.
fn disagreements(scene: &scenes::Scene, bundles: &[Bundle]) -> (usize, usize, usize) {
    let packets = Packets::new(&scene.vertices, &scene.triangles).expect("a mesh");
    let parry = Parry::new(&scene.vertices, &scene.triangles).expect("a mesh");
    let (mut ours, mut theirs) = (Hits::none(), Hits::none());
    let (mut rays, mut packets_err, mut parry_errs) = (0, 0, 0);
    for bundle in bundles {
        packets.cast(bundle, REACH_M, &mut ours);
        parry.cast(bundle, REACH_M, &mut theirs);
        for lane in (0..Bundle::RAYS).filter(|lane| !bundle.origin[0][*lane].is_nan()) {
            let [a, b] = [ours.range[lane], theirs.range[lane]].map(f64::from);
            rays += 1;
            // The difference of two infinities is no number, and not above anything.
            if (a - b).abs() > APART_M {
                let truth = brute_force(scene, &bundle.ray(lane));
                let errs = |range: f64| (range - truth).abs() > APART_M;
                packets_err += usize::from(errs(a));
                parry_errs += usize::from(errs(b));
            }
        }
    }
    (rays, packets_err, parry_errs)
}

#[test]
fn packets_agree_with_parry_in_a_coarse_town() {
    let (rays, packets, parry) = disagreements(&scenes::town(false), &scenes::drive(10));
    println!("{rays} rays: packets err on {packets}, parry3d on {parry}");
    assert!(rays >= 499_200 && packets * 100_000 <= rays, "{packets} of {rays}");
}

#[test]
fn packets_agree_with_parry_in_a_fine_town() {
    let (rays, packets, parry) = disagreements(&scenes::town(true), &scenes::drive(10));
    println!("{rays} rays: packets err on {packets}, parry3d on {parry}");
    assert!(rays >= 499_200 && packets * 100_000 <= rays, "{packets} of {rays}");
}

#[test]
fn packets_agree_with_parry_on_rays_without_order() {
    let scene = scenes::soup(5000, 50.0, 1000);
    let bundles: Vec<Bundle> = scenes::rays(100_000, 60.0, 1001).chunks(64).map(Bundle::of).collect();
    let (rays, packets, parry) = disagreements(&scene, &bundles);
    println!("{rays} rays: packets err on {packets}, parry3d on {parry}");
    assert!(rays == 100_000 && packets <= 1, "{packets} of {rays}");
}

#[test]
fn every_width_gives_the_same_bits() {
    for fine in [false, true] {
        let (scene, bundles) = (scenes::town(fine), scenes::drive(4));
        let packets = Packets::new(&scene.vertices, &scene.triangles).expect("a mesh");
        let casters: Vec<_> = Instructions::ALL.into_iter().filter_map(|kind| packets.clone().with(kind)).collect();
        let (mut first, mut other) = (Hits::none(), Hits::none());
        for bundle in &bundles {
            casters[0].cast(bundle, REACH_M, &mut first);
            for caster in &casters[1..] {
                caster.cast(bundle, REACH_M, &mut other);
                assert_eq!(first, other, "{:?}", caster.instructions());
            }
        }
    }
}
