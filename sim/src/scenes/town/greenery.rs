//! Trees, hedges, fences, poles.

use asami_dataset::Rng;
use asami_math::elementary::{sin, sin_cos};

use super::Surface;
use super::mesh::{Mesh, Place, Point, circle};
use super::terrain::between;

/// What a tree is.
pub(super) struct Tree {
    trunk_m: f64,
    height_m: f64,
    crown_m: f64,
    lean: f64,
}

impl Tree {
    pub fn draw(rng: &mut Rng) -> Self {
        Self {
            trunk_m: between(rng, 0.1, 0.24),
            height_m: between(rng, 3.5, 8.0),
            crown_m: between(rng, 1.1, 2.6),
            lean: between(rng, 0.0, std::f64::consts::TAU),
        }
    }

    pub fn trunk_m(&self) -> f64 {
        self.trunk_m
    }

    pub fn height_m(&self) -> f64 {
        self.height_m
    }

    pub fn build(&self, mesh: &mut Mesh, place: &Place, detail: f64) {
        mesh.object();
        let sides = 3 + (6.0 * detail) as usize;
        let trunk_m = self.height_m - self.crown_m;
        place.column(
            mesh,
            [0.0, 0.0, -0.4],
            [1.3 * self.trunk_m, 0.7 * self.trunk_m],
            trunk_m + 0.4,
            sides,
            Surface::Bark,
        );
        mesh.object();
        let middle = [0.2 * sin(self.lean), 0.2 * sin(2.0 * self.lean), self.height_m - 0.7 * self.crown_m];
        let rough = (6.0 + self.lean, 0.12);
        let grain = if detail > 0.0 { [3 + (5.0 * detail) as usize, 6 + (6.0 * detail) as usize] } else { [2, 4] };
        blob(mesh, place, middle, [self.crown_m, self.crown_m, 1.15 * self.crown_m], rough, grain);
    }
}

/// A bumpy ball. `rough` is a phase and a share of the radius.
fn blob(mesh: &mut Mesh, place: &Place, middle: Point, radii: Point, rough: (f64, f64), [rows, sides]: [usize; 2]) {
    let ring = |row: usize| -> Vec<Point> {
        let (rise, flat) = sin_cos(std::f64::consts::PI * (row as f64 / rows as f64 - 0.5));
        let point = |[c, s]: [f64; 2]| {
            let [x, y, z] = [c * flat, s * flat, rise];
            let swell =
                1.0 + rough.1 * (sin(5.0 * x + rough.0) + sin(6.0 * y - rough.0) + sin(5.0 * z + 2.0 * rough.0));
            place.at([
                middle[0] + radii[0] * x * swell,
                middle[1] + radii[1] * y * swell,
                middle[2] + radii[2] * z * swell,
            ])
        };
        circle(sides).map(point).collect()
    };
    for row in 0..rows {
        mesh.band(&ring(row), &ring(row + 1), Surface::Leaves);
    }
}

/// What stands between a garden and the verge.
#[derive(Clone, Copy)]
pub(super) enum Border {
    Picket,
    Hedge,
    Wall,
}

impl Border {
    /// Builds it along the place's x axis, over the ground given for places along it.
    pub fn build(self, mesh: &mut Mesh, place: &Place, span_m: [f64; 2], ground_m: &dyn Fn(f64) -> f64, detail: f64) {
        let length_m = span_m[1] - span_m[0];
        match self {
            Border::Picket if detail == 0.0 => {
                run(mesh, place, span_m, ground_m, [-0.2, 1.0], [-0.02, 0.02], (Surface::Wood, 8.0));
            }
            Border::Picket => {
                let pitch_m = 2.4 / (1.0 + 9.0 * detail);
                let pickets = (length_m / pitch_m).ceil() as usize;
                for picket in 0..=pickets {
                    mesh.object();
                    let x = span_m[0] + length_m * picket as f64 / pickets as f64;
                    let z = ground_m(x);
                    place.cuboid(mesh, [x - 0.045, -0.02, z - 0.2], [x + 0.045, 0.02, z + 1.0], Surface::Wood);
                }
                rail(mesh, place, span_m, ground_m, [[0.3, 0.38], [0.75, 0.83]], 0.025);
            }
            Border::Wall => {
                run(mesh, place, span_m, ground_m, [-0.25, 0.7], [-0.12, 0.12], (Surface::Wall, 8.0 - 5.0 * detail))
            }
            Border::Hedge => {
                let bumpy = |x: f64| ground_m(x) + 0.08 * sin(2.3 * x + place.origin_m[0]);
                let step_m = 8.0 / (1.0 + 11.0 * detail);
                run(mesh, place, span_m, &bumpy, [-0.25, 1.1], [-0.35, 0.35], (Surface::Leaves, step_m));
            }
        }
    }
}

fn rail(
    mesh: &mut Mesh,
    place: &Place,
    span_m: [f64; 2],
    ground_m: &dyn Fn(f64) -> f64,
    at: [[f64; 2]; 2],
    half_m: f64,
) {
    for [low, high] in at {
        run(mesh, place, span_m, ground_m, [low, high], [half_m, 2.0 * half_m], (Surface::Wood, 5.0));
    }
}

/// A bar that follows the ground: heights above it, and from front to back.
fn run(
    mesh: &mut Mesh,
    place: &Place,
    span_m: [f64; 2],
    ground_m: &dyn Fn(f64) -> f64,
    [low, high]: [f64; 2],
    [front, back]: [f64; 2],
    (of, step_m): (Surface, f64),
) {
    mesh.object();
    let pieces = ((span_m[1] - span_m[0]) / step_m).ceil().max(1.0) as usize;
    let edge = |y: f64, above_m: f64| -> Vec<Point> {
        (0..=pieces)
            .map(|piece| {
                let x = span_m[0] + (span_m[1] - span_m[0]) * piece as f64 / pieces as f64;
                place.at([x, y, ground_m(x) + above_m])
            })
            .collect()
    };
    let rows = [edge(front, low), edge(front, high), edge(back, high), edge(back, low)];
    for side in 0..4 {
        mesh.band(&rows[side], &rows[(side + 1) % 4], of);
    }
    for (end, order) in [(0, [0, 1, 2, 3]), (pieces, [3, 2, 1, 0])] {
        mesh.quad(order.map(|row| rows[row][end]), of);
    }
}

/// A street lamp or telegraph pole: its arm reaches along the place's minus y axis, over the street.
pub(super) fn pole(mesh: &mut Mesh, place: &Place, height_m: f64, detail: f64) {
    mesh.object();
    let sides = 3 + (6.0 * detail) as usize;
    place.column(mesh, [0.0, 0.0, -0.3], [0.11, 0.07], height_m + 0.3, sides, Surface::Metal);
    mesh.object();
    place.cuboid(mesh, [-0.06, -1.4, height_m - 0.2], [0.06, 0.0, height_m - 0.08], Surface::Metal);
}

/// A stop sign whose face looks along the place's minus x axis.
pub(super) fn stop_sign(mesh: &mut Mesh, place: &Place) {
    mesh.object();
    place.column(mesh, [0.0, 0.0, -0.3], [0.035, 0.035], 2.2, 4, Surface::Metal);
    mesh.object();
    let ring = |x: f64| -> Vec<Point> { circle(8).map(|[c, s]| place.at([x, 0.38 * c, 2.15 + 0.38 * s])).collect() };
    let (front, back) = (ring(-0.05), ring(-0.02));
    mesh.fan(&back[..8], Surface::Metal);
    let face: Vec<Point> = front[..8].iter().rev().copied().collect();
    mesh.fan(&face, Surface::Metal);
    mesh.band(&front, &back, Surface::Metal);
}
