//! Triangles, object by object: vertices are welded within an object and never between two.

use std::collections::BTreeMap;

use super::Surface;

/// A point, x, y, z in metres.
pub(super) type Point = [f64; 3];

/// Vertices nearer than this are one.
const WELD_M: f64 = 1e-4;

/// Triangles under construction.
#[derive(Default)]
pub(super) struct Mesh {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub surface: Vec<Surface>,
    /// Vertices of the present object by place.
    welded: BTreeMap<[i64; 3], u32>,
}

impl Mesh {
    /// Begins an object.
    pub fn object(&mut self) {
        self.welded.clear();
    }

    fn vertex(&mut self, point: Point) -> u32 {
        let key = point.map(|coordinate| (coordinate / WELD_M).round() as i64);
        *self.welded.entry(key).or_insert_with(|| {
            self.vertices.push(point.map(|coordinate| coordinate as f32));
            (self.vertices.len() - 1) as u32
        })
    }

    /// A triangle, counter-clockwise from outside; none where two corners are one.
    pub fn triangle(&mut self, corners: [Point; 3], surface: Surface) {
        let [a, b, c] = corners.map(|corner| self.vertex(corner));
        if a != b && b != c && c != a {
            self.triangles.push([a, b, c]);
            self.surface.push(surface);
        }
    }

    /// Two triangles, counter-clockwise from outside.
    pub fn quad(&mut self, [a, b, c, d]: [Point; 4], surface: Surface) {
        self.triangle([a, b, c], surface);
        self.triangle([a, c, d], surface);
    }

    /// The band between two rows of points of the same length: `upper` is above where `lower` runs
    /// to the right, seen from outside.
    pub fn band(&mut self, lower: &[Point], upper: &[Point], surface: Surface) {
        for (low, high) in lower.windows(2).zip(upper.windows(2)) {
            self.quad([low[0], low[1], high[1], high[0]], surface);
        }
    }

    /// A band whose upper row has only every `stride`-th point of the lower one, and its last.
    pub fn stitch(&mut self, lower: &[Point], upper: &[Point], stride: usize, surface: Surface) {
        for (group, high) in upper.windows(2).enumerate() {
            let from = group * stride;
            let to = (from + stride).min(lower.len() - 1);
            let middle = (from + to) / 2;
            for at in from..to {
                let apex = if at < middle { high[0] } else { high[1] };
                self.triangle([lower[at], lower[at + 1], apex], surface);
            }
            self.triangle([lower[middle], high[1], high[0]], surface);
        }
    }

    /// A convex polygon, counter-clockwise from outside.
    pub fn fan(&mut self, corners: &[Point], surface: Surface) {
        for i in 2..corners.len() {
            self.triangle([corners[0], corners[i - 1], corners[i]], surface);
        }
    }
}

/// Where an object stands: its own x to the right along the street, y away from it, z up.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Its origin in the world.
    pub origin_m: Point,
    /// Its x axis in the world, of length 1.
    pub along: [f64; 2],
}

impl Place {
    /// World from own.
    pub fn at(&self, [x, y, z]: Point) -> Point {
        let ([ox, oy, oz], [cos, sin]) = (self.origin_m, self.along);
        [ox + x * cos - y * sin, oy + x * sin + y * cos, oz + z]
    }

    /// A place within this one, turned by a direction out of its own axes.
    pub fn within(&self, origin_m: Point, [cos, sin]: [f64; 2]) -> Self {
        let [c, s] = self.along;
        Self { origin_m: self.at(origin_m), along: [c * cos - s * sin, s * cos + c * sin] }
    }

    /// A box from one corner to the opposite one.
    pub fn cuboid(&self, mesh: &mut Mesh, low: Point, high: Point, surface: Surface) {
        let corner = |i: usize| {
            let pick = |axis: usize, bit: usize| if i & bit == 0 { low[axis] } else { high[axis] };
            self.at([pick(0, 1), pick(1, 2), pick(2, 4)])
        };
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            mesh.quad(face.map(corner), surface);
        }
    }

    /// An upright prism or, with another radius above, a frustum; closed at the top only.
    pub fn column(&self, mesh: &mut Mesh, foot: Point, radii_m: [f64; 2], height_m: f64, sides: usize, of: Surface) {
        let ring = |radius_m: f64, z: f64| -> Vec<Point> {
            circle(sides).map(|[c, s]| self.at([foot[0] + radius_m * c, foot[1] + radius_m * s, z])).collect()
        };
        let (below, above) = (ring(radii_m[0], foot[2]), ring(radii_m[1], foot[2] + height_m));
        mesh.band(&below, &above, of);
        mesh.fan(&above[..sides], of);
    }
}

/// Directions around the circle, counter-clockwise, the first again at the end.
pub(super) fn circle(sides: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..=sides).map(move |i| {
        let angle_rad = std::f64::consts::TAU * (i % sides) as f64 / sides as f64;
        let (sin, cos) = asami_math::elementary::sin_cos(angle_rad);
        [cos, sin]
    })
}
