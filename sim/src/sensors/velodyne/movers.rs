//! What beams meet of boxes that move while a drive is scanned.

use asami_raycast::{Bundle, Hits};

use super::returns::Light;
use crate::scenes::solid::Solid;

/// Diffuse reflectivity of painted metal.
const REFLECTIVITY: f32 = 0.4;
/// Bundles no wider than this, as a tangent, are sorted out as a whole.
const WIDTH: f64 = 0.25;

/// Lets a bundle's beams end at boxes that they meet before what they have met, each with its face's light.
pub(super) fn meet(solids: &[Solid], bundle: &Bundle, hits: &mut Hits, light: &mut Light) {
    for solid in solids.iter().filter(|solid| near(solid, bundle)) {
        for (lane, light) in light.iter_mut().enumerate() {
            let origin = [0, 1, 2].map(|k| f64::from(bundle.origin[k][lane]));
            let direction = [0, 1, 2].map(|k| f64::from(bundle.direction[k][lane]));
            if let Some((range_m, cosine)) = enter(solid, origin, direction).filter(|it| it.0 < hits.range[lane]) {
                hits.range[lane] = range_m;
                *light = REFLECTIVITY * cosine;
            }
        }
    }
}

/// Whether a bundle's beams may meet a box, by its first and its last beam.
fn near(solid: &Solid, bundle: &Bundle) -> bool {
    let to = [0, 1].map(|k| solid.centre_m[k] - f64::from(bundle.origin[k][0]));
    let [x, y] = [0, 1].map(|k| f64::from(bundle.direction[k][0]));
    let [last_x, last_y] = [0, 1].map(|k| f64::from(bundle.direction[k][Bundle::RAYS - 1]));
    let narrow = (x * last_y - y * last_x).abs() < WIDTH * (x * last_x + y * last_y);
    let level = (x * x + y * y).sqrt();
    let (ahead_m, aside_m) = ((to[0] * x + to[1] * y) / level, (to[0] * y - to[1] * x).abs() / level);
    let [a, b, _] = solid.half_m;
    let radius_m = (a * a + b * b).sqrt();
    // Whatever is next to the sensor may be met by any beam.
    !narrow || ahead_m > -radius_m && aside_m < radius_m + WIDTH * (ahead_m + radius_m) + 1.0
}

/// Where a beam enters a box, and the cosine of its incidence there.
fn enter(solid: &Solid, origin: [f64; 3], direction: [f64; 3]) -> Option<(f32, f32)> {
    let [cos, sin] = solid.along;
    let turn = |v: [f64; 3]| [cos * v[0] + sin * v[1], cos * v[1] - sin * v[0], v[2]];
    let from = turn([0, 1, 2].map(|k| origin[k] - solid.centre_m[k]));
    let towards = turn(direction);
    let (mut least, mut greatest, mut face) = (0.0, f64::INFINITY, None);
    for k in 0..3 {
        let [a, b] = [-solid.half_m[k], solid.half_m[k]].map(|side| (side - from[k]) / towards[k]);
        let (first, last) = (a.min(b), a.max(b));
        if first > least {
            (least, face) = (first, Some(k));
        }
        greatest = greatest.min(last);
    }
    // From within nothing is entered.
    face.filter(|_| least < greatest).map(|k| (least as f32, towards[k].abs() as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::velodyne::Scenery;

    /// Against the ray caster at the same boxes as triangles, over beams in all directions.
    #[test]
    fn meets_what_triangles_of_the_same_boxes_are_met_at() {
        let along = [0.8, 0.6];
        let solids =
            [([6.0, 2.0, 0.5], [2.0, 0.9, 0.7]), ([-5.0, 7.0, 1.0], [1.0, 3.0, 1.5]), ([3.0, -9.0, 0.0], [2.0; 3])]
                .map(|(centre_m, half_m)| Solid { centre_m, half_m, along });
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for Solid { centre_m, half_m, .. } in &solids {
            let first = vertices.len() as u32;
            vertices.extend((0..8).map(|i: usize| {
                let [x, y, z] = [0, 1, 2].map(|k| if i >> k & 1 == 0 { -half_m[k] } else { half_m[k] });
                [
                    (centre_m[0] + along[0] * x - along[1] * y) as f32,
                    (centre_m[1] + along[1] * x + along[0] * y) as f32,
                    (centre_m[2] + z) as f32,
                ]
            }));
            for [a, b, c, d] in [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]] {
                triangles.extend([[a, b, c], [a, c, d]].map(|it: [u32; 3]| it.map(|corner| first + corner)));
            }
        }
        let scenery = Scenery::new(&vertices, &triangles, |_| f64::from(REFLECTIVITY)).expect("a mesh");
        let (mut met, mut missed) = (0, 0);
        for turn in 0..720 {
            let mut bundle = Bundle::empty();
            for lane in 0..Bundle::RAYS {
                // 16 azimuths within 8 degrees by 4 elevations.
                let (azimuth, up) = (0.5 * f64::from(turn) + 0.5 * (lane % 16) as f64, 0.1 * (lane / 16) as f64 - 0.15);
                let (sin, cos) = azimuth.to_radians().sin_cos();
                let length = (1.0 + up * up).sqrt();
                for (k, x) in [cos / length, sin / length, up / length].into_iter().enumerate() {
                    (bundle.origin[k][lane], bundle.direction[k][lane]) = ([0.3, -0.2, 0.6][k], x as f32);
                }
            }
            let mut expected = Hits::none();
            scenery.caster().cast(&bundle, 100.0, &mut expected);
            let (mut hits, mut light) = (Hits::none(), [0.0; Bundle::RAYS]);
            meet(&solids, &bundle, &mut hits, &mut light);
            let expected_light = super::super::returns::light(&scenery, &bundle, &expected);
            for lane in 0..Bundle::RAYS {
                let (a, b) = (hits.range[lane], expected.range[lane]);
                // At an edge either may miss.
                if a.is_finite() != b.is_finite()
                    || (a - b).abs() > 1e-3
                    || (light[lane] - expected_light[lane]).abs() > 1e-3
                {
                    missed += usize::from(a.is_finite() || b.is_finite());
                }
                met += usize::from(b.is_finite());
            }
        }
        assert!(met > 5_000 && missed < met / 1000, "{missed} of {met}");
    }
}
