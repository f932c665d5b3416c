//! What packets must find, found without a hierarchy and one lane at a time.

use crate::bundle::{Bundle, Hit, Hits, Ray};
use crate::bvh::{Bvh, Inner};
use crate::caster::Caster;
use crate::facet::{Nearest, meet, number};
use crate::packets::{Instructions, Packets};
use crate::slab::{Octant, Slabs};

#[path = "../tests/scenes/mod.rs"]
mod scenes;

/// All leaves, all triangles, by the scalar instance of the one routine.
fn every_triangle(bvh: &Bvh, ray: &Ray, reach: f32) -> Option<Hit> {
    let (origin, direction) = (ray.origin, ray.direction);
    // SAFETY: one lane needs no special instructions.
    let nearest = unsafe {
        let slabs = Slabs::<f32>::new(&origin, &direction);
        let mut nearest = Nearest::none(reach);
        let octant = Octant::of([false; 3], [false; 3]);
        for leaf in bvh.nodes.iter().flat_map(|pair| &pair.0) {
            if let Inner::Triangles { first, count } = leaf.inner() {
                // As far as any triangle: nothing is left out for being too far.
                let inside = slabs.inside::<false>(leaf, octant, f32::INFINITY);
                for k in first as usize..(first + count) as usize {
                    meet(&bvh.facets[k], bvh.numbers[k], &origin, &direction, &inside, &mut nearest);
                }
            }
        }
        nearest
    };
    let triangle = number(nearest.triangle);
    (triangle != Hits::NOTHING).then_some(Hit { range: nearest.range, triangle })
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32)> {
    hit.map(|hit| (hit.range.to_bits(), hit.triangle))
}

fn hold(scene: &scenes::Scene, bundles: &[Bundle], reach: f32) -> usize {
    let packets = Packets::new(&scene.vertices, &scene.triangles).expect("a mesh");
    let casters: Vec<Packets> = Instructions::ALL.into_iter().filter_map(|kind| packets.clone().with(kind)).collect();
    let mut hits = Hits::none();
    let mut met = 0;
    for bundle in bundles {
        let expected: Vec<_> =
            (0..Bundle::RAYS).map(|lane| bits(every_triangle(packets.bvh(), &bundle.ray(lane), reach))).collect();
        met += expected.iter().flatten().count();
        for caster in &casters {
            caster.cast(bundle, reach, &mut hits);
            let got: Vec<_> = (0..Bundle::RAYS).map(|lane| bits(hits.hit(lane))).collect();
            assert_eq!(got, expected, "{:?}", caster.instructions());
        }
    }
    met
}

#[test]
fn all_widths_give_the_bits_of_the_scalar_routine_in_a_town() {
    // The last bundle of a revolution has empty lanes, which the oracle has no rule for.
    let bundles: Vec<Bundle> =
        scenes::drive(3).into_iter().filter(|bundle| !bundle.origin[0][63].is_nan()).step_by(29).collect();
    let met = hold(&scenes::town(false), &bundles, 120.0);
    assert!(met > bundles.len() * 32, "{met} of {} bundles", bundles.len());
}

#[test]
fn all_widths_give_the_bits_of_the_scalar_routine_in_a_soup() {
    for seed in 1000..1010 {
        let scene = scenes::soup(1000, 30.0, seed);
        let bundles: Vec<Bundle> = scenes::rays(640, 30.0, seed).chunks(64).map(Bundle::of).collect();
        assert!(hold(&scene, &bundles, f32::INFINITY) > 64);
        assert!(hold(&scene, &bundles, 8.0) > 16);
    }
}

/// Along edges and through corners of a grid, in its plane, and along the axes, everything is a tie or hangs on roundings.
#[test]
fn all_widths_agree_where_everything_is_a_tie() {
    let mut scene = scenes::Scene::default();
    for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
        for z in [0.0, 0.0, 1.0] {
            let at = |i: i32, j: i32| [i as f32 * 0.7 - 4.0, j as f32 * 0.7 - 4.0, z];
            scene.polygon(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let mut rays = Vec::new();
    for (i, j) in (0..24).flat_map(|i| (0..24).map(move |j| (i, j))) {
        let at = [i as f32 * 0.35 - 4.0, j as f32 * 0.35 - 4.0];
        for direction in [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.3, -0.0, -1.0], [1.0, 1.0, -1e-7]] {
            rays.extend([2.0, 0.5, 0.0].map(|z| Ray { origin: [at[0], at[1], z], direction }));
        }
    }
    let bundles: Vec<Bundle> = rays.chunks_exact(64).map(Bundle::of).collect();
    assert!(hold(&scene, &bundles, 100.0) > 1000);
}
